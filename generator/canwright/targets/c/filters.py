"""Acceptance filters: the id and the mask with which a controller or a socket receives the frames of an address.

A frame passes if `(frame.id & mask) == (filter.id & mask)`, as in SocketCAN; both include the flags for 29-bit ids and
remote frames. The mask has every bit that is the same in all ids, so no single filter accepts fewer frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from operator import or_
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import ConstantRole, Segment, Space
from ...model.message import Address, Direction, Message

EXTENDED, REMOTE = 1 << 31, 1 << 30
STANDARD_BITS, EXTENDED_BITS = (1 << 11) - 1, (1 << 29) - 1
MANY_NODES = 1 << 16
"""Of so many ids, all bits between the lowest and the highest that differ are different somewhere."""


class Filter(NamedTuple):
    """The frames of an address: `id` and `mask` of one node, without the part of the id that depends on the node."""

    id: int
    mask: int
    all_id: int
    """The id for all nodes."""
    all_mask: int
    """The mask for all nodes."""
    is_exact: bool
    """False if the filter for all nodes also accepts ids that the address does not have."""


def address_filter(edition: Edition, address: Address, direction: Direction) -> Filter:
    """The filter for the messages of an address; there is at least one."""
    rule = address.rule(direction)
    kind, width = (EXTENDED, EXTENDED_BITS) if rule.extended else (0, STANDARD_BITS)
    messages = [m for m in edition.of_rule(direction, rule) if m.address == address.name]
    patterns = [pattern for message in messages for pattern in _patterns(message)]
    values = [value for value, _ in patterns]
    mask = (EXTENDED | REMOTE | width) & ~(_differing(values) | reduce(or_, (free for _, free in patterns)))
    nodes = rule.nodes or range(1)
    first, last = (rule.base + node * rule.node_step for node in (nodes[0], nodes[-1]))
    if len(nodes) < MANY_NODES:
        of_nodes = _differing(range(first, last + 1, rule.node_step))
    else:
        of_nodes = ((1 << (first ^ last).bit_length()) - 1) & -(rule.node_step & -rule.node_step)
    all_mask = mask & ~of_nodes
    is_exact = 1 << of_nodes.bit_count() == len(nodes)
    return Filter(values[0] & mask, mask, (values[0] | first | kind) & all_mask, all_mask, is_exact)


def _patterns(message: Message) -> Iterator[tuple[int, int]]:
    """The bits of the id that keys and constant fields set, for each accepted code, and the bits that fields may set."""
    fixed, free = REMOTE * message.remote, 0
    for field in message.layout.fields:
        for element in field.elements if field.space is Space.ID else ():
            if isinstance(field.role, ConstantRole):
                fixed |= _bits(element.segments, field.role.raw)
            else:
                free |= _bits(element.segments, -1)
    first, *others = [_key_values(message, place) for place in range(len(message.keys))] or [[0]]
    fixed |= reduce(or_, (bits[0] for bits in others), 0)
    yield from ((fixed | bits, free) for bits in first)


def _key_values(message: Message, place: int) -> list[int]:
    """The bits of a key in the id, for each of its accepted values."""
    key = message.keys[place]
    values = (key.value, *(message.accepted_codes if place == 0 else ()))
    return [_bits(key.segments, value) if key.space is Space.ID else 0 for value in values]


def _bits(segments: Sequence[Segment], value: int) -> int:
    """The bits of a value in an id."""
    return reduce(or_, ((value >> s.raw_low & (1 << s.width) - 1) << s.low for s in segments), 0)


def _differing(ids: Sequence[int]) -> int:
    """The bits that are not the same in all ids."""
    return reduce(or_, (one ^ ids[0] for one in ids), 0)
