"""Limits of a spec that are checked before it is resolved, because resolving it would take too long."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ..diagnostics.diagnostic import DocumentPath, SpecError
from ..document.document import Document
from ..language.edition import CommandSpec, EditionSpec, Fields, MessageSpec

MAX_COMMANDS = 3000
"""The maximum number of commands; a command with a table counts once for each entry."""
MAX_FIELDS = 20_000
"""The maximum number of fields that a spec defines; an array counts once for each element."""
MAX_REPLIES = 100_000
"""The maximum number of nodes in all `from_each`, because outputs list each of them."""


def check_limits(document: Document, spec: EditionSpec) -> None:
    """Raises SpecError for too many commands, fields or replies, at the first one above the limit."""
    entries = {name: len(table.entries) for name, table in spec.tables.items()}
    commands = {("commands", name): entries.get(command.table or "", 1) for name, command in spec.commands.items()}
    _check(document, commands.items(), MAX_COMMANDS, "commands, with one for each table entry,")
    _check(document, _elements(spec), MAX_FIELDS, "fields, with one for each element of an array,")
    _check(document, _replies(spec, entries), MAX_REPLIES, "nodes in `from_each`, with those of each table entry,")


def _check(document: Document, counts: Iterable[tuple[DocumentPath, int]], most: int, what: str) -> None:
    total, first = 0, None
    for path, count in counts:
        total += count
        if total > most and first is None:
            first = path
    if first is not None:
        text = f"the spec has {total} {what} which exceeds the maximum of {most}"
        hint = "split the protocol into several specs; this is the first one above the maximum"
        raise SpecError([document.finding(first, "too-large", text, hint, key=True)])


def _replies(spec: EditionSpec, entries: Mapping[str, int]) -> Iterator[tuple[DocumentPath, int]]:
    """The number of nodes that reply to each command."""
    for name, command in spec.commands.items():
        if isinstance(command.reply, MessageSpec) and command.reply.from_each:
            path: DocumentPath = ("commands", name, "reply", "from_each")
            yield path, len(command.reply.from_each) * entries.get(command.table or "", 1)


def _elements(spec: EditionSpec) -> Iterator[tuple[DocumentPath, int]]:
    """The number of elements of each field."""
    for path, fields in _fields(spec):
        for name, field in fields.items():
            yield (*path, name), len(field.array or (0,))


def _fields(spec: EditionSpec) -> Iterator[tuple[DocumentPath, Fields]]:
    for name, layout in spec.layouts.items():
        yield ("layouts", name, "fields"), layout.fields
    for name, table in spec.tables.items():
        for entry_name, entry in table.entries.items():
            if isinstance(entry.layout, dict):
                yield ("tables", name, "entries", entry_name, "layout"), entry.layout
    for name, command in spec.commands.items():
        yield from _fields_of(name, command)


def _fields_of(name: str, command: CommandSpec) -> Iterator[tuple[DocumentPath, Fields]]:
    for key, message in (("request", command.request), ("reply", command.reply)):
        path: DocumentPath = ("commands", name, key)
        if isinstance(message, dict):
            yield path, message
        elif isinstance(message, MessageSpec):
            parts = (("layout", message.layout), ("fields", message.fields))
            yield from (((*path, part), fields) for part, fields in parts if isinstance(fields, dict))
