"""The command matrix of an edition: one row for each field of each command, as a table, CSV and Excel."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Element, Field
from ..model.message import Command, Direction, Key, KeyRole, Message
from ..model.types import Encoding
from .words import LABELS

_FORMULA = ("=", "+", "-", "@", "\t")
"""Starts of a text that a spreadsheet takes for a formula."""
_NUMBERS = frozenset({"raw_range", "resolution", "values"})
"""Columns that can start with a minus sign and contain no text of a spec."""
_CREATED = datetime(2000, 1, 1)
"""A fixed date, so that equal rows make an equal file."""


class Row(NamedTuple):
    """One field of one direction of a command; a key has no name."""

    command: str
    title: str
    code: str
    direction: str
    id: str
    nodes: str
    frame: str
    position: str
    bits: str
    field: str
    meaning: str
    raw: str
    raw_range: str
    resolution: str
    unit: str
    values: str
    only: str
    manual: str


def rows(edition: Edition, language: str) -> Iterator[Row]:
    """The rows of an edition, with texts in one of the languages of `LABELS`."""
    for command in edition.commands:
        for direction in Direction:
            message = command.message(direction)
            if message is not None:
                yield from _of_message(command, direction, message, language)


def _of_message(command: Command, direction: Direction, message: Message, language: str) -> Iterator[Row]:
    nodes = message.id.nodes
    labels = LABELS[language]
    length = labels["remote"] if message.remote else labels["bytes"].format(message.dlc)
    frame = f"{labels['extended' if message.id.extended else 'standard']}; {length}"
    start = (
        command.name,
        command.title[language],
        "" if command.code is None else f"0x{command.code:02X}",
        labels[direction.value],
        formatting.id_rule(message.id),
        f"{nodes[0]}..{nodes[-1]}" if nodes else "",
        frame,
    )
    only = formatting.condition(command.only)
    for key in message.keys:
        yield Row._make((*start, *_of_key(key, labels), "", "", "", "", only, command.manual))
    for field in message.layout.fields:
        for element in field.elements:
            yield Row._make(
                (*start, *_of_field(message, field, element, language, only), field.manual or command.manual)
            )
    if not message.keys and not message.layout.fields:
        yield Row._make((*start, "", "", "", "", "", "", "", "", "", only, command.manual))


_ROLES = {KeyRole.CODE: "selector", KeyRole.INDEX: "index", KeyRole.CONSTANT: "constant"}


def _of_key(key: Key, labels: Mapping[str, str]) -> tuple[str, str, str, str, str]:
    place = formatting.place(key.space, key.segments)
    return place, str(key.width), "", labels[_ROLES[key.role]], f"u{key.width} = 0x{key.value:02X}"


def _of_field(message: Message, field: Field, element: Element, language: str, only: str) -> tuple[str, ...]:
    type_ = field.type
    name = field.name if element.index is None else f"{field.name}[{element.index}]"
    limited = f"{message.layout.parameter} {', '.join(field.only)}" if field.only else ""
    members = type_.enum or type_.flags
    is_float = type_.encoding is Encoding.FLOAT
    not_given = LABELS[language]["not_given"]
    scales = [(names, not_given if text == "not given" else text) for names, text in formatting.scale(type_)]
    ranges = _cases(formatting.ranges(type_))
    raw_range = str(field.fixed) if field.fixed is not None else "" if is_float else ranges
    return (
        formatting.place(field.space, element.segments),
        str(type_.width),
        name,
        field.title[language],
        formatting.raw_format(type_, element.segments),
        raw_range,
        _cases(scales) if type_.is_number and not type_.is_plain else "",
        type_.unit.symbol if type_.unit else "",
        "; ".join(f"{member.value} {member.name}" for member in members) or (ranges if is_float else ""),
        "; ".join(filter(None, (only, limited))),
    )


def _cases(pairs: Sequence[tuple[str, str]]) -> str:
    return "; ".join(f"{names}: {text}" if names else text for names, text in pairs)


def csv_text(found: Sequence[Row], headings: Mapping[str, str]) -> bytes:
    """CSV in UTF-8 with the mark by which spreadsheets recognise it; no cell is a formula."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow([headings[name] for name in Row._fields])
    writer.writerows(
        [cell if name in _NUMBERS else _harmless(cell) for name, cell in zip(Row._fields, row, strict=True)]
        for row in found
    )
    return stream.getvalue().encode("utf-8-sig")


def _harmless(cell: str) -> str:
    return f"'{cell}" if cell.startswith(_FORMULA) else cell


def excel(found: Sequence[Row], headings: Mapping[str, str], title: str) -> bytes:
    """An Excel file with a filter and a fixed heading; equal rows make an equal file. Raises ImportError."""
    import xlsxwriter

    stream = io.BytesIO()
    book = xlsxwriter.Workbook(stream, {"in_memory": True})
    book.set_properties({"title": title, "created": _CREATED})
    sheet = book.add_worksheet()
    head = book.add_format({"bold": True, "text_wrap": True, "valign": "top"})
    body = book.add_format({"text_wrap": True, "valign": "top"})
    for column, name in enumerate(Row._fields):
        sheet.write_string(0, column, headings[name], head)
        longest = max((len(row[column]) for row in found), default=0)
        sheet.set_column(column, column, min(36, max(6, longest, len(headings[name]))))
    for at, row in enumerate(found, 1):
        for column, cell in enumerate(row):
            sheet.write_string(at, column, cell, body)
    sheet.freeze_panes(1, 1)
    sheet.autofilter(0, 0, len(found), len(Row._fields) - 1)
    sheet.set_landscape()
    sheet.set_paper(9)
    sheet.fit_to_pages(1, 0)
    sheet.repeat_rows(0)
    book.close()
    return stream.getvalue()
