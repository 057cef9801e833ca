"""No two fields of one message share a bit, nor a field and a key."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Direction, Message, Path, Segment, Space, Variant
from .rule import Finding, Found, Subject

INDEX = "the table's index"
APART = "move one of them, or let `only` tell them apart"
WITHOUT_INDEX = (
    "move it; where replies come without the index, write them once as a command of their own, with `request: none`, "
    "and `reply: {of: COMMAND}` here"
)


def check(subject: Subject) -> Found:
    seen = set()
    for message in subject.edition.all_messages():
        for variant in message.layout.variants:
            for path, text, hint in _clashes(message, variant):
                if (path, text) not in seen:
                    seen.add((path, text))
                    yield Finding(path, text, hint)


def _clashes(message: Message, variant: Variant) -> Iterator[tuple[Path, str, str]]:
    taken = {
        bit: INDEX if key.is_index else "the selector"
        for key in message.keys
        for segment in key.segments
        for bit in _bits(key.space, segment)
    }
    for field in variant.fields:
        for element in field.elements:
            bits = [bit for s in element.segments for bit in _bits(field.space, s)]
            clash = next((bit for bit in bits if bit in taken), None)
            if clash is not None:
                space, byte, bit = clash
                where = f"bit {bit} of byte {byte}" if space is Space.DATA else f"bit {bit} of the id"
                hint = WITHOUT_INDEX if taken[clash] == INDEX and message.direction is Direction.REPLY else APART
                yield (*field.path, "at"), f"`{field.name}` shares {where} with {taken[clash]}", hint
            taken.update(dict.fromkeys(bits, f"`{field.name}`"))


def _bits(space: Space, segment: Segment) -> list[tuple[Space, int, int]]:
    return [(space, segment.byte, segment.low + i) for i in range(segment.width)]
