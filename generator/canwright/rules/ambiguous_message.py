"""Two messages that a receiver cannot tell apart have one layout."""

from __future__ import annotations

from ..model import Direction, Edition, Key, Message, Segment, Space
from .rule import Found


def check(edition: Edition) -> Found:
    for direction in Direction:
        messages = list(edition.messages(direction))
        for i, message in enumerate(messages):
            for other in messages[:i]:
                if message.layout is not other.layout and _same_frame(message, other):
                    text = (
                        f"nothing tells this {direction.value} from that of `{other.command}`, but their fields differ"
                    )
                    yield message.path, text, "give one of them another code or id, or let them share a layout"


def _same_frame(one: Message, other: Message) -> bool:
    if (one.id, one.remote) != (other.id, other.remote) or _is_rest(one, other) or _is_rest(other, one):
        return False
    pairs = [(k, o) for k in one.keys for o in other.keys if _place(k) == _place(o)]
    return not any(k.value != o.value for k, o in pairs)


def _is_rest(one: Message, other: Message) -> bool:
    """Whether a message without a key has fields where the other has its keys: it is any frame but that one."""
    fields = {bit for f in one.layout.fields for e in f.elements for s in e.segments for bit in _bits(f.space, s)}
    return not one.keys and any(bit in fields for key in other.keys for s in key.segments for bit in _bits(key.space, s))


def _bits(space: Space, segment: Segment) -> set[tuple[Space, int]]:
    return {(space, segment.byte * 8 + segment.low + i) for i in range(segment.width)}


def _place(key: Key) -> tuple[object, ...]:
    return (key.space, key.segments)
