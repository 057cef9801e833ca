"""Two messages that a receiver cannot tell apart have one layout."""

from __future__ import annotations

from ..model import Direction, Edition, Key, Message
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
    if (one.id, one.remote) != (other.id, other.remote):
        return False
    pairs = [(k, o) for k in one.keys for o in other.keys if _place(k) == _place(o)]
    return not any(k.value != o.value for k, o in pairs)


def _place(key: Key) -> tuple[object, ...]:
    return (key.space, key.segments)
