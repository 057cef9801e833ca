"""The names in DBC files, for `canwright diff`."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ..options import Options
from .files import files, node_name, traffics
from .names import signals
from .selection import NODES
from .text import NAME_LENGTH

Exported = tuple[DocumentPath, str]


def exported_names(edition: Edition) -> Iterator[Exported]:
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
