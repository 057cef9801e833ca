"""The CAN ids of messages and addresses, and whether two of them share one."""

from __future__ import annotations

from itertools import islice
from math import gcd

from ..model.layout import Space
from ..model.message import IdRule, Message
from ..semantics.plan import message_plan
from .bit_patterns import Known

ALL_BITS = (1 << 29) - 1
ENUMERATED = 1 << 16
"""The maximum number of nodes whose ids are enumerated; above, the bits of fields in the id are not excluded."""


def of_rule(rule: IdRule) -> range:
    """All ids of a rule, without the bits of keys and fields."""
    if rule.nodes is None:
        return range(rule.base, rule.base + 1)
    first, last = (rule.base + node * rule.node_step for node in (rule.nodes[0], rule.nodes[-1]))
    return range(first, last + 1, rule.node_step)


def of_message(message: Message) -> range:
    """All ids of a message, without the bits of fields."""
    keys = sum(k.value << k.segments[0].low for k in message.keys if k.space is Space.ID)
    ids = of_rule(message.id)
    return range(ids.start + keys, ids.stop + keys, ids.step)


def free_bits(message: Message) -> int:
    """The bits of the id that fields fill with any value."""
    required = message_plan(message).required
    fields = (f for f in message.layout.fields if f.space is Space.ID and f not in required)
    segments = [s for f in fields for e in f.elements for s in e.segments]
    return sum(((1 << s.width) - 1) << s.low for s in segments)


def known(ids: range, free: int = 0) -> Known:
    """The bits that all of these ids have in common, except the `free` ones."""
    differing = (1 << (ids[0] ^ ids[-1]).bit_length()) - (ids.step & -ids.step)
    mask = ALL_BITS & ~(max(differing, 0) | free)
    return Known(mask, ids[0] & mask)


def meet(left: range, right: range, free: int = 0) -> int | None:
    """The lowest id that two ranges share, without the `free` bits; None without one."""
    if free:
        ids = {id_ & ~free for id_ in islice(left, ENUMERATED)}
        shared = ids & {id_ & ~free for id_ in islice(right, ENUMERATED)}
        return min(shared, default=None)
    between, common = right.start - left.start, gcd(left.step, right.step)
    if between % common:
        return None
    turns = right.step // common
    first = left.start + between // common * pow(left.step // common, -1, turns) % turns * left.step
    every = left.step * turns
    first += max(0, -((first - right.start) // every)) * every
    return first if first in left and first in right else None
