"""The reference of an edition: tables of commands, shared layouts, types and errata, as data for the PDF."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import starmap
from typing import Any

from ...model import formatting
from ...model.golden_frames import Value
from ...model.message import Command, Direction, EchoReply, Message, OtherReply
from ..base import EditionInput
from . import matrix, sheets, spreadsheets
from .matrix import Cell, Row

_FIELDS = ("position", "field", "raw_and_range", "resolution_and_unit", "value_range", "meaning_and_values")
_TYPES = ("raw", "only", "raw_and_range", "resolution_and_unit", "value_range")

Content = tuple[tuple[str, ...], ...]
"""The cells of the fields of a message."""


def reference(item: EditionInput, rows: Sequence[Row], shown: matrix.Shown, title: str) -> Mapping[str, Any]:
    """Texts, lists and mappings of an edition; `rows` is its command matrix."""
    return _Reference(item, rows, shown).content(title)


class _Reference:
    """The parts of the reference of an edition."""

    def __init__(self, item: EditionInput, rows: Sequence[Row], shown: matrix.Shown) -> None:
        self._item, self._shown = item, shown
        self._edition, self._language, self._labels = item.edition, shown.language, shown.labels
        self._rows: dict[tuple[str, str], list[Row]] = {}
        for row in rows:
            self._rows.setdefault((str(row.command), str(row.direction)), []).append(row)
        self._layouts = self._shared_layouts()

    def content(self, title: str) -> Mapping[str, Any]:
        edition, shown = self._edition, self._shown
        return {
            "language": self._language,
            "title": title,
            "header": f"{edition.family} {edition.name}{f' ({edition.date})' if edition.date else ''}",
            "hash": edition.hash[:12],
            "about": edition.about[self._language],
            "labels": self._labels,
            "fields": [self._labels[name] for name in _FIELDS],
            "types_columns": [self._labels[name] for name in _TYPES],
            "sources": self._texts(sheets.sources(self._item, shown)),
            "parameters": [self._parameter(number) for number in range(len(edition.parameters))],
            "bus": list(self._bus()),
            "states": [[state.title[self._language], state.about[self._language]] for state in edition.states],
            "settings": [[limit.title[self._language], limit.about[self._language]] for limit in edition.settings],
            "commands": [self._command(command) for command in edition.commands],
            "layouts": [{"name": name, "rows": content} for content, name in self._layouts.items()],
            "types": list(self._types()),
            "errata": self._texts(row[:5] for row in sheets.errata(edition, shown)),
        }

    def _texts(self, rows: Iterator[Sequence[Cell]]) -> list[list[str]]:
        return [[spreadsheets.shown(cell) for cell in row] for row in rows]

    def _bus(self) -> Iterator[Sequence[str]]:
        """The modes with their bit rates, the number of nodes, the reply time and the ids of the addresses."""
        bus, labels = self._edition.bus, self._labels
        for mode in bus.modes:
            rates = labels["comma"].join(map(str, mode.bit_rates_kbps))
            default = f"{labels['default']} {mode.default_kbps}" if mode.default_kbps else ""
            yield [
                mode.title[self._language],
                self._shown.list((f"{rates} kbit/s", default)),
                mode.about[self._language],
            ]
        if bus.max_nodes is not None:
            yield [labels["max_nodes"], str(bus.max_nodes), ""]
        if bus.reply_within_ms is not None:
            yield [labels["reply_within_ms"], formatting.exact(bus.reply_within_ms), ""]
        for address in self._edition.addresses:
            ids = dict.fromkeys(map(formatting.id_rule, (address.request, address.reply)))
            yield [address.title[self._language], " / ".join(ids), address.about[self._language]]
        for neighbour in bus.neighbours:
            ids_ = formatting.id_range(neighbour.ids)
            yield [neighbour.title[self._language], ids_, neighbour.about[self._language]]

    def _parameter(self, number: int) -> Sequence[str]:
        parameter = self._edition.parameters[number]
        low, high = (
            "" if limit is None else formatting.exact(limit) for limit in (parameter.minimum, parameter.maximum)
        )
        limits = f"{low}..{high}" if low and high else f"≥ {low}" if low else f"≤ {high}" if high else ""
        values = self._labels["comma"].join(value.name for value in parameter.values) or limits
        return [parameter.name, parameter.title[self._language], values, parameter.about[self._language]]

    def _command(self, command: Command) -> Mapping[str, Any]:
        shown, labels = self._shown, self._labels
        texts = [command.about[self._language], *(note[self._language] for note in command.notes)]
        code = "" if command.code is None else f"{formatting.constant(command.code)} "
        facts = {
            "only": shown.condition(command.only),
            "effects": shown.list(effect.title[self._language] for effect in command.effects),
            "limited_by": shown.list(setting.title[self._language] for setting in command.limited_by),
            "erratum": shown.list(erratum.id for erratum in self._edition.errata_of(command)),
            "manual": formatting.cited(shown.section(command.manual), command.manual_name),
        }
        if not command.implemented:
            texts.insert(0, labels["not_implemented"])
        return {
            "name": command.name,
            "title": f"{code}{command.title[self._language]}",
            "texts": [text for text in texts if text],
            "facts": [labels["condition"].format(labels[name], text) for name, text in facts.items() if text],
            "messages": [self._message(command, message) for message in command.messages],
        }

    def _message(self, command: Command, message: Message) -> Mapping[str, Any]:
        """Where and how a message is sent, and its fields: a table, or the name of the layout that several messages have."""
        direction = self._labels[message.direction.value]
        rows = self._rows[command.name, direction]
        start = rows[0]
        keys = [f"{row.position} = {spreadsheets.shown(row.fixed)}" for row in rows if not row.field and row.position]
        facts = [start.id, start.nodes and f"{self._labels['nodes']} {start.nodes}", start.frame, *keys, start.answer]
        content = self._content(command, message)
        name = self._layouts.get(content, "")
        return {
            "direction": direction,
            "facts": self._shown.list(str(fact) for fact in facts),
            "layout": name,
            "rows": [] if name else content,
            "examples": self._examples(command, message.direction),
        }

    def _content(self, command: Command, message: Message) -> Content:
        """The fields of a message, none of one that repeats another; those of a shared layout for every parameter value."""
        repeats = (reply for reply in command.replies if isinstance(reply, EchoReply | OtherReply))
        if message.direction is Direction.REPLY and any(repeats):
            return ()
        rows: Iterable[Row] = self._rows[command.name, self._labels[message.direction.value]]
        if message.layout.shared:
            rows = matrix.rows_of(self._shown, replace(command, only={}), message)
        return tuple(self._field(row) for row in rows if row.field)

    def _examples(self, command: Command, direction: Direction) -> list[str]:
        """A golden frame of the message, if it has one, with the values."""
        frames = self._item.frames.reviewed.of_command.get((command.name, direction), ()) if self._item.frames else ()
        return [
            self._shown.list((formatting.sent(frame), *starmap(self._value, {**frame.raw, **frame.values}.items())))
            for frame in frames[:1]
        ]

    def _value(self, name: str, value: Value | int | list[int]) -> str:
        """`level = 2.5`."""
        single = value if isinstance(value, list) else [value]
        return f"{name} = {', '.join(v if isinstance(v, str) else formatting.exact(Fraction(v)) for v in single)}"

    def _field(self, row: Row) -> tuple[str, ...]:
        fixed = spreadsheets.shown(row.fixed)
        ranges = f"= {fixed}" if fixed else self._span(row.raw_minimum, row.raw_maximum, "")
        meaning = [row.meaning, row.values, row.manual_name, row.only]
        texts = self._shown.list(str(text) for text in meaning)
        return (*map(str, (row.position, row.field)), *self._numbers(row._asdict(), ranges), texts)

    def _numbers(self, cells: Mapping[str, Cell], ranges: str) -> tuple[str, str, str]:
        """Raw format with its range, resolution with its unit, and the range of the value."""
        given = [cells.get(name, "") for name in ("resolution", "offset", "unit", "printed", "minimum", "maximum")]
        resolution, offset, unit, printed, low, high = given
        step = str(printed).removeprefix("× ") or spreadsheets.shown(resolution)
        added = f" + {spreadsheets.shown(offset)}" if offset and step else ""
        return f"{cells['raw']} {ranges}".strip(), f"{step} {unit}{added}".strip(), self._span(low, high, f" {unit}")

    def _span(self, low: Cell, high: Cell, unit: str) -> str:
        is_empty = "" in (low, high)
        return "" if is_empty else f"{spreadsheets.shown(low)}..{spreadsheets.shown(high)}{unit}".strip()

    def _shared_layouts(self) -> Mapping[Content, str]:
        """The contents that several messages have, by the name of their layout; a number distinguishes variants."""
        users: dict[Content, list[str]] = {}
        for command in self._edition.commands:
            for message in command.messages:
                users.setdefault(self._content(command, message), []).append(message.layout.name)
        shared = {content: names[0] for content, names in users.items() if content and len(names) > 1}
        seen: list[str] = []
        named = {}
        for content, name in shared.items():
            seen.append(name)
            named[content] = name if seen.count(name) == 1 else f"{name} ({seen.count(name)})"
        return named

    def _types(self) -> Iterator[Mapping[str, Any]]:
        for type_ in self._edition.types:
            texts = [type_.title[self._language], type_.about[self._language]]
            rows = []
            for numbers in matrix.numbers_of(self._edition, type_) if type_.is_number else ():
                cells = {
                    "raw": formatting.raw_format(type_, words=self._shown.words),
                    **self._shown.numbers(type_, numbers),
                }
                ranges = self._span(cells.get("raw_minimum", ""), cells.get("raw_maximum", ""), "")
                raw, *rest = self._numbers({**cells, "raw": ""}, ranges)
                rows.append([str(cells["raw"]), self._shown.condition(numbers.only), raw, *rest])
            members = [
                [str(m.value), m.name, self._shown.list([m.title[self._language], m.about[self._language]])]
                for m in (*type_.enum, *type_.flags)
            ]
            yield {"name": type_.name, "text": self._shown.list(texts), "rows": rows, "members": members}
