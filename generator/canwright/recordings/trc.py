"""TRC, the text format of PEAK: versions 1.0 to 1.3 with fixed columns, 2.0 and 2.1 with the columns that the header lists."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from fractions import Fraction

from .lines import MILLISECONDS, decimal, frames_of, octets
from .log_frame import FD_LENGTHS, MARKS, MAX_CLASSIC_BYTES, Counts, LogFrame, SkippedPart, log_frame

_COLUMNS = ";$COLUMNS="
_START = re.compile(r";\$STARTTIME=(\d{1,7}(?:[.,]\d{1,18})?)\s", re.ASCII)
_EPOCH = 25569
"""The days from 30 December 1899, from which start times count, to the epoch."""
_DAY = 86_400_000_000
"""A day in microseconds."""
_NUMBERED = re.compile(r"\s*\d+\)?\s+\d+([.,]\d+)?\s", re.ASCII)
"""What a line of a frame starts with: its number, and a time in milliseconds."""
_FRAME = re.compile(
    r"\s*\d+\)\s+(?P<time>\d{1,15}([.,]\d{1,18})?)\s+(?:(?P<bus>\d{1,2})\s+)?(?:(?P<mark>Rx|Tx)\s+)?"
    r"(?P<id>[\dA-F]{8}|[\dA-F]{4})\s+(?:-\s+)?(?P<length>\d{1,2})(?:\s+(?P<rest>.*))?",
    re.ASCII | re.IGNORECASE | re.DOTALL,
)
"""A line of version 1."""
_TIME = re.compile(r"\d{1,15}([.,]\d{1,18})?", re.ASCII)
_ID = re.compile(r"[\dA-F]{8}|[\dA-F]{4}", re.ASCII | re.IGNORECASE)
_STATUS_ID = "FFFFFFFF"
"""In place of the id: a status of the bus."""
_ERROR = re.compile(r"\s*\d+\)?\s+[\d.,]+\s+(\d+\s+)?(ERROR|Error|Warng|ER|STATUS|ST)\b")
_FRAME_TYPES = ("DT", "FD", "FB", "FE", "BI", "RR")
_EVENT_TYPE = "EV"


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log."""
    return frames_of(lines, _Trc().read, counts)


class _Trc:
    """The start of the recording, and the columns of version 2."""

    def __init__(self) -> None:
        self._start = 0
        self._columns: dict[str, int] = {}

    def read(self, line: str) -> LogFrame | SkippedPart:
        """The frame on a line, or what the line is instead."""
        if line.lstrip().startswith(";"):
            self._header(line.strip() + "\n")
            return SkippedPart.OTHER
        if not _NUMBERED.match(line):
            return SkippedPart.OTHER
        if _ERROR.match(line):
            return SkippedPart.ERROR
        if self._columns:
            return self._by_columns(line)
        match = _FRAME.match(line)
        if match is None:
            return SkippedPart.MALFORMED
        if match["id"].upper() == _STATUS_ID:
            return SkippedPart.OTHER
        rest, length = match["rest"] or "", int(match["length"])
        remote = rest.strip().upper() == "RTR"
        data = b"" if remote else octets(rest, length, line)
        return self._frame(match["time"], match["bus"], match["id"], data, match["mark"] or "", remote)

    def _header(self, line: str) -> None:
        start = _START.match(line)
        if start is not None:
            self._start = round((Fraction(start[1].replace(",", ".")) - _EPOCH) * _DAY) * 1_000
        if line.startswith(_COLUMNS):
            letters = line[len(_COLUMNS) :].strip().split(",")
            self._columns = {letter.strip(): at for at, letter in enumerate(letters)}

    def _by_columns(self, line: str) -> LogFrame | SkippedPart:
        cells = line.split(None, len(self._columns) - 1)
        at = self._columns
        try:
            kind, time, id_ = (cells[at[letter]] for letter in "TOI")
            if kind not in _FRAME_TYPES:
                return SkippedPart.OTHER if kind == _EVENT_TYPE else SkippedPart.MALFORMED
            length = int(cells[at["l" if "l" in at else "L"]])
            mark = cells[at["d"]] if "d" in at else ""
            bus = cells[at["B"]] if "B" in at else None
            remote = kind == "RR"
            if "l" not in at:
                length = FD_LENGTHS.get(length, length) if kind != "DT" else min(MAX_CLASSIC_BYTES, length)
            data = b"" if remote else octets(cells[at["D"]] if length else "", length, line)
        except (KeyError, IndexError, ValueError):
            return SkippedPart.MALFORMED
        if not (_TIME.fullmatch(time) and _ID.fullmatch(id_)):
            return SkippedPart.MALFORMED
        return self._frame(time, bus, id_, data, mark, remote)

    def _frame(
        self, time: str, bus: str | None, id_: str, data: bytes | None, mark: str, remote: bool
    ) -> LogFrame | SkippedPart:
        if data is None:
            return SkippedPart.MALFORMED
        return log_frame(
            self._start + decimal(time.replace(",", "."), MILLISECONDS),
            bus or "1",
            int(id_, 16),
            data,
            MARKS.get(mark.lower()),
            extended=len(id_) > 4,
            remote=remote,
        )
