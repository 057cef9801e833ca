"""Lua source of texts, numbers and tables."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ...diagnostics.unicode_safety import visible
from ...model.types import Text

WIDTH = 120
EXACT = 1 << 53
"""Integers up to this are exact as a double, the only number of Lua 5.2."""


class Code(str):
    """A text that is Lua source already."""

    __slots__ = ()


_KEYWORDS = frozenset(
    """and break do else elseif end false for function goto if in local nil not or repeat return then true until
    while""".split()  # noqa: SIM905 - a list of words is easier to read
)
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)

Table = Mapping[str, "Value"] | Mapping[int, "Value"] | Mapping[int | str, "Value"]
Value = str | int | float | Table | Sequence["Value"] | None
"""What is printed as Lua. An entry of a mapping that is None is left out."""


def quoted(text: str) -> str:
    """A string literal in ASCII; its value is the text in UTF-8."""
    return '"' + "".join(map(_byte, text.encode("utf-8"))) + '"'


def _byte(byte: int) -> str:
    character = chr(byte)
    return character if 0x20 <= byte < 0x7F and character not in '"\\' else f"\\{byte:03d}"


def english(text: Text) -> str:
    """The English text on one line, or the first there is."""
    return visible(text.get("en") or next(iter(text.values()), ""))


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


def printed(value: Value, indent: int = 0) -> str:
    """A value on one line if it fits, else with one entry per line."""
    if isinstance(value, (str, int, float)) or value is None:
        return _scalar(value)
    line = _flat(value, WIDTH - 20 - indent)
    if line is not None:
        return line
    margin = " " * (indent + 4)
    lines = (f"{margin}{_name(name)}{printed(item, indent + 4)},\n" for name, item in _entries(value))
    return "{\n" + "".join(lines) + " " * indent + "}"


def _flat(value: Table | Sequence[Value], room: int) -> str | None:
    """A table on one line; None if it has more than `room` characters."""
    parts: list[str] = []
    left = room
    for name, item in _entries(value):
        if isinstance(item, (str, int, float)) or item is None:
            part: str | None = _scalar(item)
        else:
            part = _flat(item, left)
        left -= len(part or "")
        if part is None or left < 0:
            return None
        parts.append(_name(name) + part)
    line = "{" + ", ".join(parts) + "}"
    return line if len(line) <= room else None


def _scalar(value: str | float | None) -> str:
    if isinstance(value, Code):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    return "nil" if value is None else repr(value)


def _entries(value: Table | Sequence[Value]) -> Iterator[tuple[str | int | None, Value]]:
    if isinstance(value, Mapping):
        return ((name, item) for name, item in value.items() if item is not None)
    return ((None, item) for item in value)


def _name(name: str | int | None) -> str:
    """The start of an entry."""
    if name is None:
        return ""
    if isinstance(name, str) and _NAME.fullmatch(name) and name not in _KEYWORDS:
        return f"{name} = "
    return f"[{_scalar(name)}] = "
