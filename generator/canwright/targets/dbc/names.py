"""The names in DBC files: those that users of the files write, and those that exceed the limit of readers."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath, Severity
from ...model.edition import Edition
from ...model.layout import Element, Field, Space
from ..base import NameProblem
from ..options import Options
from .fields import LETTER
from .files import files, node_name, traffics
from .frames import Part
from .selection import NODES
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


def exported_names(edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
    """The host, the first node of each address, signals, and names of values, each with the path of its item."""
    yield ("bus", "host"), edition.bus.host
    both = traffics(edition)
    parts = [part for traffic in both.values() for frame in traffic.frames({}) for part in frame.parts]
    first = {part.message.address: part.message.id.nodes[0] for part in parts if part.message.id.nodes}
    yield from ((("addresses", address), node_name(address, node)) for address, node in first.items())
    made = files(edition, both, {}, Options({NODES: tuple(sorted(set(first.values())))}))
    existing = {signal.name for file in made for message in file.messages for signal in message.signals}
    for part in parts:
        for field in part.message.layout.fields:
            for path, name in (pair for element in field.elements for pair in signals(part, field, element)):
                if name[:NAME_LENGTH] in existing:
                    yield path, name
                    yield from (((*field.type.path, "enum", member.name), member.name) for member in field.type.enum)
