"""C expressions as text, with parentheses that make their precedence explicit; integer types and their literals."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import NamedTuple

from ...model.types import Encoding, Type


def operand(expression: str) -> str:
    """An expression in parentheses if it has an operator outside of parentheses; operators have spaces around them."""
    depth = 0
    for character in expression:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == " " and depth == 0:
            return f"({expression})"
    return expression


def joined(operator: str, terms: Iterable[str]) -> str:
    """Terms with one operator between them; a single term is unchanged."""
    every = list(terms)
    return every[0] if len(every) == 1 else f" {operator} ".join(map(operand, every))


def call(function: str, *arguments: str) -> str:
    """A call of a function; empty arguments are left out."""
    return f"{function}({', '.join(filter(None, arguments))})"


def braces(*parts: str) -> str:
    """An initializer."""
    return f"{{{', '.join(parts)}}}"


class Integer(NamedTuple):
    """An integer type of <stdint.h>."""

    width: int
    signed: bool

    @property
    def name(self) -> str:
        return f"{'' if self.signed else 'u'}int{self.width}_t"

    @property
    def limits(self) -> tuple[int, int]:
        if self.signed:
            return -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1
        return 0, (1 << self.width) - 1

    @property
    def unsigned(self) -> Integer:
        return Integer(self.width, False)

    def holds(self, *numbers: int) -> bool:
        low, high = self.limits
        return all(low <= number <= high for number in numbers)

    def literal(self, number: int) -> str:
        """A number of this type, the same on every platform."""
        if not self.signed:
            return self._unsigned(str(number), number)
        least = "(-INT64_MAX - 1)" if self.width == 64 else "INT32_MIN"
        ends = dict(zip(self.limits, (least, f"INT{self.width}_MAX"), strict=True))
        return ends.get(number, str(number)) if self.width >= 32 else str(number)

    def bits(self, number: int) -> str:
        """Bits of this type, in hexadecimal."""
        return self._unsigned(f"0x{number:0{self.width // 4}X}", number)

    def _unsigned(self, digits: str, number: int) -> str:
        """The suffix is enough for a number that needs 64 bits."""
        return f"UINT64_C({digits})" if self.width == 64 and number < 1 << 32 else f"{digits}u"


INT32 = Integer(32, True)
INT64 = Integer(64, True)
UINT32 = Integer(32, False)
UINT64 = Integer(64, False)


@functools.cache
def smallest(width: int, signed: bool) -> Integer:
    """The smallest type that holds `width` bits."""
    return Integer(next(w for w in (8, 16, 32, 64) if width <= w), signed)


def integer(type_: Type) -> Integer:
    """The C type of a raw integer of a type; for floats, of its bits."""
    return smallest(type_.width, type_.encoding is Encoding.SIGNED)


def stored(type_: Type) -> str:
    """The C type of a member: an integer; for a float, a struct with its bits, to which no number converts."""
    return f"canwright_float{type_.width}_t" if type_.encoding is Encoding.FLOAT else integer(type_).name


def raw_of(type_: Type, item: str) -> str:
    """The raw integer of a member or of an argument that has the type of one."""
    return f"{item}.bits" if type_.encoding is Encoding.FLOAT else item


def stored_literal(type_: Type, raw: int) -> str:
    """The initializer of a member."""
    return braces(integer(type_).bits(raw)) if type_.encoding is Encoding.FLOAT else integer(type_).literal(raw)


def working(width: int) -> Integer:
    """The C type for shifts: wide enough on every platform."""
    return UINT32 if width <= 32 else UINT64


def common(*numbers: int) -> Integer | None:
    """The signed type of 32 or 64 bits for all these numbers; None if both are too small."""
    return next((kind for kind in (INT32, INT64) if kind.holds(*numbers)), None)
