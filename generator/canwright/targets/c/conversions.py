"""Conversions between raw integers and thousandths of the unit, with integers only.

The arithmetic is chosen at generation time, so that no operation overflows.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.types import Encoding, Linear, Type, factors
from .choices import Choice, choose, parameter_access
from .expressions import INT64, Integer, call, common, integer, joined, operand
from .names import Names
from .validity import Condition, constant_limits, has_constant_limits

ABOVE, BELOW = 1 << 31, 1 << 32
"""The limits of numerator and denominator of a ratio, excluded."""


class Formula(NamedTuple):
    """A number computed from another, or the `status` why there is none."""

    status: str = ""
    number: str = ""
    ratio: str = ""
    """The parameter that multiplies the scale; it must be above 0."""
    factor: str = ""
    """The call that computes `ratio`, a variable, from several parameters; empty for one."""
    out_of_range: str = ""
    """The condition under which the number is rejected."""
    share: str = ""
    """Arguments for `canwright_share64`, which computes `steps` and rejects what is out of range."""
    linear: str = ""
    """The initializer of the `canwright_linear_t` that `number` uses; empty if it uses none."""

    @property
    def uses_parameters(self) -> bool:
        return bool(self.ratio)


NO_SCALE = Formula(status="NO_SCALE")
MISSING_PARAMETER = Formula(status="MISSING_PARAMETER")
OUT_OF_RANGE = Formula(status="OUT_OF_RANGE")


class ConversionView:
    """A pair of functions between the raw integer and a number of type `kind`.

    `to` returns a status if it can fail, else the number. `from_` returns the raw integer, of type `wide`; for floating
    point, it calls a function that stores it and returns a status. `check` is the part of the range check that needs a
    parameter.
    """

    def __init__(
        self,
        kind: str,
        to: Choice[Formula],
        from_: Choice[Formula],
        wide: str,
        check: Choice[Condition] | None,
        *,
        to_fails: bool,
    ) -> None:
        self.kind, self.to, self.from_, self.wide, self.check, self.to_fails = kind, to, from_, wide, check, to_fails
        self.to_parameters = to.uses_parameters
        self.from_parameters = from_.uses_parameters or (check is not None and check.uses_parameters)
        self.has_shares = any(formula.share for formula in from_.alternatives)


def nearest(number: Fraction) -> int:
    """The nearest integer, ties away from zero."""
    magnitude = math.floor(abs(number) + Fraction(1, 2))
    return magnitude if number >= 0 else -magnitude


class _Milli(NamedTuple):
    """thousandths = (raw * factor + addend) / divisor, for one scale.

    A parameter that multiplies the scale is a ratio of 31 bits over 32 bits; results are exact if all other numbers fit
    the rest of 64 bits.
    """

    factor: int
    addend: int
    divisor: int

    @classmethod
    def of(cls, linear: Linear) -> _Milli:
        return cls(*Linear(linear.scale * 1000, linear.offset * 1000).as_quotient)

    def thousandths(self, raw: int) -> int:
        return nearest(Fraction(raw * self.factor + self.addend, self.divisor))

    def raw(self, thousandths: int) -> int:
        return nearest(Fraction(thousandths * self.divisor - self.addend, self.factor))

    def steps_from(self, raw: int) -> tuple[int, ...]:
        """The intermediate results of the conversion from a raw integer, including the rounding."""
        product = raw * self.factor + self.addend
        return raw * self.factor, product - self.divisor // 2, product + self.divisor // 2

    def steps_to(self, thousandths: int) -> tuple[int, ...]:
        product = thousandths * self.divisor - self.addend
        half = abs(self.factor) // 2
        return thousandths * self.divisor, product - half, product + half

    def span(self, low: int, high: int, kind: Integer) -> tuple[int, int]:
        """The range of thousandths within `kind` whose nearest raw integer is from `low` to `high`.

        Without any, the first is above the last.
        """
        first, last = sorted((self.thousandths(low), self.thousandths(high)))
        farthest = abs(self.factor) // (2 * self.divisor) + 1
        steps = range(farthest, -3, -1)
        least = next((first - step for step in steps if low <= self.raw(first - step) <= high), 1)
        most = next((last + step for step in steps if low <= self.raw(last + step) <= high), 0)
        return max(least, kind.limits[0]), min(most, kind.limits[1])

    def fits_with_ratio(self, ends: tuple[int, int], limits: tuple[int, int]) -> bool:
        """Whether 64 bits are enough from every raw integer within `ends`, and to every one within `limits`."""
        dividend = max(abs(raw * self.factor + self.addend) for raw in ends)
        forward = dividend * ABOVE + self.divisor * BELOW
        back = self._most(limits) * self.divisor * ABOVE + (abs(self.addend) + abs(self.factor)) * ABOVE
        return INT64.holds(forward, back)

    def _most(self, limits: tuple[int, int]) -> int:
        """The maximum of the thousandths, for a ratio of 1, whose nearest raw integer is within limits."""
        ends = (abs(Fraction(raw * self.factor + self.addend, self.divisor)) for raw in limits)
        return math.ceil(max(ends) + abs(Fraction(self.factor, self.divisor))) + 1

    def share_arguments(self, limits: tuple[int, int]) -> str:
        """The arguments of `canwright_share64` after ratio and thousandths; raw integers are within `limits`."""
        sign = -1 if self.factor < 0 else 1
        numbers = (self._most(limits), sign * self.divisor, sign * self.addend, sign * self.factor, *limits)
        return ", ".join(INT64.literal(number) for number in numbers)

    def dividend(self, raw: str, kind: Integer) -> str:
        """The expression of `raw * factor + addend` in an integer type."""
        return _sum(raw if self.factor == 1 else f"{raw} * {kind.literal(self.factor)}", kind, self.addend)


def milli(names: Names, type_: Type, valid: Choice[Condition] | None) -> ConversionView | None:
    """Conversions to thousandths of the unit; None without a scale, or if 64 bits are not enough."""
    known = [_Milli.of(linear) for _, linear in type_.linear.distinct() if linear is not None and not linear.times]
    if type_.encoding is Encoding.FLOAT or not type_.is_number or type_.is_plain or not (known or type_.times):
        return None
    for ends in (integer(type_).limits, type_.raw_limits):
        kind = _milli_kind(type_, known, ends)
        if kind is not None:
            return _milli(names, type_, kind, ends, valid)
    return None


def _milli_kind(type_: Type, known: Sequence[_Milli], ends: tuple[int, int]) -> Integer | None:
    """The integer type for the thousandths of every raw integer; None if the arithmetic exceeds 64 bits."""
    of_numbers = [_Milli.of(linear) for _, linear in type_.linear.distinct() if linear is not None and linear.times]
    if not all(m.fits_with_ratio(ends, constant_limits(type_)) for m in of_numbers):
        return None
    kind = INT64 if of_numbers else common(*(m.thousandths(end) for m in known for end in ends))
    if (
        kind is None
        or common(*ends, *itertools.chain.from_iterable(m.steps_from(e) for m in known for e in ends)) is None
    ):
        return None
    spans = [(m, end) for m in known for end in m.span(*constant_limits(type_), kind)]
    return kind if common(*itertools.chain.from_iterable(m.steps_to(end) for m, end in spans)) else None


def _milli(
    names: Names, type_: Type, kind: Integer, ends: tuple[int, int], valid: Choice[Condition] | None
) -> ConversionView:
    beyond = _beyond(integer(type_), "raw", *ends)
    fails = bool(beyond or type_.no_values) or type_.linear.parameter is not None or bool(type_.times)

    def to(linear: Linear) -> Formula:
        m, raw = _Milli.of(linear), integer(type_)
        if linear.times is None:
            return Formula(number=_to_milli(m, kind, raw, ends), out_of_range=beyond)
        dividend = m.dividend(_cast(INT64, raw, "raw"), INT64)
        return Formula(number=f"canwright_multiple64(&{ratio(linear)}, {dividend}, {m.divisor})", out_of_range=beyond)

    def from_(linear: Linear) -> Formula:
        m, raw = _Milli.of(linear), integer(type_)
        if linear.times is None:
            return _from_milli(m, kind, type_)
        return Formula(number=f"({raw.name})steps", share=m.share_arguments(constant_limits(type_)))

    check = None if has_constant_limits(type_) else valid
    choices = by_scale(names, type_, to), by_scale(names, type_, from_)
    return ConversionView(kind.name, *choices, integer(type_).name, check, to_fails=fails)


def by_scale(
    names: Names, type_: Type, formula: Callable[[Linear], Formula], unknown: Formula = MISSING_PARAMETER
) -> Choice[Formula]:
    """The formula for each scale of a type with what multiplies the scale; `unknown` if the parameter is not given."""

    def of(linear: Linear | None) -> Formula:
        if linear is None:
            return NO_SCALE
        made = formula(linear)
        return made if made == NO_SCALE else made._replace(ratio=ratio(linear), factor=factor(linear))

    return choose(names, type_.linear, of, unknown)


def ratio(linear: Linear) -> str:
    """The parameter that multiplies a scale, or the variable with a factor of several."""
    if linear.times is None:
        return ""
    return "factor" if factor(linear) else parameter_access(linear.times)


def factor(linear: Linear) -> str:
    """The call that computes a factor of several parameters; empty for one and for none."""
    if linear.times is None or linear.times.isidentifier():
        return ""
    above, below = factors(linear.times)
    names = [*above, *[""] * (2 - len(above)), *below, *[""] * (1 - len(below))]
    return call("canwright_factor", "&factor", *(f"&{parameter_access(name)}" if name else "NULL" for name in names))


def _to_milli(m: _Milli, kind: Integer, raw: Integer, ends: tuple[int, int]) -> str:
    narrow = common(*ends, *itertools.chain.from_iterable(m.steps_from(end) for end in ends))
    wide = kind if kind == INT64 or narrow is None else narrow
    source = _cast(wide, raw, "raw")
    return _quotient(m.dividend(source, wide), wide, m.divisor, kind)


def _from_milli(m: _Milli, kind: Integer, type_: Type) -> Formula:
    low, high = m.span(*constant_limits(type_), kind)
    if low > high and has_constant_limits(type_):  # a comparison with both would always be true
        return OUT_OF_RANGE
    wide = common(*itertools.chain.from_iterable(m.steps_to(end) for end in (low, high))) or INT64
    source = _cast(wide, kind, "milli")
    factor, divisor, addend = (m.factor, m.divisor, -m.addend) if m.factor > 0 else (-m.factor, -m.divisor, m.addend)
    product = source if divisor == 1 else f"{source} * {wide.literal(divisor)}"
    quotient = _quotient(_sum(product, wide, addend), wide, factor, integer(type_))
    return Formula(number=quotient, out_of_range=_beyond(kind, "milli", low, high))


def _quotient(dividend: str, wide: Integer, divisor: int, kind: Integer) -> str:
    plain = divisor == 1
    quotient = dividend if plain else f"canwright_divide{wide.width}({dividend}, {wide.literal(divisor)})"
    if kind in (wide, INT64):
        return quotient
    return f"({kind.name})({quotient})" if plain else f"({kind.name}){quotient}"


def _sum(product: str, wide: Integer, addend: int) -> str:
    return f"{operand(product)} {'+' if addend > 0 else '-'} {wide.literal(abs(addend))}" if addend else product


def _cast(wide: Integer, kind: Integer, name: str) -> str:
    return name if wide == kind else f"({wide.name}){name}"


def _beyond(kind: Integer, name: str, low: int, high: int) -> str:
    """The condition for a number of type `kind` outside `low` to `high`; empty if the type excludes it."""
    least, most = kind.limits
    ends = [f"{name} < {kind.literal(low)}"] if low > least else []
    ends += [f"{name} > {kind.literal(high)}"] if high < most else []
    return joined("||", ends) if ends else ""
