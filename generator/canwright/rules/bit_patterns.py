"""Bit patterns of frames: pairs that one frame can match, without a comparison of each with every other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple


class Known(NamedTuple):
    """The known bits of a frame: a mask and their values."""

    mask: int
    value: int


MAX_STEPS = 1_000_000
"""The maximum number of steps of one search, a few seconds; very few protocols need more than a thousand."""


class TooManyPairsError(Exception):
    """A search ended after `MAX_STEPS` steps; pairs may be missing."""


def pairs(known: Sequence[Known]) -> Iterator[tuple[int, int]]:
    """The indices of every pair that agrees in all bits known of both: the later one, then the earlier one, in order.

    There are few masks, so a table finds the patterns that agree, by the bits that two masks share. Raises TooManyPairsError
    if there are very many masks or pairs.
    """
    masks = dict.fromkeys(mask for mask, _ in known)
    earlier: dict[tuple[int, int, int], list[int]] = defaultdict(list)
    steps = 0
    for index, (mask, value) in enumerate(known):
        agreeing = [
            match for earlier_mask in masks for match in earlier.get((earlier_mask, mask, value & earlier_mask), ())
        ]
        steps += len(masks) + len(agreeing)
        if steps > MAX_STEPS:
            raise TooManyPairsError
        yield from ((index, match) for match in sorted(agreeing))
        for earlier_mask in masks:
            earlier[mask, earlier_mask, value & earlier_mask].append(index)
