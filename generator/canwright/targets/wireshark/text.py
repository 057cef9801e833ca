"""Lua source of texts, numbers and tables."""

from __future__ import annotations

import re
from fractions import Fraction

from ...diagnostics.unicode_safety import visible
from ...model import formatting
from ...model.types import Text
from ..nested_source import Code, NestedSource

EXACT = 1 << 53
"""Integers up to this are exact as a double, the only number of Lua 5.2."""


_KEYWORDS = frozenset(
    """and break do else elseif end false for function goto if in local nil not or repeat return then true until
    while""".split()  # noqa: SIM905 - a list of words is easier to read
)
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


def quoted(text: str) -> str:
    """A string literal in ASCII; its value is the text in UTF-8."""
    return '"' + "".join(map(_byte, text.encode("utf-8"))) + '"'


def _byte(byte: int) -> str:
    character = chr(byte)
    return character if 0x20 <= byte < 0x7F and character not in '"\\' else f"\\{byte:03d}"


def english(text: Text) -> str:
    """The English text on one line, or the first there is."""
    return visible(formatting.english(text))


def number(value: Fraction | int) -> Code:
    """The double that is nearest to a number."""
    try:
        return Code(repr(float(value)))
    except OverflowError:
        return Code("math.huge" if value > 0 else "-math.huge")


def key(raw: int, width: int) -> int | str:
    """The bits of a raw integer as the key of a Lua table: a number, or both halves if it has more than 32 bits."""
    high, low = divmod(raw & (1 << width) - 1, 1 << 32)
    return f"{high}:{low}" if high else low


def _scalar(value: str | float | None) -> str:
    if isinstance(value, Code):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    return "nil" if value is None else repr(value)


def _name(name: str | int) -> str:
    """The start of an entry."""
    if isinstance(name, str) and _NAME.fullmatch(name) and name not in _KEYWORDS:
        return f"{name} = "
    return f"[{_scalar(name)}] = "


printed = NestedSource(scalar=_scalar, name=_name, mapping=("{", "}"), sequence=("{", "}"), padding="", step=4).printed
