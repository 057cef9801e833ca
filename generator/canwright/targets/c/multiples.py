"""Scales that are multiples of a number parameter: its checks, and thousandths with integers alone.

A number is a ratio of 31 bits above 32 bits, so all is exact where that much room is left of 64 bits.
"""

from __future__ import annotations

import math
from fractions import Fraction

from ...model.types import Linear
from .names import member
from .numbers import INT64, Integer

ABOVE, BELOW = 1 << 31, 1 << 32
"""Beyond the greatest numerator and denominator of a ratio."""

MISSING = "CANWRIGHT_MISSING_PARAMETER"
OUT_OF_RANGE = "CANWRIGHT_OUT_OF_RANGE"


def ratio(linear: Linear) -> str:
    """The parameter that a scale is a multiple of."""
    return f"parameters->{member(linear.times or '')}"


def unless_above_zero(linear: Linear) -> list[str]:
    """What refuses a parameter that is not known or not above 0; nothing where there is none."""
    if linear.times is None:
        return []
    checks = ((".denominator == 0u", MISSING), (".numerator <= 0", OUT_OF_RANGE))
    return [line for test, status in checks for line in _returned(f"{ratio(linear)}{test}", status)]


class Thousandths:
    """thousandths = ratio * (raw * factor + addend) / divisor."""

    def __init__(self, linear: Linear, factor: int, addend: int, divisor: int) -> None:
        self._ratio = ratio(linear)
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

    def steps(self, limits: tuple[int, int], kind: Integer, *, checked: bool, braced: bool) -> list[str]:
        """What sets the raw integer, of type `kind`, or `nearest` where it is `checked` further."""
        sign = -1 if self._factor < 0 else 1
        numbers = (self._most(limits), sign * self._divisor, sign * self._addend, sign * self._factor, *limits)
        arguments = ", ".join(INT64.literal(number) for number in numbers)
        target = "nearest" if checked else "*raw"
        lines = [
            "int64_t steps;",
            *_returned(f"!canwright_share64(&steps, {self._ratio}, milli, {arguments})", OUT_OF_RANGE),
            f"{target} = ({kind.name})steps;",
            "break;" if checked else "return CANWRIGHT_OK;",
        ]
        return ["{", *(f"    {line}" for line in lines), "}"] if braced else lines


def _returned(condition: str, status: str) -> list[str]:
    return [f"if ({condition}) {{", f"    return {status};", "}"]
