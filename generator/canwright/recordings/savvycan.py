"""The CSV format of SavvyCAN, also known as GVRET: times in microseconds, ids in hexadecimal, a column for each byte."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from ..model.layout import MAX_DATA_BYTES
from .lines import frames_of, octets
from .log_frame import MARKS, Counts, LogError, LogFrame, SkippedPart, log_frame

START = "Time Stamp,ID,Extended"
_NEEDED = ("Time Stamp", "ID", "Extended", "LEN")
_NUMBER = re.compile(r"-?\d{1,30}", re.ASCII)
_ID = re.compile(r"(0x)?[\da-f]{1,16}", re.ASCII | re.IGNORECASE)
_BYTE = re.compile(r"[\da-f]{1,2}", re.ASCII | re.IGNORECASE)


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log, the first of which names the columns. Raises LogError."""
    rest = iter(lines)
    columns = {name.strip(): at for at, name in enumerate(next(rest).strip().split(","))}
    missing = next((name for name in _NEEDED if name not in columns), None)
    if missing is not None:
        raise LogError(
            f"the first line of this CSV log names no column {missing}; export it again with all columns of SavvyCAN"
        )
    return frames_of(rest, _Table(columns).read, counts, start=2)


class _Table:
    """The columns of a log by their names."""

    def __init__(self, columns: dict[str, int]) -> None:
        self._columns = columns
        self._first = columns.get("D1", columns["LEN"] + 1)

    def read(self, line: str) -> LogFrame | SkippedPart:
        """The frame on a line, or what the line is instead."""
        cells = [cell.strip() for cell in line.strip().split(",")]
        if not any(cells):
            return SkippedPart.OTHER
        columns = self._columns
        try:
            written, id_, time = (cells[columns[name]] for name in ("LEN", "ID", "Time Stamp"))
            extended = cells[columns["Extended"]].lower() == "true"
            bus = cells[columns["Bus"]] if "Bus" in columns else ""
            mark = MARKS.get(cells[columns["Dir"]].lower()) if "Dir" in columns else None
        except IndexError:
            return SkippedPart.MALFORMED
        if not (_NUMBER.fullmatch(written) and _NUMBER.fullmatch(time) and _ID.fullmatch(id_)):
            return SkippedPart.MALFORMED
        length = int(written)
        if length > MAX_DATA_BYTES:
            return SkippedPart.XL
        listed = cells[self._first : self._first + max(0, length)]
        data = octets(" ".join(listed), length, line) if length >= 0 and all(map(_BYTE.fullmatch, listed)) else None
        if data is None:
            return SkippedPart.MALFORMED
        return log_frame(int(time) * 1_000, bus, int(id_, 16), data, mark, extended=extended)
