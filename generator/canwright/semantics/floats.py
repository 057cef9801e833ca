"""IEEE 754 numbers of 32 and 64 bits as bit patterns, and back."""

from __future__ import annotations

import struct

_FORMATS = {32: (">I", ">f"), 64: (">Q", ">d")}


def float_of(width: int, bits: int) -> float:
    """The number with a bit pattern."""
    pattern, number = _FORMATS[width]
    result: float = struct.unpack(number, struct.pack(pattern, bits))[0]
    return result


def shortest(number: float) -> float:
    """A number of 32 bits as the decimal with at most nine digits that is nearest to no other one: 0.1 for 0.10000000149011612."""
    bits = bits_of(32, number)
    decimals = (float(f"{number:.{digits}g}") for digits in range(6, 9))  # six digits are never too many
    return next((decimal for decimal in decimals if bits_of(32, decimal) == bits), float(f"{number:.9g}"))


def bits_of(width: int, number: float) -> int:
    """The bit pattern of the nearest number of a width. Raises OverflowError if the number is too large."""
    pattern, code = _FORMATS[width]
    result: int = struct.unpack(pattern, struct.pack(code, number))[0]
    return result
