"""No two fields of one message share a bit, nor a field and a key."""

from __future__ import annotations

from ..model import Direction, Key, Message, Path, Segment, Space, Variant
from ..schema import EditionSpec
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
            for finding in _clashes(subject.spec, message, variant):
                if finding not in seen:
                    seen.add(finding)
                    yield finding


def _clashes(spec: EditionSpec, message: Message, variant: Variant) -> Found:
    taken: dict[tuple[Space, int, int], str] = {}
    for key in message.keys:
        bits = [bit for segment in key.segments for bit in _bits(key.space, segment)]
        clash = next((bit for bit in bits if bit in taken), None)
        if clash is not None and key.is_index:
            text = f"the table's index shares {_where(clash)} with {taken[clash]}"
            at = _place_of(spec, message, key)
            yield Finding(at, text, "move one of them", about=at[:3])
        taken |= dict.fromkeys(bits, INDEX if key.is_index else "the selector")
    for field in variant.fields:
        for element in field.elements:
            bits = [bit for s in element.segments for bit in _bits(field.space, s)]
            clash = next((bit for bit in bits if bit in taken), None)
            if clash is not None:
                hint = WITHOUT_INDEX if taken[clash] == INDEX and message.direction is Direction.REPLY else APART
                yield Finding((*field.path, "at"), f"`{field.name}` shares {_where(clash)} with {taken[clash]}", hint)
            taken.update(dict.fromkeys(bits, f"`{field.name}`"))


def _place_of(spec: EditionSpec, message: Message, key: Key) -> Path:
    """Where it is said which bits a key of a table is in."""
    table = spec.commands[str(message.path[1])].table or ""
    path: Path = ("tables", table, "index")
    number = int(key.name.removeprefix("index").removeprefix("_") or 1) - 1
    return (*path, number, "at") if isinstance(spec.tables[table].index, list) else (*path, "at")


def _where(place: tuple[Space, int, int]) -> str:
    space, byte, bit = place
    return f"bit {bit} of byte {byte}" if space is Space.DATA else f"bit {bit} of the id"


def _bits(space: Space, segment: Segment) -> list[tuple[Space, int, int]]:
    return [(space, segment.byte, segment.low + i) for i in range(segment.width)]
