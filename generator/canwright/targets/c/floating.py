"""Conversions between raw integers and the unit as floating point: one operation a step, chosen at generation time."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from ...model.types import Encoding, Linear, Type
from .choices import Choice
from .conversions import ABOVE, BELOW, ConversionView, Formula, by_scale, factor, nearest, ratio
from .expressions import INT64, UINT64, Integer, common, integer, joined, operand, stored
from .names import Names
from .validity import Condition, constant_limits, has_constant_limits

COARSE = 1 << 51
"""Raw integers from here on are too many for the precision of a quotient of doubles."""
LARGEST = 1 << 64
"""The limit of raw integers."""
SPLIT = 40
"""The maximum width of raw integers for which the first part of a scale has enough bits."""
CORRECTABLE = 1 << 45
"""The limit of the numerator and denominator of a scale for `canwright_corrected`."""


class Format(NamedTuple):
    """A floating-point type of C; every integer up to `exact` is representable.

    `least` is the smallest number with full precision, `greatest` the largest one.
    """

    name: str
    suffix: str
    exact: int
    least: Fraction
    greatest: Fraction

    def literal(self, number: Fraction | int) -> str:
        """The nearest number of this type as a literal."""
        literal = f"{float(number)!r}{self.suffix}"
        return f"({literal})" if number < 0 else literal

    def has(self, *numbers: Fraction) -> bool:
        """Whether each number is 0 or has full precision in this type."""
        return all(number == 0 or self.least <= abs(number) <= self.greatest for number in numbers)


SINGLE = Format("float", "f", 1 << 24, Fraction(1, 1 << 126), Fraction(1 << 126))
DOUBLE = Format("double", "", 1 << 53, Fraction(1, 1 << 1022), Fraction(1 << 1022))


def is_wide(type_: Type) -> bool:
    """True if scale or offset needs integers of more than 63 bits."""
    return not all(INT64.holds(*map(abs, linear.as_quotient)) for linear in _linears(type_))


def has_floating(type_: Type, format_: Format) -> bool:
    """False for a type without a scale, and for values beyond the range of a floating-point type."""
    linears = _linears(type_) if type_.is_number and type_.joined is None else []
    greatest = 1 if type_.encoding is Encoding.FLOAT else max(map(abs, type_.raw_limits))
    return bool(linears) and all(format_.has(x.scale, x.scale * greatest, x.offset) for x in linears)


def _linears(type_: Type) -> list[Linear]:
    return [linear for _, linear in type_.linear.distinct() if linear is not None]


def floating(names: Names, type_: Type, valid: Choice[Condition] | None, format_: Format) -> ConversionView | None:
    """Conversions to the unit in a floating-point type; None without a scale in its range."""
    if not has_floating(type_, format_):
        return None
    is_float = type_.encoding is Encoding.FLOAT

    def to(linear: Linear) -> Formula:
        return Formula(number=_value(linear, type_, format_), ratio=ratio(linear), factor=factor(linear))

    def from_(linear: Linear) -> Formula:
        return Formula(number=_nearest(linear, type_, format_), ratio=ratio(linear), factor=factor(linear))

    return ConversionView(
        kind=format_.name,
        to=by_scale(names, type_, to),
        to_fails=type_.linear.parameter is not None or bool(type_.times or type_.no_values),
        from_=by_scale(names, type_, from_),
        wide=stored(type_) if is_float else _wide(type_).name,
        check=valid if is_float or not has_constant_limits(type_) else None,
    )


def _wide(type_: Type) -> Integer:
    """The type of the nearest raw integer."""
    return common(*integer(type_).limits) or UINT64


def _value(linear: Linear, type_: Type, format_: Format) -> str:
    """The value: one operation for each factor and offset, without those that change nothing."""
    if type_.encoding is Encoding.FLOAT:
        raw = f"canwright_float_of_bits{'' if type_.width == 32 else '64'}(raw.bits)"
        if format_ is DOUBLE:
            raw = f"(double){raw}" if type_.width == 32 else "canwright_double_of_bits(raw.bits)"
        return _scaled(raw, linear, format_)
    raw = f"({format_.name})raw"
    factor, addend, divisor = linear.as_quotient
    above, below = (1, 1) if linear.times is None else (ABOVE, BELOW)
    greatest = (max(map(abs, type_.raw_limits)) * abs(factor) + abs(addend)) * above
    is_exact = max(greatest, divisor * below) <= format_.exact
    integral = None if is_exact or format_ is SINGLE else _integral(linear, type_)
    if linear.times is not None:
        dividend = _dividend(raw, factor, addend, format_.literal)
        multiple = f"canwright_multiple_{format_.name}(&{ratio(linear)}, {dividend}, {format_.literal(divisor)})"
        return integral or multiple
    if is_exact:
        if factor > 1 and not addend and divisor & (divisor - 1) == 0:
            return f"{raw} * {format_.literal(linear.scale)}"
        dividend = _dividend(raw, factor, addend, format_.literal)
        if divisor == 1:
            return dividend
        return f"{operand(dividend)} / {format_.literal(divisor)}"
    if format_ is DOUBLE and type_.width <= SPLIT:
        return integral or _split(linear, type_)
    return integral or _scaled(raw, linear, format_)


def _split(linear: Linear, type_: Type) -> str:
    """The value with scale and offset as sums of two doubles each: the products with the first ones are exact."""
    greatest = max(map(abs, type_.raw_limits)) * abs(linear.scale) + abs(linear.offset)
    unit = Fraction(2) ** (math.frexp(float(greatest))[1] - 53)
    first = [nearest(part / unit) * unit for part in (linear.scale, linear.offset)]
    rest = [part - rounded for part, rounded in zip((linear.scale, linear.offset), first, strict=True)]
    has_addend = linear.offset or linear.scale < 0  # 0.0 makes -0.0 positive
    sums = (
        f"((double)raw * {DOUBLE.literal(scale)})" + (f" + {DOUBLE.literal(offset)}" if has_addend else "")
        for scale, offset in (first, rest)
    )
    return joined("+", sums)


def _scaled(raw: str, linear: Linear, format_: Format) -> str:
    """The value of a number with factor, divisor and offset of the scale, each rounded."""
    above, below = _fraction(linear, format_)
    if max(abs(above), below) > format_.exact:
        above, below = linear.scale, Fraction(1)
    scaled = raw + (f" * {format_.literal(above)}" if above != 1 else "")
    scaled = f"{operand(scaled)} / {format_.literal(below)}" if below != 1 else scaled
    return f"{operand(scaled)} + {format_.literal(linear.offset)}" if linear.offset else scaled


def _fraction(linear: Linear, format_: Format) -> tuple[Fraction, Fraction]:
    """Numerator and denominator of a scale, or the scale itself if they or products with them are beyond the range."""
    above, below = Fraction(linear.scale.numerator), Fraction(linear.scale.denominator)
    is_small = format_.has(LARGEST * above, LARGEST * below, linear.offset * below * LARGEST)
    return (above, below) if is_small else (linear.scale, Fraction(1))


def _dividend(raw: str, factor: int, addend: int, literal: Callable[[int], str]) -> str:
    """`raw * factor + addend`. A raw integer of 0 without an addend is 0, never -0."""
    product = raw + (f" * {literal(abs(factor))}" if abs(factor) != 1 else "")
    if factor < 0:
        return f"{literal(addend)} - {operand(product)}"
    return f"{operand(product)} {'+' if addend > 0 else '-'} {literal(abs(addend))}" if addend else product


def _integral(linear: Linear, type_: Type) -> str | None:
    """The value as a quotient of 64-bit integers, rounded once; None if they are too small for most raw integers.

    Where only the raw integers next to the limits of the type need more than 64 bits, these are divided as doubles.
    """
    factor, addend, divisor = linear.as_quotient
    above, below = (1, 1) if linear.times is None else (ABOVE, BELOW)
    kind = UINT64 if not integer(type_).signed and factor > 0 and addend >= 0 else INT64
    least, most = (limit // above for limit in kind.limits)
    spans = [sorted((_toward_zero(least - a, factor), _toward_zero(most - a, factor))) for a in (0, addend)]
    low, high = max(span[0] for span in spans), min(span[1] for span in spans)
    if divisor * below > 1 << 63 or not kind.holds(factor, addend) or low > 0 or high < 0:
        return None
    source = "raw" if integer(type_) == kind else f"({kind.name})raw"
    dividend = _dividend(source, factor, addend, kind.literal)
    divided = f"canwright_quotient_{'' if kind.signed else 'un'}signed"
    if linear.times is None:
        exact = f"(double)({dividend})" if divisor == 1 else f"{divided}({dividend}, {UINT64.literal(divisor)})"
    else:
        number = ratio(linear)
        product = f"{operand(dividend)} * {'' if kind.signed else '(uint64_t)'}{number}.numerator"
        exact = f"{divided}({product}, {UINT64.literal(divisor)} * {number}.denominator)"
    ends = [f"raw >= {integer(type_).literal(low)}"] if low > type_.raw_limits[0] else []
    ends += [f"raw <= {integer(type_).literal(high)}"] if high < type_.raw_limits[1] else []
    if not ends:
        return exact
    rough = _scaled("(double)raw", linear, DOUBLE)
    if linear.times is not None:
        dividend = _dividend("(double)raw", factor, addend, DOUBLE.literal)
        rough = f"canwright_multiple_double(&{ratio(linear)}, {dividend}, {DOUBLE.literal(divisor)})"
    return f"({joined('&&', ends)}) ? {exact} : {operand(rough)}"


def _toward_zero(dividend: int, divisor: int) -> int:
    size = abs(dividend) // abs(divisor)
    return size if (dividend < 0) == (divisor < 0) else -size


def _nearest(linear: Linear, type_: Type, format_: Format) -> str:
    """The call that stores the nearest raw integer: from minus offset, times denominator, divided by numerator."""
    offset = linear.offset
    steps = "value" if linear.times is None else f"canwright_share_{format_.name}(value, &{ratio(linear)})"
    steps = f"({steps} - {format_.literal(offset)})" if offset > 0 else steps
    steps = f"({steps} + {format_.literal(-offset)})" if offset < 0 else steps
    above, below = _fraction(linear, format_)
    steps = f"{operand(steps)} * {format_.literal(below)}" if below != 1 else steps
    steps = f"{operand(steps)} / {format_.literal(above)}" if above != 1 else steps
    if type_.encoding is Encoding.FLOAT:
        return f"canwright_bits{type_.width}_from_{format_.name}(&nearest.bits, value, {steps})"
    wide = _wide(type_)
    limits = constant_limits(type_)
    ends = ", ".join(wide.literal(end) for end in limits)
    sign = "signed" if wide.signed else "unsigned"
    if format_ is DOUBLE and max(map(abs, limits)) >= COARSE and (line := _line(linear)):
        return f"canwright_corrected_{sign}_from_double(&nearest, value, {steps}, {line}, {ends})"
    return f"canwright_{sign}{wide.width}_from_{format_.name}(&nearest, value, {steps}, {ends})"


def _line(linear: Linear) -> str:
    """Divisor, addend and factor as arguments of `canwright_corrected`; empty if these are too large for it."""
    factor, addend, divisor = linear.as_quotient
    above, below = (1, 1) if linear.times is None else (ABOVE, BELOW)
    if max(abs(factor) * above, divisor * below) > CORRECTABLE or abs(addend) > abs(factor) << 64:
        return ""
    sign = 1 if factor > 0 else -1
    numbers = [UINT64.literal(number % (1 << 64)) for number in (sign * divisor, sign * addend, abs(factor))]
    if linear.times is not None:
        ends = ("denominator", "numerator", "numerator")
        numbers = [f"{number} * (uint64_t){ratio(linear)}.{end}" for number, end in zip(numbers, ends, strict=True)]
    return ", ".join(numbers)


def initializer(linear: Linear, type_: Type) -> str:
    """Scale and offset as the initializer of a `canwright_linear_t`, rounded to 63 bits; empty if these are too few."""
    quotient = linear.as_quotient
    if not INT64.holds(*map(abs, quotient)):
        whole = max(math.floor(abs(part)).bit_length() for part in (linear.scale, linear.offset))
        divisor = 1 << max(0, 62 - whole)
        quotient = nearest(linear.scale * divisor), nearest(linear.offset * divisor), divisor
        # then the error of no value reaches a quarter of an LSB
        if whole > 62 or abs(quotient[0]) < 4 * max(map(abs, type_.raw_limits)):
            return ""
    numbers = ", ".join(map(INT64.literal, quotient))
    return f"{{{numbers}, {ratio(linear) or '{1, 1u}'}}}"


def raw_kind(type_: Type) -> str:
    """The kind of the raw integers of a type, as a part of names of runtime functions."""
    if type_.encoding is Encoding.FLOAT:
        return f"bits{type_.width}"
    return "unsigned" if integer(type_) == UINT64 else "signed"
