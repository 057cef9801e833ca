"""Conversions between raw integers and the unit as floating point: exact, or rounded once.

If the format represents every integer of the calculation, it is one expression; otherwise functions of the runtime
calculate with wide integers where needed.
"""

from __future__ import annotations

from typing import NamedTuple

from ...model.types import Encoding, Linear, Type
from .choices import Choice, choose
from .conversions import MISSING_PARAMETER, NO_SCALE, ConversionView, Formula, ratio
from .expressions import joined, operand
from .names import Names
from .numbers import INT64, UINT64, Integer, integer
from .validity import Condition, constant_limits, has_constant_limits


class Format(NamedTuple):
    """A floating-point type of C; every integer up to `exact` is representable."""

    name: str
    suffix: str
    exact: int

    def literal(self, number: int) -> str:
        """An integer up to `exact` as a literal of this type."""
        return f"{float(number)!r}{self.suffix}"


SINGLE = Format("float", "f", 1 << 24)
DOUBLE = Format("double", "", 1 << 53)


def lacks_floating(type_: Type) -> bool:
    """True if scale or offset need integers of more than 63 bits; there are no conversions to floating point then."""
    linears = [linear for _, linear in type_.linear.distinct() if linear is not None]
    return not all(INT64.holds(*map(abs, linear.as_quotient)) for linear in linears)


def floating(names: Names, type_: Type, valid: Choice[Condition] | None, format_: Format) -> ConversionView | None:
    """Conversions to the unit in a floating-point type; None without a scale, or with one that is too precise."""
    if not type_.is_number or not any(linear for _, linear in type_.linear.distinct()) or lacks_floating(type_):
        return None
    kind, is_float = integer(type_), type_.encoding is Encoding.FLOAT
    wide = kind if is_float else UINT64 if kind == UINT64 else INT64

    def to(linear: Linear | None) -> Formula:
        return _to(linear, type_, format_) if linear else NO_SCALE

    def from_(linear: Linear | None) -> Formula:
        if linear is None:
            return NO_SCALE
        limits = "" if is_float else "".join(f", {wide.literal(end)}" for end in constant_limits(type_))
        low, high = constant_limits(type_)
        function = _function(linear, type_, format_, (2 * low - 2, 2 * high + 2))
        call = f"canwright_{function}_from_{format_.name}(&nearest, value, &linear{limits})"
        return Formula(number=call, ratio=ratio(linear), linear=initializer(linear))

    return ConversionView(
        kind=format_.name,
        to=choose(names, type_.linear, to, MISSING_PARAMETER),
        to_fails=type_.linear.parameter is not None or bool(type_.times),
        from_=choose(names, type_.linear, from_, MISSING_PARAMETER),
        wide=wide.name,
        check=valid if is_float or not has_constant_limits(type_) else None,
    )


def _to(linear: Linear, type_: Type, format_: Format) -> Formula:
    function = _function(linear, type_, format_, integer(type_).limits)
    number = f"canwright_{function}_to_{format_.name}(raw, &linear)"
    if type_.encoding is not Encoding.FLOAT and linear.times is None:
        if linear.is_identity:
            return Formula(number=f"({format_.name})raw")
        factor, addend, divisor = linear.as_quotient
        largest = max(map(abs, type_.raw_limits)) * abs(factor) + abs(addend)
        if max(largest, divisor) <= format_.exact:
            return Formula(number=_expression(linear, format_))
        most = (format_.exact - abs(addend)) // abs(factor)
        if format_ is DOUBLE and divisor <= format_.exact and most > 0:
            number = f"({_within(integer(type_), most)}) ? ({_expression(linear, format_)}) : {number}"
    return Formula(number=number, ratio=ratio(linear), linear=initializer(linear))


def _within(kind: Integer, most: int) -> str:
    """The condition for raw integers of at most this magnitude."""
    low = [f"raw >= {kind.literal(-most)}"] if kind.signed else []
    return joined("&&", [*low, f"raw <= {kind.literal(most)}"])


def _function(linear: Linear, type_: Type, format_: Format, limits: tuple[int, int]) -> str:
    """The functions of the runtime for a scale: of raw integers within `limits`, those with 64 bits if they are enough."""
    factor, addend, divisor = linear.as_quotient
    is_narrow = (
        (raw_kind(type_), format_, linear.times) == ("signed", SINGLE, None)
        and max(abs(factor), divisor) < 1 << 31
        and abs(addend) < 1 << 37
        and INT64.holds(*(raw * factor + addend for raw in limits))
    )
    return "narrow" if is_narrow else raw_kind(type_)


def _expression(linear: Linear, format_: Format) -> str:
    """The value, without operations that change nothing. A raw integer of 0 without an offset is 0, never -0."""
    factor, addend, divisor = linear.as_quotient
    product = f"({format_.name})raw" + (f" * {format_.literal(abs(factor))}" if abs(factor) != 1 else "")
    if factor < 0:
        dividend = f"{format_.literal(addend)} - {operand(product)}"
    elif addend:
        dividend = f"{operand(product)} {'+' if addend > 0 else '-'} {format_.literal(abs(addend))}"
    else:
        dividend = product
    if divisor == 1:
        return dividend
    return (f"({dividend})" if addend or factor < 0 else dividend) + f" / {format_.literal(divisor)}"


def initializer(linear: Linear) -> str:
    """Scale and offset as the initializer of a `canwright_linear_t`."""
    numbers = ", ".join(map(INT64.literal, linear.as_quotient))
    return f"{{{numbers}, {ratio(linear) or '{1, 1u}'}}}"


def raw_kind(type_: Type) -> str:
    """The kind of the raw integers of a type, as a part of names of runtime functions."""
    if type_.encoding is Encoding.FLOAT:
        return f"bits{type_.width}"
    return "unsigned" if integer(type_) == UINT64 else "signed"
