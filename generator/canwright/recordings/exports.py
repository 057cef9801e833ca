"""Rows as lines of CSV and of JSON."""

from __future__ import annotations

import csv
import functools
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from ..diagnostics.unicode_safety import visible
from ..model.formatting import sent
from ..semantics.decoder import Rejection
from .rows import MAX_FORMS, CellValue, Column, Row, RowForm


@functools.lru_cache(maxsize=1 << 10)
def bus_name(bus: str) -> str:
    """The name of a bus in a log, with what a terminal or a CI system would interpret escaped."""
    return visible(bus).replace("##", "#[U+0023]")


def decimal(number: int, places: int, kept: int) -> str:
    """An integer shifted by decimal places, of which the first are kept: `decimal(1_250_000, 9, 6)` is `0.001250`."""
    digits = str(number)
    if number < 0 or len(digits) <= places:
        digits = f"{number:0{places + 1 + (number < 0)}}"
    return f"{digits[:-places]}.{digits[-places:]}"[: kept - places or None]


def seconds(time: int | None, kept: int = 9) -> str:
    """A time in ns as seconds; empty for None."""
    return "" if time is None else decimal(time, 9, kept)


def milliseconds(latency: int | None, kept: int = 6) -> str:
    """A time in ns as milliseconds; empty for None."""
    return "" if latency is None else decimal(latency, 6, kept)


class CsvLines:
    """Rows as CSV, one line for each value; a frame without values has one line."""

    def __init__(self) -> None:
        self._writer: Any = csv.writer(_Returned(), lineterminator="\n")
        self._header = ",".join([*OF_FRAME, "field", "raw", "value", "unit", "rejection"]) + "\n"

    def __call__(self, rows: Iterable[Row]) -> str:
        """The rows as lines; before the first ones, the header."""
        header, self._header = self._header, ""
        return header + "".join(line for row in rows for line in self._lines(row))

    def _lines(self, row: Row) -> Iterator[str]:
        start = [_text(content(row)) for content in OF_FRAME.values()]
        rejection = row.judged.rejection.text if row.judged.rejection else ""
        for column, raw, value in row.cells:
            yield self._line([*start, column.name, raw, _text(value), column.unit, rejection])
        if not row.form.columns:
            yield self._line([*start, "", "", "", "", rejection])

    def _line(self, cells: list[object]) -> str:
        line: str = self._writer.writerow(cells)
        return line


OF_FRAME: Mapping[str, Callable[[Row], CellValue]] = {
    "number": lambda row: row.judged.number,
    "time": lambda row: seconds(row.judged.recorded.time),
    "bus": lambda row: bus_name(row.form.bus),
    "frame": lambda row: sent(row.judged.recorded.frame),
    "node": lambda row: row.form.node,
    "edition": lambda row: row.form.label or None,
    "direction": lambda row: row.form.direction.value if row.form.direction else None,
    "decided_by": lambda row: row.form.decided_by.value,
    "command": lambda row: row.form.message.command if row.form.message else None,
    "request": lambda row: row.judged.request,
    "latency_ms": lambda row: milliseconds(row.judged.latency),
}
"""What is known of a frame: the columns of CSV, and the first ones of JSON, with their contents."""
_VARYING = {"number": "%d", "time": "%s", "frame": '"%s"', "request": "%s", "latency_ms": "%s"}
"""The columns that differ between the rows of one form, as JSON."""


class _Returned:
    """A file whose `write` returns the text, and so does `writerow`."""

    def write(self, text: str) -> str:
        return text


def _text(value: object) -> object:
    return "|".join(value) if isinstance(value, list) else "" if value is None else value


Text = tuple[int, Callable[[CellValue], str]]
"""The place of a field, and the function that writes its value as JSON."""


class JsonLines:
    """Rows as lines of JSON. Times are in seconds, latencies in milliseconds, as exact decimals."""

    def __init__(self) -> None:
        self._formats: dict[RowForm, tuple[str, Sequence[Text]]] = {}

    def __call__(self, rows: Iterable[Row]) -> str:
        """The rows as lines."""
        return "".join(map(self._line, rows))

    def _line(self, row: Row) -> str:
        judged, form, fields, _ = row
        (time, _, frame, _), number, _, _, _, _, _, rejection, request, latency, _ = judged
        line, texts = self._formats.get(form) or self._format(row)
        if texts:
            fields = [*fields]
            for at, written in texts:
                fields[at] = written(fields[at])
        return line % (
            number,
            "null" if time is None else decimal(time, 9, 9),
            sent(frame),
            "null" if request is None else request,
            "null" if latency is None else decimal(latency, 6, 6),
            *fields,
            "null" if rejection is None else _json_rejection(rejection),
        )

    def _format(self, row: Row) -> tuple[str, Sequence[Text]]:
        if len(self._formats) >= MAX_FORMS:
            self._formats.clear()
        self._formats[row.form] = known = _json_format(row)
        return known


def _json_format(row: Row) -> tuple[str, Sequence[Text]]:
    """The line of the rows of a form, as a format of what differs: `_VARYING`, fields, and rejection.

    With it, the places of the fields that are not always numbers, each with the function that writes its value.
    """
    facts = {name: _VARYING.get(name) or _constant(content(row)) for name, content in OF_FRAME.items()}
    facts["fields"] = "{" + ", ".join(map(_json_field, row.form.columns)) + "}"
    facts["rejection"] = "%s"
    texts = [
        (2 * at + 1, _or_no_value if column.field.type.no_values else _json)
        for at, (column, is_number) in enumerate(zip(row.form.columns, row.form.numbers, strict=True))
        if not is_number
    ]
    return "{" + ", ".join([f'"{name}": {text}' for name, text in facts.items()]) + "}\n", texts


def _json_field(column: Column) -> str:
    unit = f', "unit": {_constant(column.unit)}' if column.unit else ""
    return f'{_constant(column.name)}: {{"raw": %d, "value": %s{unit}}}'


def _json_rejection(rejection: Rejection) -> str:
    return f'{{"reason": {_quoted(rejection.reason.value)}, "text": {_quoted(rejection.text)}}}'


def _constant(value: CellValue) -> str:
    """A value as JSON in a format."""
    return _json(value).replace("%", "%%")


def _json(value: CellValue) -> str:
    """A value as JSON; encoders of the standard library take a new start for each text."""
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_quoted, value))}]"
    return "null" if value is None else repr(value)


def _or_no_value(value: CellValue) -> str:
    """A number as JSON, or null with the name for no value."""
    return f'null, "no_value": {_quoted(value)}' if isinstance(value, str) else _json(value)


_quoted = functools.lru_cache(maxsize=1 << 12)(json.encoder.encode_basestring_ascii)
