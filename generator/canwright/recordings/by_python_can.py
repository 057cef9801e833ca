"""The formats that python-can reads: ASC, TRC and CSV as lines, BLF and MF4 as bytes.

Its readers stop at a line that they cannot read and skip others without a word. Here each line that gives no frame is
counted, and after a failure reading goes on with the next line.
"""

from __future__ import annotations

import io
import itertools
import re
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, BinaryIO, cast

from ..model.layout import MAX_DATA_BYTES
from ..semantics.frame import CanFrame
from .log_frame import OVERLONG, Counts, LogFrame, Mark, SkippedPart
from .packages import require

if TYPE_CHECKING:
    import can
    from can.io.generic import MessageReader

CSV_START = "timestamp,arbitration_id"
_FRAME = {
    "asc": re.compile(r"\s*\d+\.\d+\s+(\d+|CANFD)\s"),
    "trc": re.compile(r"\s*\d+\)?\s+\d+\.\d+\s"),
    "csv": re.compile(r"[\d.]+,0x"),
}
"""What a line of a frame starts with; the lines before the first are the header."""
_ASC_EVENT = re.compile(r"\s*\d+\.\d+\s+\d+\s+\w+:(?!.*\s(Rx|Tx)\s)")
"""An event on a channel in ASC, such as `Statistic:`, which is no frame."""
_ASC_BASE = re.compile(r"\s*base\s+(hex|dec)(?:\s+timestamps\s+(\w+))?", re.IGNORECASE)
_ASC_TIME = re.compile(r"(\s*)(\d+)\.(\d{1,9})(?=\s)")
_ASC_COMMENT = "//\n"
_ASC_HEADER_END = "internal events logged\n"
_ERROR_LINE = re.compile(r"\s*\d+\)?\s+[\d.]+\s+(\d+\s+)?(ERROR|Error|Warng|ER|STATUS|ST)\b")
_PYTHON_CAN = {"can": "python-can"}
_NEEDED = {"mf4": {**_PYTHON_CAN, "asammdf": "asammdf"}}
"""The packages that read a form, and their names for pip, where it is not python-can alone."""
_MARKED = ("asc", "trc", "blf", "mf4")
_FIRST_BUS = {"asc": 1, "blf": 1}
"""What python-can subtracts from the number of a channel in a file."""


