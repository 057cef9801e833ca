"""Random frames that are nearly those of a spec."""

from __future__ import annotations

import random
from collections.abc import Iterator

from canwright.model.edition import Edition
from canwright.model.layout import Space, bits_of
from canwright.model.message import Message
from canwright.semantics.frame import CanFrame


def random_frames(of_spec: Edition, count: int) -> Iterator[CanFrame]:
    """Frames that are nearly those of a message, of each message in turn."""
    chance = random.Random(1)
    messages = list(of_spec.all_messages())
    for i in range(count):
        yield random_frame(messages[i % len(messages)], chance.choice(messages), chance)


def random_frame(message: Message, another: Message, chance: random.Random) -> CanFrame:
    """A frame that is nearly that of a message: most have its id, its length and its keys, or those of another."""
    node = chance.choice(message.id.nodes) if message.id.nodes is not None else 0
    can_id = message.id.base + node * message.id.node_step
    length = message.dlc if chance.random() < 0.9 else chance.choice((another.dlc, chance.randrange(9)))
    word = chance.getrandbits(8 * length) * (chance.random() < 0.6)
    for key in (*message.keys, *(another.keys if chance.random() < 0.2 else ())):
        values = (key.value,) * 8 + (
            *message.accepted_codes,
            *message.identifying_codes,
            0,
            chance.getrandbits(key.width),
        )
        value = chance.choice(values)
        for number, bit in enumerate(bits_of(key.segments)):
            change = (value >> number & 1) << bit
            if key.space is Space.ID:
                can_id = can_id & ~(1 << bit) | change
            else:
                word = word & ~(1 << bit) | change
    noise = 1 << chance.randrange(29 if message.id.extended else 11)
    kind = chance.random()
    extended = message.id.extended is not (kind > 0.98)
    remote = message.remote is not (kind < 0.02)
    data = b"" if remote else (word & (1 << 8 * length) - 1).to_bytes(length, "little")
    return CanFrame(can_id ^ noise * (chance.random() < 0.1), data, extended, remote)
