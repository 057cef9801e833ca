"""The selectors of a message as bits and numbers, separate or joined.

Few readers support nested multiplexors. If all selectors of a message are adjacent, they can be read as one number,
which is a plain multiplexor.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator

from ...model.layout import ConstantRole, Space, bits_of
from ...model.message import Key
from .frames import Part


@functools.lru_cache(maxsize=1 << 10)
def bits(key: Key) -> tuple[int, ...]:
    """Frame bits of a key from the least significant up."""
    return bits_of(key.segments)


def selector_bits(part: Part) -> set[int]:
    return {bit for key, _ in part.selectors for bit in bits(key)}


def joined_span(part: Part) -> range | None:
    """The bits from the first selector to the last; None if there is only one, or if bits between them can vary."""
    if len(part.selectors) < 2:
        return None
    span = range(min(selector_bits(part)), max(selector_bits(part)) + 1)
    fixed = {bit for places, _ in _fixed(part) for bit in places}
    return span if fixed.issuperset(span) else None


def joined_value(part: Part, span: range) -> int:
    """The number in `span`, lowest bit first, in every frame of this part."""
    ones = {bit for places, value in _fixed(part) for i, bit in enumerate(places) if value >> i & 1}
    return sum(1 << i for i, bit in enumerate(span) if bit in ones)


def runs(numbers: Iterable[int], split: Iterable[int] = ()) -> list[tuple[int, ...]]:
    """Runs of adjacent numbers; each number in `split` is a run of its own."""
    found: list[list[int]] = []
    for n in sorted(numbers):
        if found and found[-1][-1] == n - 1 and n not in split and n - 1 not in split:
            found[-1].append(n)
        else:
            found.append([n])
    return list(map(tuple, found))


def _fixed(part: Part) -> Iterator[tuple[tuple[int, ...], int]]:
    """Bits with the same value in every frame of the part, and that value: selectors and constants."""
    yield from ((bits(key), value) for key, value in part.selectors)
    for field in part.message.layout.fields:
        if isinstance(field.role, ConstantRole) and field.space is Space.DATA and not field.only:
            yield from ((element.bits, field.role.raw) for element in field.elements)