def read_lines(form: str, lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log in the form `asc`, `trc` or `csv`. Raises MissingPackageError."""
    reader = _reader(form)
    feed = _Feed(form, lines, counts)
    while not feed.ended:
        try:
            for message in reader(feed):
                recorded = _recorded(form, message)
                if isinstance(recorded, SkippedPart):
                    feed.skip(recorded)
                else:
                    feed.took()
                    yield recorded
        except Exception:  # each reader has its own
            feed.failed()


def read_bytes(form: str, source: BinaryIO, counts: Counts) -> Iterator[LogFrame]:
    """The frames of a log in the form `blf` or `mf4`. Raises MissingPackageError."""
    opened = _reader(form)
    counted = _Counted(source)
    objects, size, listed = 0, 0, 0
    try:
        reader = opened(io.BytesIO(source.read()) if form == "mf4" else counted)
        size, listed = getattr(reader, "file_size", 0), getattr(reader, "object_count", 0)
        for message in reader:
            objects += 1
            recorded = _recorded(form, message)
            if isinstance(recorded, SkippedPart):
                counts.skip(recorded)
            else:
                yield recorded
    except Exception as error:  # each reader has its own
        counts.skip(SkippedPart.TRUNCATED, 0, str(error) or type(error).__name__)
        return
    if counted.size < size:
        counts.skip(SkippedPart.TRUNCATED, 0, f"{counted.size} of {size} bytes")
    elif listed > objects:
        counts.skipped[SkippedPart.OTHER] += listed - objects


def _reader(form: str) -> Callable[..., MessageReader]:
    for package, project in _NEEDED.get(form, _PYTHON_CAN).items():
        require(package, project, f"reading .{form} files")
    import can

    readers = {
        "asc": can.ASCReader,
        "trc": can.TRCReader,
        "csv": can.CSVReader,
        "blf": can.BLFReader,
        "mf4": can.MF4Reader,
    }
    return cast("Callable[..., MessageReader]", readers[form])


def _recorded(form: str, message: can.Message) -> LogFrame | SkippedPart:
    """The frame that a message of python-can is, or what it is instead."""
    if message.is_error_frame:
        return SkippedPart.ERROR
    if len(message.data) > MAX_DATA_BYTES:
        return SkippedPart.XL
    if not message.is_remote_frame and len(message.data) != message.dlc:
        return SkippedPart.MALFORMED
    frame = CanFrame(message.arbitration_id, bytes(message.data), message.is_extended_id, message.is_remote_frame)
    bus = message.channel
    if isinstance(bus, int):
        bus += _FIRST_BUS.get(form, 0)
    mark = (Mark.RECEIVED if message.is_rx else Mark.SENT) if form in _MARKED else None
    # A float of seconds since the epoch is exact to less than a microsecond.
    return LogFrame(round(message.timestamp * 1e6) * 1_000, "" if bus is None else str(bus), frame, mark)


class _Asc:
    """The lines of a log in ASC as its reader needs them.

    Of the header, it needs the base only: it stops at a date in an unknown language. Times that are relative to the line
    before, which need not be a frame, become absolute.
    """

    def __init__(self) -> None:
        self._is_relative = False
        self._time = 0

    def header(self, line: str) -> str:
        """A line before the first frame."""
        base = _ASC_BASE.match(line)
        if base is None:
            self.line(line)
            return _ASC_COMMENT
        self._is_relative = (base[2] or "").lower() == "relative"
        return f"base {base[1].lower()}  timestamps absolute\n"

    def line(self, line: str) -> str:
        """A frame or an event."""
        stamp = _ASC_TIME.match(line) if self._is_relative else None
        if stamp is None:
            return line
        self._time += int(stamp[2]) * 1_000_000_000 + int(stamp[3].ljust(9, "0"))
        return f"{stamp[1]}{self._time // 1_000_000_000}.{self._time % 1_000_000_000:09d}{line[stamp.end() :]}"


class _Feed:
    """The lines of a log for readers, one after the other, each of which gets the header first."""

    def __init__(self, form: str, lines: Iterable[str], counts: Counts) -> None:
        self.ended = False
        self._form, self._counts = form, counts
        self._lines: Iterator[tuple[int, str]] = enumerate(lines, start=1)
        self._header: list[str] = []
        self._in_header, self._replayed = True, 0
        self._open: tuple[int, str] | None = None
        self._asc = _Asc() if form == "asc" else None

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        self._close()
        if self._replayed < len(self._header) and not self._in_header:
            self._replayed += 1
            return self._header[self._replayed - 1]
        try:
            number, line = next(self._lines)
        except StopIteration:
            self.ended = True
            raise
        was_in_header = self._in_header
        self._in_header = was_in_header and not _FRAME[self._form].match(line)
        if self._in_header:
            self._header.append(self._asc.header(line) if self._asc else line)
        elif was_in_header and self._asc:
            self._lines = itertools.chain([(number, line)], self._lines)
            self._header.append(_ASC_HEADER_END)
        else:
            self._open = number, line
            return self._asc.line(line) if self._asc else line
        self._replayed += 1
        return self._header[-1]

    def took(self) -> None:
        """The last line is a frame."""
        self._open = None

    def skip(self, part: SkippedPart) -> None:
        """The last line is no frame; a line that was cut off is the truncated end."""
        if self._open is not None:
            number, line = self._open
            cut_off = part is SkippedPart.MALFORMED and not line.endswith("\n")
            self._counts.skip(SkippedPart.TRUNCATED if cut_off else part, number, line)
            self._open = None

    def failed(self) -> None:
        """A reader stopped at the last line; the next one starts with the header."""
        self.skip(SkippedPart.MALFORMED)
        self._replayed = 0

    def close(self) -> None:
        """Readers close what they read."""

    def _close(self) -> None:
        """A reader gave nothing for the last line."""
        if self._open is not None:
            line = self._open[1]
            is_event = self._form == "asc" and _ASC_EVENT.match(line)
            if line.startswith(OVERLONG):
                self.skip(SkippedPart.MALFORMED)
            elif _ERROR_LINE.match(line):
                self.skip(SkippedPart.ERROR)
            else:
                self.skip(
                    SkippedPart.MALFORMED if _FRAME[self._form].match(line) and not is_event else SkippedPart.OTHER
                )


class _Counted:
    """A binary file whose bytes are counted as they are read."""

    def __init__(self, source: BinaryIO) -> None:
        self.source, self.size = source, 0

    def read(self, size: int = -1) -> bytes:
        content = self.source.read(size)
        self.size += len(content)
        return content

    def close(self) -> None:
        """Readers close what they read."""
