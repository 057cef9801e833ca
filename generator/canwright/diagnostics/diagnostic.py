"""One finding about a spec: position, rule, message and hint."""

from __future__ import annotations

import difflib
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

DocumentPath = tuple[str | int, ...]
"""Where an item is in its YAML document, as keys and indices from the top."""

MOST_FINDINGS = 1000
"""How many findings of one kind of check are told in one run; nobody reads more."""

WIDTH = 160
"""How much of a line is shown; one that is longer is cut on both sides of what a finding is about."""


class Severity(str, Enum):
    """An error stops generation, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True)
class Position:
    """Where a finding is: file as the user named it, line and column from 1, and the source line itself."""

    file: str
    line: int
    column: int
    length: int
    text: str


@dataclass(frozen=True)
class Diagnostic:
    """What is wrong, where, by which rule, and what to do about it."""

    severity: Severity
    rule: str
    message: str
    position: Position
    hint: str = ""

    def __str__(self) -> str:
        """`file:line:col: severity: message [rule]`, the source line, a caret, and the hint."""
        at = self.position
        lines = [f"{at.file}:{at.line}:{at.column}: {self.severity.value}: {self.message} [{self.rule}]"]
        if at.text:
            first = max(0, at.column - WIDTH // 2) if len(at.text) > WIDTH else 0
            shown = at.text[first : first + WIDTH]
            start = at.column - 1 - first
            margin = "".join("\t" if c == "\t" else " " * _cells(c) for c in shown[:start])
            marked = _cells(shown[start : start + at.length]) or 1
            lines += [f"  {shown}", f"  {margin}{'^' * marked}"]
        if self.hint:
            lines.append(f"  {self.hint}")
        return "\n".join(lines)


def _cells(text: str) -> int:
    """How many columns of a terminal a text takes: two for a wide character, none for one that is put on the last."""
    if text.isascii():
        return len(text)
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


class SpecError(Exception):
    """A spec that cannot be used; carries every finding of the run."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(
            sorted(dict.fromkeys(diagnostics), key=lambda d: (d.position.file, d.position.line, d.position.column))
        )
        super().__init__("\n".join(map(str, self.diagnostics)))


def near(name: str, known: Iterable[str]) -> str | None:
    """The one of `known` that `name` is probably a slip of the pen for."""
    names = (sorted(known) if isinstance(known, (set, frozenset)) else list(dict.fromkeys(known)))[:MOST_FINDINGS]
    alike = next((n for n in names if n.casefold() == name.casefold()), None)
    if alike is not None:
        return alike
    close = difflib.get_close_matches(name, names, n=len(names) or 1, cutoff=CUTOFF)
    if close:
        best = _likeness(name, close[0])
        return next(n for n in names if n in close and _likeness(name, n) == best)
    starts = [n for n in names if min(len(n), len(name)) > 2 and (n.startswith(name) or name.startswith(n))]
    return starts[0] if len(starts) == 1 else None


CUTOFF = 0.61
"""How much alike a slip of the pen is at least, of 1; `meta` and `errata` are less."""


def _likeness(name: str, other: str) -> float:
    return difflib.SequenceMatcher(None, other, name).ratio()


def nearest(name: str, known: Iterable[str]) -> str:
    """A hint that names the nearest of `known`, or lists them when none is near and they are few."""
    names = sorted(set(known))
    close = near(name, names)
    if close:
        return f"did you mean `{close}`?"
    if 0 < len(names) <= 12:
        return "there are: " + ", ".join(f"`{n}`" for n in names)
    return ""
