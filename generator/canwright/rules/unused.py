"""Types, layouts, tables, parameters, effects and settings are used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..model import Edition, Message
from ..schema import EditionSpec, MessageSpec
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    if subject.partial:
        return
    spec, edition = subject.spec, subject.edition
    messages = list(edition.all_messages())
    fields = [f for m in messages for f in m.layout.fields]
    commands = edition.commands
    used: dict[str, set[str]] = {
        "types": {f.type.name for f in fields},
        "layouts": {m.layout.name for m in messages} | set(_named_layouts(spec)),
        "tables": {c.table for c in spec.commands.values() if c.table},
        "effects": {e.name for c in commands for e in c.effects} | _of_entries(spec),
        "settings": {s.name for c in commands for s in (*c.limited_by, *c.not_limited_by)},
        "parameters": set(_parameters(edition, messages)),
    }
    written: dict[str, Iterable[str]] = {
        "types": spec.types,
        "layouts": spec.layouts,
        "tables": spec.tables,
        "effects": spec.effects,
        "settings": spec.settings,
        "parameters": spec.parameters,
    }
    for kind, names in written.items():
        for name in names:
            if name not in used[kind]:
                text = f"nothing uses the {kind.removesuffix('s')} `{name}`"
                yield Finding((kind, name), text, "use it or remove it", key=True)


def _named_layouts(spec: EditionSpec) -> Iterator[str]:
    """Layouts that messages name and add fields to."""
    for command in spec.commands.values():
        for message in (command.request, command.reply):
            if isinstance(message, MessageSpec) and isinstance(message.layout, str):
                yield message.layout


def _of_entries(spec: EditionSpec) -> set[str]:
    return {name for table in spec.tables.values() for entry in table.entries.values() for name in entry.effects}


def _parameters(edition: Edition, messages: Iterable[Message]) -> Iterator[str]:
    for message in messages:
        yield from message.layout.parameters
        for field in message.layout.fields:
            spans = [span for _, span in field.type.raw_range.distinct() if span is not None]
            yield from (end.parameter for span in spans for end in (span.low, span.high) if end.parameter)
    for only in (*(c.only for c in edition.commands), *(s.only for s in edition.settings)):
        yield from only
