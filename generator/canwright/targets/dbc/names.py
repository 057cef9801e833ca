"""Signal names that exceed the limit of DBC readers and are truncated."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath, Severity
from ...model.edition import Edition
from ...model.layout import Element, Field, Space
from ..base import NameProblem
from .fields import LETTER
from .frames import Part
from .text import NAME_LENGTH


def long_names(edition: Edition) -> Iterator[NameProblem]:
    """A problem for every field with a signal name that is too long."""
    seen: set[DocumentPath] = set()
    for message in edition.all_messages():
        part = Part(edition.command(message.command), message, tuple(key.value for key in message.keys))
        for field in message.layout.fields:
            name = max((n for e in field.elements for _, n in signals(part, field, e)), key=len)
            if field.space is Space.DATA and len(name) > NAME_LENGTH and field.path not in seen:
                seen.add(field.path)
                text = f"the signal name `{name}` has {len(name)} characters; the maximum in a DBC is {NAME_LENGTH}"
                yield NameProblem(field.path, text, "use a shorter name; this one is truncated", Severity.WARNING)


def signals(part: Part, field: Field, element: Element) -> Iterator[tuple[DocumentPath, str]]:
    """The names of the signals of a field, or of an element of an array, each with the path of the field or the flag."""
    name = f"{LETTER[part.message.direction]}{part.code}_{field.name}"
    name = name if element.index is None else f"{name}_{element.index}"
    yield from (((*field.type.path, "flags", flag.name), f"{name}_{flag.name}") for flag in field.type.flags)
    if not field.type.flags:
        yield field.path, name
