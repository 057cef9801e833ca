"""Texts and names that are safe in Python source."""

from __future__ import annotations

import builtins
import functools
import keyword
from collections.abc import Iterable, Sequence

from ...diagnostics.unicode_safety import visible
from ...model.types import Text
from .runtime._codec import Message

_RESERVED = {*keyword.kwlist, *dir(builtins)}
"""What a class of a module must not be named."""
_MEMBERS = {name for name in dir(Message) if not name.startswith("_")} | {"mro"}
_IN_CLASS_BODIES = {"self", "property", "classmethod", "super", "int", "float", "bytes", "tuple"}
"""Names that the code of generated classes uses where it would find a field of that name instead."""


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
    return plain(text.get("en") or next(iter(text.values()), ""))


def sentence(text: str) -> str:
    """A text with a full stop at its end; an empty text stays empty."""
    return text if not text or text.endswith((".", "!", "?")) else text + "."


@functools.lru_cache(maxsize=1 << 14)
def class_name(name: str) -> str:
    """`read_level_reply` as `ReadLevelReply`."""
    camel = "".join(part[:1].upper() + part[1:] for part in name.split("_"))
    return camel + "_" if camel in _RESERVED else camel


def member_name(name: str) -> str:
    """An enum member: `low_voltage` as `LOW_VOLTAGE`, and `14` as `_14`."""
    upper = name.upper()
    return f"_{upper}" if upper[:1].isdigit() else upper


def attribute(name: str) -> str:
    """The attribute and keyword of a field or parameter.

    It is the name itself, with `_` appended if it is a keyword of Python or used by every message.
    """
    return name + "_" if keyword.iskeyword(name) or name in _MEMBERS or name in _IN_CLASS_BODIES else name


def wrap(text: str, indent: int, width: int = 110) -> list[str]:
    """Lines of a paragraph, for a docstring at an indent."""
    lines: list[str] = []
    for word in text.split():
        if lines and len(lines[-1]) + 1 + len(word) <= width - indent:
            lines[-1] += " " + word
        else:
            lines.append(word)
    return lines


def docstring(paragraphs: Sequence[str], indent: int) -> str:
    """A docstring of a summary line and paragraphs, which are safe to print; empty ones are left out."""
    kept = [paragraph for paragraph in paragraphs if paragraph]
    margin = " " * indent
    summary = wrap(kept[0], indent)
    if len(kept) == len(summary) == 1:
        return f'{margin}"""{summary[0]}"""'
    lines = [f'{margin}"""' + f"\n{margin}".join(summary)]
    for paragraph in kept[1:]:
        lines += ["", *(margin + line for line in wrap(paragraph, indent))]
    return "\n".join([*lines, f'{margin}"""'])
