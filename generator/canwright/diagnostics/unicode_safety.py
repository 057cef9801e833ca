"""Characters that nobody sees, or that make the others look like something else."""

from __future__ import annotations

import functools
import unicodedata
from collections.abc import Iterator

_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Controls, format characters (bidirectional and zero-width ones), surrogates, separators of lines and paragraphs."""

_BLANK = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0")
"""Letters and marks that are drawn as nothing."""

CANNOT_BE_SEEN = "\N{REPLACEMENT CHARACTER}"


def unseen(text: str) -> list[str]:
    """The characters of a text that cannot be seen, each once, in order; tabs and line feeds are none of them."""
    if text.isascii() and text.isprintable():
        return []
    return sorted(filter(_is_unseen, set(text)), key=text.index)


@functools.lru_cache(maxsize=1 << 14)
def _is_unseen(character: str) -> bool:
    code = ord(character)
    is_no_character = code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF
    is_blank = character in _BLANK or 0xE0000 <= code <= 0xE0FFF
    is_unseen = is_no_character or is_blank or unicodedata.category(character) in _UNSEEN
    return is_unseen and character not in "\t\n"


def places(text: str) -> Iterator[tuple[int, int, str]]:
    """Line, column and character, wherever one stands that cannot be seen."""
    found = frozenset(unseen(text))
    for number, line in enumerate(text.split("\n") if found else (), 1):
        yield from ((number, column, character) for column, character in enumerate(line, 1) if character in found)


def covered(text: str) -> str:
    """The text with a mark in place of each character that cannot be seen; as long as it was."""
    found = unseen(text)
    return text.translate(dict.fromkeys(map(ord, found), CANNOT_BE_SEEN)) if found else text


def visible(text: str) -> str:
    """One line, where characters that cannot be seen are shown by their number, as in `[U+202E]`."""
    line = " ".join(text.split())
    found = unseen(line)
    return line.translate({ord(c): f"[U+{ord(c):04X}]" for c in found}) if found else line


def described(character: str) -> str:
    """`U+202E RIGHT-TO-LEFT OVERRIDE`, or the number alone where there is no name."""
    return f"U+{ord(character):04X} {unicodedata.name(character, '')}".rstrip()
