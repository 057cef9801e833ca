"""The CSV format of SavvyCAN, also known as GVRET: times in microseconds, ids in hexadecimal, a column for each byte."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..model.layout import MAX_DATA_BYTES
from ..semantics.frame import CanFrame
from .log_frame import Counts, LogFrame, Mark, SkippedPart

START = "Time Stamp,ID,Extended"
_MARKS = {"rx": Mark.RECEIVED, "tx": Mark.SENT}


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log, the first of which names the columns."""
    numbered = enumerate(lines, start=1)
    columns = {name.strip(): at for at, name in enumerate(next(numbered)[1].strip().split(","))}
    first = columns.get("D1", columns["LEN"] + 1)
    for number, line in numbered:
        cells = [cell.strip() for cell in line.strip().split(",")]
        if not any(cells):
            counts.skip(SkippedPart.OTHER, number, line)
            continue
        try:
            length = int(cells[columns["LEN"]])
            data = bytes(int(cell, 16) for cell in cells[first : first + length])
            id_, time = int(cells[columns["ID"]], 16), int(cells[columns["Time Stamp"]]) * 1_000
            extended, bus = cells[columns["Extended"]].lower() == "true", cells[columns["Bus"]]
            mark = _MARKS.get(cells[columns["Dir"]].lower()) if "Dir" in columns else None
        except (ValueError, IndexError):
            counts.skip(SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED, number, line)
            continue
        if length > MAX_DATA_BYTES:
            counts.skip(SkippedPart.XL, number, line)
        elif len(data) < length:
            counts.skip(SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED, number, line)
        else:
            yield LogFrame(time, bus, CanFrame(id_, data, extended), mark)
