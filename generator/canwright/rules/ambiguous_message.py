"""Two messages that a receiver cannot tell apart have one layout."""

from __future__ import annotations

from ..model import Direction, Key, Message
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
                    hint = "give one of them another code or id, or let them share a layout"
                    yield Finding(message.path, text, hint)


def _same_frame(one: Message, other: Message) -> bool:
    pairs = [(k, o) for k in one.keys for o in other.keys if _place(k) == _place(o)]
    return not any(k.value != o.value for k, o in pairs) and messages_meet(one, other)


def _place(key: Key) -> tuple[object, ...]:
    return (key.space, key.segments)
