"""Two messages that a receiver cannot tell apart have one layout."""

from __future__ import annotations

from ..model import Direction, Message, Space
from . import alike, ids
from .duplicate_code import sends_the_same
from .rule import Finding, Found, Subject

_ID_KEYS, _DATA = 32, 64
"""Where the bits of keys stand behind those of the id."""


def check(subject: Subject) -> Found:
    edition = subject.edition
    for direction in Direction:
        messages = edition.messages(direction)
        for i, j in alike.pairs([_known(message) for message in messages]):
            message, other = messages[i], messages[j]
            if message.layout is other.layout or not _same_frame(message, other):
                continue
            if not sends_the_same(edition.command(message.command), edition.command(other.command)):
                text = f"nothing tells this {direction.value} from that of `{other.command}`, but their fields differ"
                hint = "give one of them another code, id or dlc, a constant that the other has not, or let them share a layout"
                yield Finding(message.path, text, hint)


def _known(message: Message) -> alike.Known:
    """What is known of a frame of a message: its id, and behind that the bits that keys fix."""
    mask, value = ids.known(ids.of_message(message), ids.free_bits(message))
    for (space, bit), held in _fixed(message).items():
        at = bit + (_ID_KEYS if space is Space.ID else _DATA)
        mask |= 1 << at
        value |= held << at
    return alike.Known(mask, value)


def _same_frame(one: Message, other: Message) -> bool:
    if not ids.messages_meet(one, other):
        return False
    first, second = _fixed(one), _fixed(other)
    if (one.id, first) == (other.id, second) and one.dlc != other.dlc and not one.remote:
        return False
    differ = any(second.get(bit, value) != value for bit, value in first.items())
    return not (differ or _is_rest(one, first, second) or _is_rest(other, second, first))


Bits = dict[tuple[Space, int], int]


def _fixed(message: Message) -> Bits:
    """The bits that the keys of a message fix, with what they hold."""
    return {
        (key.space, s.byte * 8 + s.low + i): key.value >> (s.raw_low + i) & 1
        for key in message.keys
        for s in key.segments
        for i in range(s.width)
    }


def _is_rest(message: Message, mine: Bits, others: Bits) -> bool:
    """Whether a message is any frame but the other: it has fields where that one has further keys."""
    fields = {(f.space, bit) for f in message.layout.fields for e in f.elements for bit in e.bits}
    return set(mine) < set(others) and not fields.isdisjoint(set(others) - set(mine))
