"""Patterns of frames: the id rule and the bits of the keys, which several messages share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from functools import reduce
from operator import or_
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Segment, Space
from ...model.message import Direction, Message


class Pattern(NamedTuple):
    """The common part of messages that differ only in length and codes."""

    address: str
    direction: Direction
    remote: bool
    id_mask: int
    places: tuple[tuple[Space, int, tuple[Segment, ...]], ...]


def pattern_of(message: Message) -> Pattern:
    return Pattern(
        message.address,
        message.direction,
        message.remote,
        message.id_mask,
        tuple((key.space, key.width, key.segments) for key in message.keys),
    )


def named_patterns(patterns: Iterable[Pattern]) -> dict[Pattern, tuple[str, ...]]:
    """The parts of the name of each pattern: address and direction, and a number from the second one on."""
    result: dict[Pattern, tuple[str, ...]] = {}
    numbers: Counter[tuple[str, str]] = Counter()
    for pattern in dict.fromkeys(patterns):
        name = (pattern.address, pattern.direction.value)
        numbers[name] += 1
        result[pattern] = name if numbers[name] == 1 else (*name, str(numbers[name]))
    return result


def address_mask(edition: Edition, address: str, direction: Direction) -> int:
    """Bits of the id that keys and fields fill in some message of this direction."""
    here = edition.address(address)
    rule = here.rule(direction)
    return reduce(or_, (m.id_mask for m in edition.of_rule(direction, rule)), 0)
