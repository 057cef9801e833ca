"""No two fields of one message share a bit, nor a field and a key."""

from __future__ import annotations

from collections.abc import Iterator

from ..layouts import bits_of
from ..model import Direction, Message, Path, Space, Variant
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
    taken: dict[Space, dict[int, str]] = {space: {} for space in Space}
    for key in message.keys:
        taken[key.space].update(dict.fromkeys(bits_of(key.segments), INDEX if key.is_index else "the selector"))
    for field in variant.fields:
        others = taken[field.space]
        for element in field.elements:
            clash = next(filter(others.__contains__, element.bits), None)
            if clash is not None:
                where = (
                    f"bit {clash % 8} of byte {clash // 8}" if field.space is Space.DATA else f"bit {clash} of the id"
                )
                hint = WITHOUT_INDEX if others[clash] == INDEX and message.direction is Direction.REPLY else APART
                yield (*field.path, "at"), f"`{field.name}` shares {where} with {others[clash]}", hint
            others.update(dict.fromkeys(element.bits, f"`{field.name}`"))
