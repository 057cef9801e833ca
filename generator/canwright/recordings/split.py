"""A log split into channels by direction, so that an analyser can load a database for each; and its buses again."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, BinaryIO, TextIO

from ..diagnostics.unicode_safety import visible
from ..model.formatting import sent
from ..model.message import Direction
from ..semantics.frame import CanFrame
from .exports import seconds
from .log_frame import FD_LENGTHS, MAX_CLASSIC_BYTES, LogError, LogFrame, Mark
from .rows import Row

FORMATS = (".asc", ".blf", ".log")
"""The formats of a split log, by the end of its name: ASC, BLF, and that of `candump -l`."""
CHANNELS = 3
"""The channels of a bus: its requests, its replies, and all other frames."""
Write = Callable[[int, int, CanFrame, bool], object]
"""Writes a frame: channel, time in ns, frame, whether it is a request."""
_CHANNEL = re.compile(r"(?:can)?([1-9]\d{0,8})", re.ASCII)
_MARKS = (Mark.SENT, Mark.RECEIVED, None)
"""The marks of the channels of a bus, for a recorder that is the host."""
_FD_END = "0 0 1000 0 0 0 0 0"
"""The end of a line of ASC with a frame of CAN FD: durations, flags of which one is that of CAN FD, and bit timings."""


class SplitLog:
    """Writes frames to a log with three channels for each bus. `buses` has the first channel of each, counted from 1."""

    def __init__(self, path: Path, form: str) -> None:
        self.buses: dict[str, int] = {}
        if form == ".blf":
            binary = path.open("wb")
            self._file: IO[Any] = binary
            self._write, self._end = _blf(binary)
        else:
            text = path.open("w", encoding="ascii", newline="\n")
            self._file = text
            self._write, self._end = (_asc if form == ".asc" else _candump)(text)

    def write(self, row: Row) -> None:
        """Writes the frame of a row."""
        judged = row.judged
        recorded = judged.recorded
        first = self.buses.setdefault(recorded.bus, 1 + CHANNELS * len(self.buses))
        offset = {Direction.REQUEST: 0, Direction.REPLY: 1, None: 2}[judged.direction]
        self._write(first + offset, recorded.time or 0, recorded.frame, judged.direction is Direction.REQUEST)

    def close(self) -> None:
        self._end()
        self._file.close()


def joined(frames: Iterator[LogFrame]) -> Iterator[LogFrame]:
    """The frames of a split log on its buses, named 1, 2 and so on. Raises LogError."""
    for recorded in frames:
        channel = _CHANNEL.fullmatch(recorded.bus)
        if channel is None:
            raise LogError(f"`{visible(recorded.bus)}` is no channel of a file that --split writes; omit --from-split")
        bus, offset = divmod(int(channel[1]) - 1, CHANNELS)
        yield recorded._replace(bus=str(bus + 1), mark=_MARKS[offset])


def _candump(file: TextIO) -> tuple[Write, Callable[[], object]]:
    def write(channel: int, time: int, frame: CanFrame, is_request: bool) -> None:
        file.write(f"({seconds(time, 6)}) can{channel} {sent(frame)} {'T' if is_request else 'R'}\n")

    return write, lambda: None


def _asc(file: TextIO) -> tuple[Write, Callable[[], object]]:
    start: list[int] = []

    def write(channel: int, time: int, frame: CanFrame, is_request: bool) -> None:
        if not start:
            start.append(time)
            date = _date(time)
            file.write(f"date {date}\nbase hex  timestamps absolute\nno internal events logged\n")
            file.write(f"Begin Triggerblock {date}\n   0.000000 Start of measurement\n")
        id_ = f"{frame.id:X}{'x' if frame.extended else ''}"
        since, mark = seconds(max(0, time - start[0]), 6), "Tx" if is_request else "Rx"
        data = frame.data.hex(" ").upper()
        if len(frame.data) > MAX_CLASSIC_BYTES:
            code = next(code for code, length in FD_LENGTHS.items() if length >= len(frame.data))
            event = f"CANFD {channel:>3} {mark:<4} {id_:>8} {'':>32} 0 0 {code:x} {len(frame.data):>2} {data} {_FD_END}"
        else:
            known = "r" if frame.remote else f"d {len(frame.data):x} {data}".rstrip()
            event = f"{channel}  {id_:<15} {mark:<4} {known}"
        file.write(f"{since:>11} {event}\n")

    return write, lambda: file.write("End TriggerBlock\n")


def _date(at: int) -> str:
    """A time in UTC as in an ASC file, in any locale."""
    seconds, rest = divmod(at, 1_000_000_000)
    written = time.asctime(time.gmtime(seconds)).replace("  ", " 0")
    return f"{written[:-5]}.{rest // 1_000_000:03}{written[-5:]}"


def _blf(file: BinaryIO) -> tuple[Write, Callable[[], object]]:
    import can

    writer = can.BLFWriter(file)

    def write(channel: int, time: int, frame: CanFrame, is_request: bool) -> None:
        message = can.Message(
            timestamp=time / 1_000_000_000,
            arbitration_id=frame.id,
            is_extended_id=frame.extended,
            is_remote_frame=frame.remote,
            is_fd=len(frame.data) > MAX_CLASSIC_BYTES,
            data=None if frame.remote else frame.data,
            channel=channel - 1,
            is_rx=not is_request,
        )
        writer.on_message_received(message)

    return write, writer.stop
