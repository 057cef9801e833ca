"""What `monitor` shows: the frames of a bus or a log, decoded as `decode` does, in a thread of its own."""

from __future__ import annotations

import contextlib
import copy
import queue
import re
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import can

from ..model.edition import Edition
from ..model.message import Direction
from ..recordings.bus_log import BusLog, errors_of_use, sentence
from ..recordings.by_python_can import recorded_frame
from ..recordings.directions import DirectedFrame
from ..recordings.kept_frames import MAX_STREAMED
from ..recordings.latest_values import SECOND, LatestValues
from ..recordings.log_frame import LogFrame, SkippedPart
from ..recordings.nodes import Identifiers, NodeSetting, follow
from ..recordings.readers import PAUSE, Log, LogError
from ..recordings.rows import Row, RowReader
from .bus import BusArguments, returns_own_frames
from .log_source import known_nodes, log_directions
from .monitor_view import Sources, status_parts

QUEUED = 4096
"""The maximum number of frames that wait to be decoded: half a second of a bus of 1 Mbit/s. Then they are dropped."""
_LEAP = 1.0
"""The seconds by which a clock can differ before it is another clock, or a log that is too fast to be decoded."""


class Recording:
    """A new log of all frames of a bus. Raises OSError; FileExistsError if there is such a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.frames = 0
        path.open("x").close()
        self._writer: Any = can.Logger(path)

    def write(self, message: can.Message) -> None:
        """Adds a frame."""
        self._writer(message)
        self.frames += 1

    def close(self) -> None:
        """Completes the log."""
        self._writer.stop()


class Receiver:
    """Reads a bus in a thread: for the decoder, a recording, and a client of the package, whose frames are in both, too.

    To `BusLog` and to a client, it is the bus; to a client also the notifier.
    """

    def __init__(self, bus: can.BusABC, arguments: BusArguments, record: Path | None = None) -> None:
        """Records to a new file from the start, if there is one. Raises OSError and ValueError."""
        self.log: Log = BusLog(self)  # type: ignore[arg-type]  # it has what is used of a bus
        self.table = LatestValues()
        self.recording = Recording(record) if record else None
        self.recording_error = ""
        """Why the recording ended by itself."""
        self._can = bus
        self.bus = re.sub(r"[^\w.]", "_", str(arguments.get("channel") or arguments.get("interface") or "bus"))
        self._returns_own = returns_own_frames(arguments)
        self._queue: queue.SimpleQueue[can.Message | Exception] = queue.SimpleQueue()
        self._listeners: list[Callable[[can.Message], Any]] = []
        self._lock = threading.RLock()
        self._ahead = 0.0
        """The seconds by which the clock of the bus is ahead of that of the computer."""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)

    def start(self) -> None:
        """Starts to read."""
        self._thread.start()

    def now(self) -> int:
        """The time on the clock of the bus, in ns."""
        return int((time.time() + self._ahead) * SECOND)

    def show(self, row: Row) -> None:
        """Puts a row into the table."""
        self.table.add(row)

    def recv(self, timeout: float) -> can.Message | None:
        """The next frame to decode. Raises what the bus has raised."""
        try:
            message = self._queue.get(timeout=timeout) if timeout else self._queue.get_nowait()
        except queue.Empty:
            return None
        if isinstance(message, Exception):
            raise message
        return message

    def send(self, message: can.Message) -> None:
        """Sends a frame. Raises what the bus raises."""
        with self._lock:
            self._can.send(message)
            if not self._returns_own:
                sent = copy.copy(message)
                sent.timestamp, sent.is_rx = self.now() / SECOND, False
                self._take(sent)

    def add_listener(self, listener: Callable[[can.Message], Any]) -> None:
        """Calls a listener with each frame that is received."""
        self._listeners.append(listener)

    def remove_listener(self, listener: Callable[[can.Message], Any]) -> None:
        """Stops calling a listener."""
        self._listeners.remove(listener)

    def record(self, path: Path) -> None:
        """Starts a recording. Raises OSError."""
        with self._lock:
            self.recording, self.recording_error = Recording(path), ""

    def end_recording(self) -> Recording | None:
        """Completes the recording, if there is one, and returns it."""
        with self._lock:
            ended, self.recording = self.recording, None
            if ended:
                ended.close()
            return ended

    def close(self) -> None:
        """Stops reading, and completes the recording."""
        self._ended.set()
        self._thread.join()
        self.end_recording()

    def _read(self) -> None:
        try:
            while not self._ended.is_set():
                message = self._can.recv(PAUSE)
                if message is not None:
                    with self._lock:
                        ahead = message.timestamp - time.time()
                        self._ahead = ahead if abs(ahead) > _LEAP else 0.0
                        self._take(message)
                        for listener in self._listeners:
                            listener(message)
        except errors_of_use() as error:
            self._queue.put(error)

    def _take(self, message: can.Message) -> None:
        message.channel = self.bus
        if self._queue.qsize() >= QUEUED:
            self.table.drop(recorded.frame for recorded in self._waiting())
        self._queue.put(message)
        if self.recording:
            try:
                self.recording.write(message)
            except (OSError, ValueError) as error:
                self.recording_error = f"the recording ended: {sentence(error)}"
                with contextlib.suppress(OSError, ValueError):
                    self.recording.close()
                self.recording = None

    def _waiting(self) -> Iterator[LogFrame]:
        """Removes the frames that wait."""
        with contextlib.suppress(queue.Empty):
            while True:
                message = self._queue.get_nowait()
                recorded = SkippedPart.OTHER if isinstance(message, Exception) else recorded_frame("", message)
                if isinstance(recorded, LogFrame):
                    yield recorded


class Player:
    """Plays a log by the times of its frames."""

    def __init__(self, log: Log, speed: float) -> None:
        self.log = log
        self.table = LatestValues()
        self._speed = speed
        self._time = 0
        self._at: float | None = None
        """When the clock showed the time; None while it stands."""
        self._shown = 0
        """The time of the last frame."""
        self._has_started = False
        self._ended = threading.Event()

    def start(self) -> None:
        """The first frame starts the clock."""

    def now(self) -> int:
        """The time of the log, in ns."""
        at = self._at
        return self._time + (0 if at is None else int((time.monotonic() - at) * self._speed * SECOND))

    def run(self, *, is_running: bool) -> None:
        """Starts or stops the clock."""
        self._set(self.now(), is_running=is_running)

    def finish(self) -> None:
        """Stops the clock at the last frame."""
        self._set(self._shown, is_running=False)

    def show(self, row: Row) -> None:
        """Puts a row into the table when its time has come."""
        due = row.judged.recorded.time
        if due is not None:
            self._wait(due)
            self._shown = due
        self.table.add(row)

    def close(self) -> None:
        """Ends a wait."""
        self._ended.set()

    def _wait(self, due: int) -> None:
        """Waits until a time. A clock that is too fast for the decoder is set back."""
        if not self._has_started:
            self._has_started = True
            self._set(due, is_running=True)
        while not self._ended.is_set() and (left := due - self.now()) > 0:
            self._ended.wait(min(PAUSE, left / SECOND / self._speed))
        if self.now() - due > _LEAP * SECOND * self._speed:
            self._set(due, is_running=self._at is not None)

    def _set(self, now: int, *, is_running: bool) -> None:
        self._time, self._at = now, time.monotonic() if is_running else None


class Feed:
    """Decodes a source in a thread into a table of latest values. `error` says why it ended, if not at its end."""

    def __init__(
        self,
        source: Receiver | Player,
        editions: Sequence[Edition],
        settings: Sequence[NodeSetting],
        bit_rate: int | None,
    ) -> None:
        """A feed; the nodes of a log in a file are identified. Raises LogError and OSError."""
        self.source = source
        self.table = source.table
        self.error = ""
        self.ended = threading.Event()
        self.nodes = known_nodes(source.log, editions, settings, Direction.REQUEST)
        self._editions, self._settings = editions, settings
        self._bit_rate = bit_rate
        self._thread = threading.Thread(target=self._run, daemon=True)
        source.start()
        self._thread.start()

    @property
    def recording(self) -> Recording | None:
        """The recording of the bus; None without one, and for a log."""
        return self.source.recording if isinstance(self.source, Receiver) else None

    def status_parts(self) -> Iterator[str]:
        """The parts of the line with the state of the bus."""
        recording, source = self.recording, self.source
        sources = Sources(
            source.log.counts.skipped[SkippedPart.ERROR],
            self._bit_rate,
            (recording.path.name, recording.frames) if recording else None,
            source.recording_error if isinstance(source, Receiver) else "",
        )
        if self.nodes is None:
            yield "frames wait until the editions of their nodes are identified, or given with --set"
        yield from status_parts(self.table.status(source.now()), sources)

    def close(self) -> None:
        """Ends the threads."""
        self.source.log.is_ended = True
        self.source.close()
        self._thread.join(_LEAP)

    def _run(self) -> None:
        try:
            self._decode()
        except (LogError, OSError) as error:
            self.error = str(error)
        finally:
            if isinstance(self.source, Player):
                self.source.finish()
            self.ended.set()

    def _decode(self) -> None:
        log, nodes = self.source.log, self.nodes
        frames: Iterable[LogFrame] = log
        if nodes is None:
            identifiers = Identifiers(self._editions, Direction.REQUEST, kept=MAX_STREAMED)
            nodes, frames = follow(log, identifiers, self._settings)
            self.nodes = nodes
        directions = log_directions(log, nodes, Direction.REQUEST)
        reader = RowReader(nodes.assignment, nodes.label)

        def show(judged: Iterable[DirectedFrame]) -> None:
            for row in reader.rows(judged):
                self.source.show(row)
                if log.is_ended:
                    return

        log.on_wait = lambda pause: show(directions.paused(int(pause * SECOND)))
        show(directions.classify(frames))
