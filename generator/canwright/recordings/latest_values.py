"""The latest values of the nodes of a bus, for a view that is renewed a few times a second.

Rows are those of `decode`. Times are those of the bus, in ns. Memory does not grow with the number of frames.
"""

from __future__ import annotations

import bisect
import threading
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from ..model.message import Direction
from ..semantics.bus_load import frame_bits
from ..semantics.frame import CanFrame
from ..targets.selected_nodes import selected_nodes
from .directions import DecidedBy
from .log_frame import MAX_CLASSIC_BYTES
from .rows import Row

SECOND = 1_000_000_000
_AVERAGED = 8
"""About so many gaps between frames determine a rate."""
REJECTED = "rejected"
"""The signal of frames that were rejected."""


class Entry(NamedTuple):
    """The last frame of a message of a node, or of its frames that were rejected for one reason.

    There were `frames` of them; `gap` is the average time between the last frames in ns, None if it is unknown.
    """

    row: Row
    frames: int
    gap: float | None

    @property
    def bus(self) -> str:
        return self.row.form.bus

    @property
    def node(self) -> int | None:
        return self.row.form.node

    @property
    def command(self) -> str:
        message = self.row.form.message
        return message.command if message else ""

    @property
    def is_rejected(self) -> bool:
        return self.row.judged.rejection is not None

    @property
    def time(self) -> int | None:
        return self.row.judged.recorded.time

    def age(self, now: int) -> float | None:
        """Seconds since the last frame."""
        return None if self.time is None else max(0, now - self.time) / SECOND

    def rate(self, now: int) -> float | None:
        """Frames a second. It falls if the next frame does not come."""
        if self.gap is None or self.time is None:
            return None
        gap = max(self.gap, now - self.time if now - self.time > 2 * self.gap else 0)
        return SECOND / gap if gap else None

    @property
    def signals(self) -> Sequence[str]:
        """The names of its values; one that is empty for a message without values."""
        if self.is_rejected:
            return (REJECTED,)
        return [column.name for column in self.row.form.columns] or [""]


class Line(NamedTuple):
    """A value of an entry: its name, and its position among the values of the row."""

    entry: Entry
    signal: str
    at: int


class Filter(NamedTuple):
    """What is shown: some nodes, commands whose names contain a text, and signals whose names contain one."""

    nodes: frozenset[int] = frozenset()
    command: str = ""
    signal: str = ""

    def lines(self, entries: Iterable[Entry]) -> Iterator[Line]:
        """The values of entries that are shown."""
        for entry in entries:
            if (self.nodes and entry.node not in self.nodes) or self.command not in entry.command.lower():
                continue
            for at, signal in enumerate(entry.signals):
                if self.signal in signal.lower():
                    yield Line(entry, signal, at)


FILTER = "node=1..2 command=status signal=volt"
"""What a filter looks like."""


def parse_filter(text: str) -> Filter:
    """The filter of a text such as `node=1..2 command=status signal=volt`. Raises ValueError."""
    chosen = Filter()
    for word in text.split():
        name, _, value = word.partition("=")
        if name == "node":
            chosen = chosen._replace(nodes=chosen.nodes.union(selected_nodes(value, ())))
        elif name == "command" and value:
            chosen = chosen._replace(command=value.lower())
        elif name == "signal" and value:
            chosen = chosen._replace(signal=value.lower())
        else:
            raise ValueError(f"`{word}` is not a filter; write it as {FILTER}")
    return chosen


class Status(NamedTuple):
    """What was counted on all buses, and frames and bits a second; None before there is a second of them.

    `bits` counts as many stuff bits as there can be. `dropped` frames were not decoded, because too many came.
    """

    frames: int
    rejected: int
    foreign: int
    dropped: int
    rate: float | None
    bits: float | None


class _Sample(NamedTuple):
    time: int
    frames: int
    bits: int


_Place = tuple[str, int, str, bool]


class LatestValues:
    """The last frame of each message of each node. Threads can add rows and read entries."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._entries: dict[tuple[object, ...], Entry] = {}
        self._order: list[tuple[_Place, tuple[object, ...]]] = []
        self._samples: deque[_Sample] = deque()
        self._frames = self._rejected = self._foreign = self._dropped = self._bits = 0

    def add(self, row: Row) -> None:
        """The next row. A frame that the recorder logged twice counts for the load of the bus only."""
        judged, form, _, _ = row
        with self._lock:
            self._count(judged.recorded.frame)
            if form.edition is None:
                self._foreign += 1
            elif form.decided_by is not DecidedBy.COPY:
                reason = judged.rejection.reason if judged.rejection else None
                self._rejected += reason is not None
                self._replace((form.bus, form.node, form.message, reason), row)

    def drop(self, frames: Iterable[CanFrame]) -> None:
        """Counts frames that are not decoded."""
        with self._lock:
            for frame in frames:
                self._dropped += 1
                self._count(frame)

    def _count(self, frame: CanFrame) -> None:
        self._frames += 1
        is_fd = len(frame.data) > MAX_CLASSIC_BYTES
        self._bits += frame_bits(frame.extended, len(frame.data), is_fd=is_fd).most

    def _replace(self, key: tuple[object, ...], row: Row) -> None:
        known = self._entries.get(key)
        if known is None:
            self._entries[key] = Entry(row, 1, None)
            bisect.insort(self._order, (_place(row, len(self._order)), key), key=lambda pair: pair[0])
            return
        time, before, gap = row.judged.recorded.time, known.time, known.gap
        if time is not None and before is not None:
            passed = max(0, time - before)
            gap = passed if gap is None else gap + (passed - gap) / _AVERAGED
        self._entries[key] = Entry(row, known.frames + 1, gap)

    def entries(self) -> list[Entry]:
        """The entries as they are, by bus, node, command and direction."""
        with self._lock:
            return [self._entries[key] for _, key in self._order]

    def status(self, now: int) -> Status:
        """What was counted so far; the rates are those of the last second in which it was asked."""
        with self._lock:
            sample = _Sample(now, self._frames, self._bits)
            samples = self._samples
            if samples and samples[-1].time > now:
                samples.clear()
            samples.append(sample)
            while len(samples) > 2 and samples[1].time <= now - SECOND:
                samples.popleft()
            first, rate, bits = samples[0], None, None
            if now > first.time:
                seconds = (now - first.time) / SECOND
                rate, bits = (sample.frames - first.frames) / seconds, (sample.bits - first.bits) / seconds
            return Status(self._frames, self._rejected, self._foreign, self._dropped, rate, bits)


def _place(row: Row, number: int) -> _Place:
    """Where an entry is among the others; rejected frames are behind the messages of their node."""
    form = row.form
    node = -1 if form.node is None else form.node
    command = form.message.command if form.message else f"\uffff{number}"
    return form.bus, node, command, form.direction is Direction.REPLY
