"""Invisible characters, and characters that change how others are displayed: detected, masked, escaped."""

from __future__ import annotations

import functools
import unicodedata
from collections.abc import Iterator

_INVISIBLE = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Controls, format characters (bidirectional and zero-width ones), surrogates, separators of lines and paragraphs."""

_BLANK = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0")
"""Letters and marks without a visible glyph."""

CANNOT_BE_SEEN = "\N{REPLACEMENT CHARACTER}"


def unseen(text: str) -> list[str]:
    """The invisible characters of a text except tabs and line feeds, each once, in order."""
    if text.isascii() and text.isprintable():
        return []
    return sorted(filter(_is_invisible, set(text)), key=text.index)


@functools.lru_cache(maxsize=1 << 14)
def _is_invisible(character: str) -> bool:
    code = ord(character)
    is_noncharacter = code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF
    is_blank = character in _BLANK or 0xE0000 <= code <= 0xE0FFF
    is_invisible = is_noncharacter or is_blank or unicodedata.category(character) in _INVISIBLE
    return is_invisible and character not in "\t\n"


def places(text: str) -> Iterator[tuple[int, int, str]]:
    """Line, column and character of every invisible character."""
    hidden = frozenset(unseen(text))
    for number, line in enumerate(text.split("\n") if hidden else (), 1):
        yield from ((number, column, character) for column, character in enumerate(line, 1) if character in hidden)


def covered(text: str) -> str:
    """The text with each invisible character replaced by one mark, so that positions stay the same."""
    hidden = unseen(text)
    return text.translate(dict.fromkeys(map(ord, hidden), CANNOT_BE_SEEN)) if hidden else text


def visible(text: str) -> str:
    """The text on one line, with invisible characters escaped, as in `[U+202E]`."""
    line = " ".join(text.split())
    hidden = unseen(line)
    return line.translate({ord(c): f"[U+{ord(c):04X}]" for c in hidden}) if hidden else line


def described(character: str) -> str:
    """`U+202E RIGHT-TO-LEFT OVERRIDE`; the number alone for a character without a name."""
    return f"U+{ord(character):04X} {unicodedata.name(character, '')}".rstrip()
