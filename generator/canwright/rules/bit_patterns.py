"""Which of many things may be one frame, found without comparing each with every other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple


class Known(NamedTuple):
    """The bits of a frame that are known, as a mask, and what they hold."""

    mask: int
    value: int


def pairs(known: Sequence[Known]) -> Iterator[tuple[int, int]]:
    """The places of every two that agree in all bits that both know: the later one, then the earlier one, in order.

    There are few masks, so those that agree are looked up by the bits that a mask shares with another.
    """
    masks = dict.fromkeys(mask for mask, _ in known)
    earlier: dict[tuple[int, int, int], list[int]] = defaultdict(list)
    for place, (mask, value) in enumerate(known):
        agreeing = [found for other in masks for found in earlier.get((other, mask, value & other), ())]
        yield from ((place, found) for found in sorted(agreeing))
        for other in masks:
            earlier[mask, other, value & other].append(place)
