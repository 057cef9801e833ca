"""A log split into channels by direction, so that an analyser can load a database for each."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timezone
from pathlib import Path
from typing import IO, Any, BinaryIO, TextIO

from ..model.formatting import sent
from ..model.message import Direction
from ..semantics.frame import CanFrame
from .exports import seconds
from .rows import Row

FORMATS = (".asc", ".blf", ".log")
"""The formats of a split log, by the end of its name: ASC, BLF, and that of `candump -l`."""
CHANNELS = 3
"""The channels of a bus: its requests, its replies, and all other frames."""
Write = Callable[[int, int, CanFrame, bool], object]
"""Writes a frame: channel, time in ns, frame, whether it is a request."""
_DAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


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
        data = "r" if frame.remote else f"d {len(frame.data):x} {frame.data.hex(' ').upper()}".rstrip()
        since = seconds(max(0, time - start[0]), 6)
        file.write(f"{since:>11} {channel}  {id_:<15} {'Tx' if is_request else 'Rx':<4} {data}\n")

    return write, lambda: file.write("End TriggerBlock\n")


def _date(time: int) -> str:
    """A time in UTC as in an ASC file, in any locale."""
    at = datetime.fromtimestamp(time // 1_000_000_000, tz=timezone.utc)
    milliseconds = time // 1_000_000 % 1000
    return f"{_DAYS[at.weekday()]} {_MONTHS[at.month - 1]} {at.day:02} {at:%H:%M:%S}.{milliseconds:03} {at.year}"


def _blf(file: BinaryIO) -> tuple[Write, Callable[[], object]]:
    import can

    writer = can.BLFWriter(file)

    def write(channel: int, time: int, frame: CanFrame, is_request: bool) -> None:
        message = can.Message(
            timestamp=time / 1_000_000_000,
            arbitration_id=frame.id,
            is_extended_id=frame.extended,
            is_remote_frame=frame.remote,
            data=None if frame.remote else frame.data,
            channel=channel - 1,
            is_rx=not is_request,
        )
        writer.on_message_received(message)

    return write, writer.stop
