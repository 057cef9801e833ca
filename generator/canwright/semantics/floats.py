"""IEEE 754 numbers of 32 and 64 bits as bit patterns, and back."""

from __future__ import annotations

import struct

_FORMATS = {32: (">I", ">f"), 64: (">Q", ">d")}


def float_of(width: int, bits: int) -> float:
    """The number with a bit pattern."""
    pattern, number = _FORMATS[width]
    result: float = struct.unpack(number, struct.pack(pattern, bits))[0]
    return result


def bits_of(width: int, number: float) -> int:
    """The bit pattern of the nearest number of a width. Raises OverflowError if the number is too large."""
    pattern, code = _FORMATS[width]
    result: int = struct.unpack(pattern, struct.pack(code, number))[0]
    return result
