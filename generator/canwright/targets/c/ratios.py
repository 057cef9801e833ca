"""Scales with a number parameter as a factor: thousandths with integers alone.

A number is a ratio of 31 bits above 32 bits, so all is exact where that much room is left of 64 bits.
"""

from __future__ import annotations

import math
from fractions import Fraction

from ...model.types import Linear
from .choices import parameter_access
from .numbers import INT64

ABOVE, BELOW = 1 << 31, 1 << 32
"""Beyond the greatest numerator and denominator of a ratio."""


class RatioMilli:
    """thousandths = ratio * (raw * factor + addend) / divisor."""

    def __init__(self, linear: Linear, factor: int, addend: int, divisor: int) -> None:
        self._ratio = parameter_access(linear.times or "")
        self._factor, self._addend, self._divisor = factor, addend, divisor

    def fit(self, ends: tuple[int, int], limits: tuple[int, int]) -> bool:
        """Whether 64 bits are enough from every raw integer within `ends`, and to every one within `limits`."""
        dividend = max(abs(raw * self._factor + self._addend) for raw in ends)
        there = dividend * ABOVE + self._divisor * BELOW
        back = self._most(limits) * self._divisor * ABOVE + (abs(self._addend) + abs(self._factor)) * ABOVE
        return INT64.holds(there, back)

    def _most(self, limits: tuple[int, int]) -> int:
        """Thousandths, of a ratio of 1, beyond which no raw integer within limits is the nearest."""
        ends = (abs(Fraction(raw * self._factor + self._addend, self._divisor)) for raw in limits)
        return math.ceil(max(ends) + abs(Fraction(self._factor, self._divisor))) + 1

    def number(self, raw: str) -> str:
        """The thousandths of a raw integer that is already one of 64 bits."""
        product = raw if self._factor == 1 else f"{raw} * {self._factor}"
        added = f" {'+' if self._addend > 0 else '-'} {abs(self._addend)}" if self._addend else ""
        return f"canwright_multiple64({self._ratio}, {product}{added}, {self._divisor})"

    def share_arguments(self, limits: tuple[int, int]) -> str:
        """What `canwright_share64` needs besides the ratio and the thousandths; raw integers lie within `limits`."""
        sign = -1 if self._factor < 0 else 1
        numbers = (self._most(limits), sign * self._divisor, sign * self._addend, sign * self._factor, *limits)
        return ", ".join(INT64.literal(number) for number in numbers)
