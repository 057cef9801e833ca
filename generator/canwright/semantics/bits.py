"""Bits of frames as integers: of the id, and of the data as one little-endian integer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..model.layout import Segment, Space


def placed(segments: Iterable[Segment], raw: int) -> int:
    """The bits of a raw integer at their position."""
    bits = 0
    for s in segments:
        bits |= (raw >> s.raw_low & (1 << s.width) - 1) << s.byte * 8 + s.low
    return bits


def data_bits(places: Iterable[tuple[Space, Sequence[Segment]]]) -> int:
    """The data bits of some segments as a mask."""
    taken = 0
    for space, segments in places:
        if space is Space.DATA:
            taken |= placed(segments, -1)
    return taken
