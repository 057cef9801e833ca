"""Characters that nobody sees, or that make the others look like something else."""

from __future__ import annotations

import unicodedata

_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Controls, format characters (bidirectional and zero-width ones), surrogates, separators of lines and paragraphs."""

CANNOT_BE_SEEN = "\N{REPLACEMENT CHARACTER}"


def unseen(text: str) -> list[str]:
    """The characters of a text that cannot be seen, each once, in order; tabs and line feeds are none of them."""
    return sorted(filter(_is_unseen, set(text)), key=text.index)


def _is_unseen(character: str) -> bool:
    code = ord(character)
    is_no_character = code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF
    return character not in "\t\n" and (is_no_character or unicodedata.category(character) in _UNSEEN)


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
