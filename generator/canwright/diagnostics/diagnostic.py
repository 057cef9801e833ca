"""Findings about a spec: position, rule, message and hint."""

from __future__ import annotations

import difflib
import functools
import heapq
import itertools
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

DocumentPath = tuple[str | int, ...]
"""The path to an item of a YAML document: keys and indices from the top."""

MAX_FINDINGS = 500
"""The maximum number of findings of one kind of check that one run lists; the last of them states how many follow."""

MAX_NAMES = 1000
"""The maximum number of names that are compared with a misspelled one."""

MAX_MATCHES = 50
"""The maximum number of names that are compared in detail: those with the most pairs of characters in common."""

WIDTH = 160
"""The maximum number of characters of a source line; a longer line is cut on both sides of the marked part."""


class Severity(str, Enum):
    """The severity of a finding. An error stops generation, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True)
class Position:
    """The position of a finding: file as the user named it, line and column from 1, and the source line."""

    file: str
    line: int
    column: int
    length: int
    text: str


class Related(NamedTuple):
    """Another position that a finding is about, and the item there."""

    position: Position
    item: str


@dataclass(frozen=True)
class Diagnostic:
    """A finding: what is wrong, where, by which rule, and what to do about it."""

    severity: Severity
    rule: str
    message: str
    position: Position
    hint: str = ""
    related: tuple[Related, ...] = ()

    @property
    def place(self) -> tuple[str, int, int]:
        """File, line and column, for sorting."""
        return self.position.file, self.position.line, self.position.column

    def __str__(self) -> str:
        """`file:line:col: severity: message [rule]`, the source line, a caret, the related positions, and the hint."""
        at = self.position
        lines = [f"{at.file}:{at.line}:{at.column}: {self.severity.value}: {self.message} [{self.rule}]"]
        if at.text:
            first = max(0, at.column - WIDTH // 2) if len(at.text) > WIDTH else 0
            shown = at.text[first : first + WIDTH]
            start = at.column - 1 - first
            margin = "".join("\t" if c == "\t" else " " * _cells(c) for c in shown[:start])
            marked = _cells(shown[start : start + at.length]) or 1
            lines += [f"  {shown}", f"  {margin}{'^' * marked}"]
        lines += [f"  {shown}" for shown in (*self.related_lines, self.hint) if shown]
        return "\n".join(lines)

    @property
    def related_lines(self) -> list[str]:
        """One line for each related position."""
        return [f"{item.item} is at {p.file}:{p.line}:{p.column}" for item in self.related for p in (item.position,)]


def with_number_of_others(diagnostics: list[Diagnostic], unlisted: int, *, at_least: bool = False) -> list[Diagnostic]:
    """The findings of a check; the last of them states how many further ones are `unlisted`."""
    if not unlisted or not diagnostics:
        return diagnostics
    more = f"; {'at least ' if at_least else ''}{unlisted} more are not listed, correct these first"
    return [*diagnostics[:-1], replace(diagnostics[-1], message=diagnostics[-1].message + more)]


def _cells(text: str) -> int:
    """The number of terminal columns of a text: two for a wide character, none for a combining one."""
    if text.isascii():
        return len(text)
    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


class SpecError(Exception):
    """An invalid spec, with every finding of the run."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(
            sorted(dict.fromkeys(diagnostics), key=lambda d: (d.position.file, d.position.line, d.position.column))
        )
        super().__init__("\n".join(map(str, self.diagnostics)))


def near(name: str, known: Iterable[str]) -> str | None:
    """The name in `known` that `name` is probably a misspelling of; None without one."""
    names = (sorted(known) if isinstance(known, (set, frozenset)) else list(dict.fromkeys(known)))[:MAX_NAMES]
    same = next((n for n in names if n.casefold() == name.casefold()), None)
    if same is not None:
        return same
    matches = _similarities(name, _likely(name, names))
    if matches:
        return max(matches, key=matches.__getitem__)
    starts = [n for n in names if min(len(n), len(name)) > 2 and (n.startswith(name) or name.startswith(n))]
    return starts[0] if len(starts) == 1 else None


CUTOFF = 0.61
"""The minimum similarity of a misspelling, from 0 to 1; that of `meta` and `errata` is lower."""


def _likely(name: str, names: Sequence[str]) -> Sequence[str]:
    """At most `MAX_MATCHES` names, in their order: a detailed comparison with all of many names takes too long."""
    if len(names) <= MAX_MATCHES:
        return names
    pairs = _pairs(name)
    likely = set(heapq.nlargest(MAX_MATCHES, names, key=lambda candidate: len(pairs & _pairs(candidate))))
    return [candidate for candidate in names if candidate in likely]


@functools.lru_cache(maxsize=4 * MAX_NAMES)
def _pairs(name: str) -> frozenset[str]:
    """The adjacent characters of a name, and the single ones, so that a short name with swapped letters is found."""
    return frozenset((*map("".join, itertools.pairwise(name)), *name))


def _similarities(name: str, names: Iterable[str]) -> dict[str, float]:
    """The names that are similar to `name`, in their order, with their similarity."""
    matcher = difflib.SequenceMatcher(None, "", name)
    ratios = {}
    for candidate in names:
        matcher.set_seq1(candidate)
        if min(matcher.real_quick_ratio(), matcher.quick_ratio()) >= CUTOFF and (ratio := matcher.ratio()) >= CUTOFF:
            ratios[candidate] = ratio
    return ratios


def nearest(name: str, known: Iterable[str]) -> str:
    """A hint with the nearest name in `known`; without one, a list of them if they are few; else empty."""
    names = sorted(set(known))
    match = near(name, names)
    if match:
        return f"did you mean `{match}`?"
    if 0 < len(names) <= 12:
        return "there are: " + ", ".join(f"`{n}`" for n in names)
    return ""
