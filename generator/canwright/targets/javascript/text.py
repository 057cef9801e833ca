"""JavaScript source of texts, numbers and tables."""

from __future__ import annotations

import functools
import json
import re
from fractions import Fraction

from ...diagnostics.unicode_safety import visible
from ...templating.markup import script_text
from ..nested_source import Code, NestedSource, Value

EXACT = (1 << 53) - 1
"""Integers up to this are exact as a number of JavaScript; larger ones are printed as BigInt."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)

NULL = Code("null")


def quoted(text: str) -> str:
    """A string literal in ASCII that is safe in a script of an HTML page too."""
    return script_text(json.dumps(text))


def comment(text: str) -> str:
    """A text on one line for a comment: it cannot end the comment, and starts no tag of TSDoc."""
    return visible(text).replace("*/", "*\\/").replace("@", "\\@")


def integer(raw: int, width: int) -> Code:
    """A raw integer: a BigInt for types with more than 53 bits."""
    return Code(f"{raw}n" if width > 53 else str(raw))


def rational(number: Fraction) -> Value:
    """An exact number: an integer, or a quotient as text."""
    return number.numerator if number.denominator == 1 else f"{number.numerator}/{number.denominator}"


def double(number: Fraction | int) -> Code:
    """The double that is nearest to a number."""
    try:
        return Code(repr(float(number)))
    except OverflowError:
        return Code("Infinity" if number > 0 else "-Infinity")


def _scalar(value: str | float | None) -> str:
    if isinstance(value, Code):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, int) and abs(value) > EXACT:
        return f"{value}n"
    return "null" if value is None else repr(value)


@functools.lru_cache(maxsize=1 << 12)
def key(name: str | int) -> str:
    """The name of a property, in quotes where it has to be."""
    return str(name) if _NAME.fullmatch(str(name)) else quoted(str(name))


def as_type(name: str) -> str:
    """The name of a property, as `key` has it, as a type of TypeScript."""
    return name if name.startswith('"') else quoted(name)


printed = NestedSource(
    scalar=_scalar, name=lambda name: f"{key(name)}: ", mapping=("{", "}"), sequence=("[", "]"), padding=" ", step=2
).printed
