"""Names that are longer than DBC readers take, and are cut."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath, Severity
from ...model.edition import Edition
from ...model.layout import Element, Field, Space
from ...model.message import Message
from ..base import NameProblem
from .fields import LETTER
from .frames import Part
from .text import NAME_LENGTH


def long_names(edition: Edition) -> Iterator[NameProblem]:
    """Every field whose signal would have a longer name, each once."""
    seen: set[DocumentPath] = set()
    for message in edition.all_messages():
        for field in message.layout.fields:
            name = max((n for e in field.elements for n in _signals(edition, message, field, e)), key=len)
            if field.space is Space.DATA and len(name) > NAME_LENGTH and field.path not in seen:
                seen.add(field.path)
                text = f"the signal `{name}` has {len(name)} characters, a DBC name has at most {NAME_LENGTH}"
                yield NameProblem(field.path, text, "it is cut there; a shorter name would be whole", Severity.WARNING)


def _signals(edition: Edition, message: Message, field: Field, element: Element) -> Iterator[str]:
    part = Part(edition.command(message.command), message, tuple(key.value for key in message.keys))
    name = f"{LETTER[message.direction]}{part.code}_{field.name}"
    name = name if element.index is None else f"{name}_{element.index}"
    yield name
    yield from (f"{name}_{flag.name}" for flag in field.type.flags)
