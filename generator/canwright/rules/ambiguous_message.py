"""Two messages that a receiver cannot tell apart have one layout."""

from __future__ import annotations

from ..model import Direction, Key, Message, Segment, Space
from .duplicate_code import sends_the_same
from .ids import messages_meet
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    edition = subject.edition
    for direction in Direction:
        messages = list(edition.messages(direction))
        for i, message in enumerate(messages):
            for other in messages[:i]:
                if message.layout is other.layout or not _same_frame(message, other):
                    continue
                if not sends_the_same(edition.command(message.command), edition.command(other.command)):
                    text = (
                        f"nothing tells this {direction.value} from that of `{other.command}`, but their fields differ"
                    )
                    hint = "give one of them another code or id, a constant that the other has not, or let them share a layout"
                    yield Finding(message.path, text, hint)


def _same_frame(one: Message, other: Message) -> bool:
    if _is_rest(one, other) or _is_rest(other, one):
        return False
    pairs = [(k, o) for k in one.keys for o in other.keys if _place(k) == _place(o)]
    return not any(k.value != o.value for k, o in pairs) and messages_meet(one, other)


def _is_rest(one: Message, other: Message) -> bool:
    """Whether one message is any frame but the other: it has fields where the other has further keys."""
    shared = {(_place(key), key.value) for key in one.keys}
    further = [key for key in other.keys if (_place(key), key.value) not in shared]
    fields = {bit for f in one.layout.fields for e in f.elements for bit in _bits(f.space, e.segments)}
    covered = any(not fields.isdisjoint(_bits(key.space, key.segments)) for key in further)
    return covered and len(further) == len(other.keys) - len(one.keys)


def _bits(space: Space, segments: tuple[Segment, ...]) -> set[tuple[Space, int]]:
    return {(space, s.byte * 8 + s.low + i) for s in segments for i in range(s.width)}


def _place(key: Key) -> tuple[object, ...]:
    return (key.space, key.segments)
