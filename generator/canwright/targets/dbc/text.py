"""Names, numbers and texts in the form that every DBC reader accepts."""

from __future__ import annotations

import functools
import hashlib
import re
import unicodedata
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction

from ...model import formatting

NAME_LENGTH = 32
"""A longer name is an error in some readers."""

_HASH_DIGITS = 6

_KEYWORD = re.compile(r"[A-Z_]+_|VERSION|FILTER|INT|HEX|FLOAT|STRING|ENUM")

_ASCII = str.maketrans(
    {"°": "deg", "μ": "u", "Ω": "Ohm", "×": "x", "–": "-", "—": "-", "‘": "'", "’": "'", "“": "'", "”": "'"}
    | {"\u2044": "/", '"': "'", "\\": "/"}
)

_QUOTES = str.maketrans({'"': "'", "\\": "/"})


@functools.lru_cache(maxsize=1 << 12)
def number(value: Fraction) -> str:
    """A number without exponent: all digits of a finite decimal, otherwise those of the nearest double."""
    if value.denominator == 1:
        return str(value.numerator)
    places = value.denominator.bit_length()
    if 10**places % value.denominator:
        return format(Decimal(repr(float(value))), "f")
    digits = format(Decimal(f"{value.numerator * 10**places // value.denominator}E-{places}"), "f")
    return digits.rstrip("0").rstrip(".") if "." in digits else digits


@functools.lru_cache(maxsize=1 << 16)
def text(written: str) -> str:
    """A text as one line of ASCII without quotes and backslashes; empty if it has letters outside ASCII."""
    if written.isascii() and written.isprintable():
        return " ".join(written.translate(_ASCII).split())
    plain = unicodedata.normalize("NFKD", written).translate(_ASCII)
    kept = [c if c.isprintable() else " " for c in plain if not unicodedata.combining(c)]
    if any(c.isalpha() and not c.isascii() for c in kept):
        return ""
    return " ".join("".join(c if c.isascii() else "?" for c in kept).split())


def any_text(written: str) -> str:
    """A text as one line without quotes and backslashes, in any letters."""
    return " ".join("".join(c if c.isprintable() else " " for c in written.translate(_QUOTES)).split())


def in_ascii(texts: Mapping[str, str]) -> str:
    """The ASCII form of a text in several languages: the English one, or the first."""
    return text(formatting.english(texts))


def camel(name: str) -> str:
    """`one_name` as `OneName`."""
    return "".join(part.capitalize() for part in name.split("_"))


def fitting(name: str) -> str:
    """A name that readers accept: a longer one ends in a hash of the whole name, so it does not depend on other names."""
    if _KEYWORD.fullmatch(name):
        return f"{name}_2"
    if len(name) <= NAME_LENGTH:
        return name
    ending = "_" + hashlib.sha256(name.encode()).hexdigest()[:_HASH_DIGITS]
    return name[: NAME_LENGTH - len(ending)] + ending
