"""A mutant of generated code: replacements in one file, and what identifies it when the file is generated again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Change = tuple[int, int, str]
"""Start, end and new text of a replacement."""

PYTHON_RUNTIME = ("_codec.py", "_dispatch.py", "nodes.py")
"""The Python modules that are mutated besides the edition; the others convert for other packages."""


@dataclass(frozen=True)
class Mutant:
    """Some replacements in a file, in one function or outside of all."""

    file: str
    function: str
    changes: tuple[Change, ...]
    original: str
    mutated: str
    """The lines of the first change, before and after it."""
    line: int = 0
    """Where a function of Python starts; 0 outside of functions."""

    @property
    def is_runtime(self) -> bool:
        """Whether the file is the same for every protocol."""
        return self.file.startswith("canwright") or self.file in PYTHON_RUNTIME

    @property
    def key(self) -> tuple[str, str, str]:
        """What identifies it when the file is generated again."""
        return self.function, self.original, self.mutated


def make_mutant(
    file: str,
    text: str,
    changes: tuple[Change, ...],
    lines: tuple[int, int],
    *,
    function: str,
    scope: str,
    line: int = 0,
) -> Mutant:
    """A mutant that is identified by some lines, and by the next one if the function, `scope`, repeats them."""
    (start, end), (low, high, new) = lines, changes[0]
    if [another.strip() for another in scope.splitlines()].count(text[start:end].strip()) > 1:
        end = text.find("\n", end + 1)
    mutated = text[start:low] + new + text[high:end]
    return Mutant(file, function, changes, " ".join(text[start:end].split()), " ".join(mutated.split()), line)


def changed(text: str, changes: Sequence[Change], start: int = 0, end: int | None = None) -> str:
    """A part of a text with some changes."""
    result, done = "", start
    for low, high, new in sorted(changes):
        result += text[done:low] + new
        done = high
    return result + text[done:end]
