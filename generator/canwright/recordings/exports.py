"""Rows as lines of CSV and of JSON."""

from __future__ import annotations

import csv
import functools
import json
from collections.abc import Iterator
from typing import Any

from ..diagnostics.unicode_safety import visible
from ..model.formatting import sent
from ..semantics.decoder import Rejection
from .rows import Cell, CellValue, Row

CSV_COLUMNS = (
    "number",
    "time",
    "bus",
    "frame",
    "node",
    "edition",
    "direction",
    "decided_by",
    "command",
    "request",
    "latency_ms",
    "field",
    "raw",
    "value",
    "unit",
    "rejection",
)


@functools.lru_cache(maxsize=1 << 10)
def bus_name(bus: str) -> str:
    """The name of a bus in a log, with what a terminal or a CI system would interpret escaped."""
    return visible(bus).replace("##", "#[U+0023]")


def decimal(number: int, places: int, kept: int) -> str:
    """An integer shifted by decimal places, of which the first are kept: `decimal(1_250_000, 9, 6)` is `0.001250`."""
    sign = "-" if number < 0 else ""
    whole, rest = divmod(abs(number), 10**places)
    return f"{sign}{whole}.{rest:0{places}d}"[: kept - places or None]


def seconds(time: int | None, kept: int = 9) -> str:
    """A time in ns as seconds; empty for None."""
    return "" if time is None else decimal(time, 9, kept)


def milliseconds(latency: int | None, kept: int = 6) -> str:
    """A time in ns as milliseconds; empty for None."""
    return "" if latency is None else decimal(latency, 6, kept)


class CsvLines:
    """Rows as CSV, one line for each value; a frame without values has one line."""

    header = ",".join(CSV_COLUMNS) + "\n"

    def __init__(self) -> None:
        self._writer: Any = csv.writer(_Returned(), lineterminator="\n")

    def __call__(self, row: Row) -> str:
        return "".join(self._lines(row))

    def _lines(self, row: Row) -> Iterator[str]:
        judged = row.judged
        start = [
            judged.number,
            seconds(judged.recorded.time),
            bus_name(judged.recorded.bus),
            sent(judged.recorded.frame),
            _text(judged.node),
            row.edition,
            judged.direction.value if judged.direction else "",
            judged.decided_by.value,
            judged.message.command if judged.message else "",
            _text(judged.request),
            milliseconds(judged.latency),
        ]
        rejection = judged.rejection.text if judged.rejection else ""
        for cell in row.cells:
            yield self._line([*start, cell.column.name, cell.raw, _joined(cell.value), cell.column.unit, rejection])
        if not row.cells:
            yield self._line([*start, "", "", "", "", rejection])

    def _line(self, cells: list[object]) -> str:
        line: str = self._writer.writerow(cells)
        return line


class _Returned:
    """A file whose `write` returns the text, and so does `writerow`."""

    def write(self, text: str) -> str:
        return text


def _text(number: int | None) -> str:
    return "" if number is None else str(number)


def _joined(value: CellValue) -> object:
    return "|".join(value) if isinstance(value, list) else "" if value is None else value


def json_line(row: Row) -> str:
    """A row as one line of JSON. Times are in seconds, latencies in milliseconds, as exact decimals."""
    judged = row.judged
    facts = (
        ("number", judged.number),
        ("time", seconds(judged.recorded.time) or "null"),
        ("bus", _quoted(bus_name(judged.recorded.bus))),
        ("frame", f'"{sent(judged.recorded.frame)}"'),
        ("node", _json(judged.node)),
        ("edition", _json(row.edition or None)),
        ("direction", _json(judged.direction.value if judged.direction else None)),
        ("decided_by", _quoted(judged.decided_by.value)),
        ("command", _json(judged.message.command if judged.message else None)),
        ("request", _json(judged.request)),
        ("latency_ms", milliseconds(judged.latency) or "null"),
        ("fields", "{" + ", ".join(map(_json_field, row.cells)) + "}"),
        ("rejection", "null" if judged.rejection is None else _json_rejection(judged.rejection)),
    )
    return "{" + ", ".join([f'"{name}": {text}' for name, text in facts]) + "}\n"


def _json_field(cell: Cell) -> str:
    column, raw, value = cell
    unit = f', "unit": {_quoted(column.unit)}' if column.unit else ""
    return f'{_quoted(column.name)}: {{"raw": {raw}, "value": {_json(value)}{unit}}}'


def _json_rejection(rejection: Rejection) -> str:
    return f'{{"reason": {_quoted(rejection.reason.value)}, "text": {_quoted(rejection.text)}}}'


def _json(value: CellValue) -> str:
    """A value as JSON; encoders of the standard library take a new start for each text."""
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_quoted, value))}]"
    return "null" if value is None else repr(value)


_quoted = functools.lru_cache(maxsize=1 << 12)(json.encoder.encode_basestring_ascii)
