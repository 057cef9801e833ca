"""Names and docstrings of the generated package; texts in Python source are those of `python_source`."""

from __future__ import annotations

import builtins
import functools
import keyword
import textwrap
from collections.abc import Sequence

from ..python_source import (
    english as english,
    literal as literal,
    member_name as member_name,
    plain as plain,
    tuple_of as tuple_of,
)
from .runtime._codec import Message

_WIDTH = 110
_RESERVED = {*keyword.kwlist, *dir(builtins)}
"""What a class of a module must not be named."""
_MEMBERS = {name for name in dir(Message) if not name.startswith("_")} | {"mro"}
_IN_CLASS_BODIES = {"self", "property", "classmethod", "super", "int", "float", "bytes", "tuple"}
"""Names that the code of generated classes uses where it would find a field of that name instead."""


def sentence(text: str) -> str:
    """A text with a full stop at its end; an empty text stays empty."""
    return text if not text or text.endswith((".", "!", "?")) else text + "."


@functools.lru_cache(maxsize=1 << 14)
def class_name(name: str) -> str:
    """`read_level_reply` as `ReadLevelReply`."""
    camel = "".join(part[:1].upper() + part[1:] for part in name.split("_"))
    return camel + "_" if camel in _RESERVED else camel


def attribute(name: str) -> str:
    """The attribute and keyword of a field or parameter.

    It is the name itself, with `_` appended if it is a keyword of Python or used by every message.
    """
    return name + "_" if keyword.iskeyword(name) or name in _MEMBERS or name in _IN_CLASS_BODIES else name


def _wrap(text: str, indent: int) -> list[str]:
    """Lines of a paragraph, for a docstring at an indent."""
    return textwrap.wrap(text, _WIDTH - indent, break_long_words=False, break_on_hyphens=False)


def docstring(paragraphs: Sequence[str], indent: int) -> str:
    """A docstring of a summary line and paragraphs, which are safe to print; empty ones are left out."""
    kept = [paragraph for paragraph in paragraphs if paragraph]
    margin = " " * indent
    summary = _wrap(kept[0], indent)
    if len(kept) == len(summary) == 1:
        return f'{margin}"""{summary[0]}"""'
    lines = [f'{margin}"""' + f"\n{margin}".join(summary)]
    for paragraph in kept[1:]:
        lines += ["", *(margin + line for line in _wrap(paragraph, indent))]
    return "\n".join([*lines, f'{margin}"""'])
