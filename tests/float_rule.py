"""The rule for values as doubles, for tests: the quotient in floating point, from 2^51 on the exact one."""

from __future__ import annotations

import math
import struct
from fractions import Fraction

from canwright.model.types import Encoding, Linear, Type

CODES = {32: ("<f", "<I"), 64: ("<d", "<Q")}
"""The struct codes of a float and of its bits, by width."""


def nearest_integer(number: Fraction) -> int:
    """The nearest integer, ties away from zero."""
    return math.floor(abs(number) + Fraction(1, 2)) * (1 if number > 0 else -1)


def quotient(value: float, linear: Linear, times: Fraction = Fraction(1)) -> float:
    """The raw number of a value, each operation rounded; `times` is the parameter that multiplies the scale."""
    if linear.times is not None:
        value = value * float(times.denominator) / float(times.numerator)
    return (value - float(linear.offset)) * float(linear.scale.denominator) / float(linear.scale.numerator)


def raw_of_double(value: float, linear: Linear, times: Fraction = Fraction(1)) -> int:
    """The raw integer of a value."""
    steps = quotient(value, linear, times)
    if abs(steps) < 2.0**51:
        return nearest_integer(Fraction(steps))
    return nearest_integer((Fraction(value) / (times if linear.times else 1) - linear.offset) / linear.scale)


def bits_of_double(value: float, type_: Type, linear: Linear) -> int | None:
    """The bits of the number of a float field; None beyond the largest one."""
    code = CODES[type_.width]
    number = quotient(value, linear)
    try:
        bits: int = struct.unpack(code[1], struct.pack(code[0], number))[0]
    except OverflowError:
        return None
    return bits if math.isfinite(number) else None


def float_of(bits: int, width: int) -> float:
    """The float with these bits."""
    code = CODES[width]
    number: float = struct.unpack(code[0], struct.pack(code[1], bits))[0]
    return number


def effective(value: Fraction, type_: Type, linear: Linear, times: Fraction = Fraction(1)) -> Fraction:
    """The exact value of the raw integer that a double is converted to; other fractions themselves.

    So is a value whose float is too large, or is 0, as a fraction has no sign of 0.
    """
    try:
        number = float(value)
    except OverflowError:
        return value
    if number != value:
        return value
    if type_.encoding is Encoding.FLOAT:
        bits = bits_of_double(number, type_, linear)
        converted = 0.0 if bits is None else float_of(bits, type_.width)
        return Fraction(converted) * linear.scale + linear.offset if converted else value
    factor = times if linear.times else 1
    return (raw_of_double(number, linear, times) * linear.scale + linear.offset) * factor
