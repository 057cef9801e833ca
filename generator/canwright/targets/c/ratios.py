"""Scales with a number parameter as a factor: conversions to thousandths with integers only.

The parameter is a ratio of 31 bits over 32 bits. Results are exact if the other factors fit the rest of 64 bits.
"""

from __future__ import annotations

import math
from fractions import Fraction

from ...model.types import Linear
from .choices import parameter_access
from .expressions import operand
from .numbers import INT64

ABOVE, BELOW = 1 << 31, 1 << 32
"""The limits of numerator and denominator of a ratio, excluded."""


class RatioMilli:
    """thousandths = ratio * (raw * factor + addend) / divisor."""

    def __init__(self, linear: Linear, factor: int, addend: int, divisor: int) -> None:
        self._ratio = parameter_access(linear.times or "")
        self._factor, self._addend, self._divisor = factor, addend, divisor

    def fit(self, ends: tuple[int, int], limits: tuple[int, int]) -> bool:
        """Whether 64 bits are enough from every raw integer within `ends`, and to every one within `limits`."""
        dividend = max(abs(raw * self._factor + self._addend) for raw in ends)
        forward = dividend * ABOVE + self._divisor * BELOW
        back = self._most(limits) * self._divisor * ABOVE + (abs(self._addend) + abs(self._factor)) * ABOVE
        return INT64.holds(forward, back)

    def _most(self, limits: tuple[int, int]) -> int:
        """The maximum of the thousandths, for a ratio of 1, whose nearest raw integer is within limits."""
        ends = (abs(Fraction(raw * self._factor + self._addend, self._divisor)) for raw in limits)
        return math.ceil(max(ends) + abs(Fraction(self._factor, self._divisor))) + 1

    def number(self, raw: str) -> str:
        """The expression of the thousandths of a 64-bit raw integer."""
        product = raw if self._factor == 1 else f"{raw} * {self._factor}"
        if self._addend:
            product = f"{operand(product)} {'+' if self._addend > 0 else '-'} {abs(self._addend)}"
        return f"canwright_multiple64(&{self._ratio}, {product}, {self._divisor})"

    def share_arguments(self, limits: tuple[int, int]) -> str:
        """The arguments of `canwright_share64` after ratio and thousandths; raw integers are within `limits`."""
        sign = -1 if self._factor < 0 else 1
        numbers = (self._most(limits), sign * self._divisor, sign * self._addend, sign * self._factor, *limits)
        return ", ".join(INT64.literal(number) for number in numbers)
