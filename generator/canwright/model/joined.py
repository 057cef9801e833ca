"""Types whose elements together are one value: a text of bytes, or a number of decimal digits.

Raw integers remain those of the elements, so every byte and every digit of a frame is kept.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar


@dataclass(frozen=True)
class Joined(ABC):
    """How `count` elements are joined; `width` is that of an element."""

    width: ClassVar[int]
    count: int

    @property
    @abstractmethod
    def format(self) -> str:
        """The raw format in the language: `ascii8`."""

    @property
    def facts(self) -> str:
        """The raw format with what else decides about values."""
        return self.format

    @abstractmethod
    def value(self, raws: Sequence[int]) -> Fraction | str | None:
        """The value of all elements; None if they are none."""

    @abstractmethod
    def raws(self, value: object) -> list[int] | None:
        """The elements of a value; None if it does not fit or would be read as another."""


@dataclass(frozen=True)
class JoinedText(Joined):
    """A text: it ends before the first 0, and before the padding at its end. An invalid byte is U+FFFD."""

    width = 8
    codec: str
    """The name of the encoding in Python: `ascii` or `utf-8`."""
    padding: int = 0

    @property
    def format(self) -> str:
        return f"{'ascii' if self.codec == 'ascii' else 'utf8_'}{self.count}"

    @property
    def facts(self) -> str:
        return self.format + (f", padding 0x{self.padding:02X}" if self.padding else "")

    def value(self, raws: Sequence[int]) -> str:
        content = bytes(raws).partition(b"\0")[0]
        return content.rstrip(bytes([self.padding])).decode(self.codec, "replace")

    def raws(self, value: object) -> list[int] | None:
        if not isinstance(value, str):
            return None
        try:
            content = value.encode(self.codec)
        except UnicodeEncodeError:
            return None
        raws = list(content.ljust(self.count, bytes([self.padding])))
        return raws if len(raws) == self.count and self.value(raws) == value else None


@dataclass(frozen=True)
class JoinedDigits(Joined):
    """A number in decimal digits (BCD), from the most significant one on; without a value if one exceeds 9."""

    width = 4

    @property
    def format(self) -> str:
        return f"bcd{self.count}"

    def value(self, raws: Sequence[int]) -> Fraction | None:
        return None if max(raws) > 9 else Fraction(int("".join(map(str, raws))))

    def raws(self, value: object) -> list[int] | None:
        if not isinstance(value, Fraction):
            return None
        whole = int(abs(value) + Fraction(1, 2)) * (1 if value >= 0 else -1)
        return [int(digit) for digit in f"{whole:0{self.count}}"] if 0 <= whole < 10**self.count else None
