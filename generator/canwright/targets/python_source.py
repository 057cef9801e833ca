"""Texts and names that are safe in Python source."""

from __future__ import annotations

import functools
from collections.abc import Iterable

from ..diagnostics.unicode_safety import visible
from ..model import formatting
from ..model.types import Text


@functools.lru_cache(maxsize=1 << 12)
def plain(text: str) -> str:
    """One line of a text for a docstring: no quote, backslash, line break, control or bidirectional character."""
    return visible(text).replace("\\", "\N{REVERSE SOLIDUS OPERATOR}").replace('"', "'")


def literal(text: str) -> str:
    """A text as a Python string literal in ASCII."""
    return '"' + ascii(text)[1:-1].replace("\\'", "'").replace('"', "\\x22") + '"'


def tuple_of(items: Iterable[str]) -> str:
    """The expression of a tuple; one item alone has a comma behind it."""
    listed = list(items)
    return f"({', '.join(listed)}{',' if len(listed) == 1 else ''})"


def english(text: Text) -> str:
    """The English text, or the first there is, for a docstring."""
    return plain(formatting.english(text))


def member_name(name: str) -> str:
    """An enum member: `low_voltage` as `LOW_VOLTAGE`, and `14` as `_14`."""
    upper = name.upper()
    return f"_{upper}" if upper[:1].isdigit() else upper
