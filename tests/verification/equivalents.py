"""Mutants that are known to be equivalent to the original, each with a reason."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from .mutants import Mutant


@dataclass(frozen=True)
class Equivalent:
    """A pattern of mutants: function, line, and mutated lines; `...` stands for any text. Of one edition, or of each."""

    function: str
    original: str
    mutated: tuple[str, ...]
    reason: str
    edition: str = ""

    def matches(self, mutant: Mutant) -> bool:
        """Whether a mutant is of this pattern. Texts that `...` stands for are alike in both lines, from the left."""
        function, original, mutated = mutant.key
        if not re.fullmatch(_pattern(self.function), function):
            return False
        match = re.fullmatch(_pattern(self.original), original)
        if match is None:
            return False
        return any(re.fullmatch(_filled(line, match.groups()), mutated) for line in self.mutated)


def _pattern(text: str) -> str:
    return "(.*?)".join(map(re.escape, text.split("...")))


def _filled(text: str, groups: Sequence[str]) -> str:
    """The mutated line: each `...` is what it is in the original; further ones are any text."""
    parts = text.split("...")
    fill = [*map(re.escape, groups), *[".*?"] * len(parts)]
    return re.escape(parts[0]) + "".join(
        between + re.escape(part) for between, part in zip(fill, parts[1:], strict=False)
    )


def read(file: Path) -> list[Equivalent]:
    """The list of a file."""
    listed = yaml.safe_load(file.read_text("utf-8")) or []
    return [Equivalent(**{**entry, "mutated": tuple(entry["mutated"])}) for entry in listed]


@dataclass(frozen=True)
class Verdict:
    """What is wrong with a run: survivors that are not listed, entries that match a killed mutant, unneeded entries."""

    unlisted: tuple[Mutant, ...]
    killed: tuple[tuple[Equivalent, Mutant], ...]
    listed: int


def judge(mutants: Iterable[Mutant], survivors: Iterable[Mutant], listed: Sequence[Equivalent]) -> Verdict:
    """Compares the survivors of some mutants with the list."""
    alive = set(survivors)
    unlisted = tuple(m for m in alive if not any(entry.matches(m) for entry in listed))
    dead = (m for m in mutants if m not in alive)
    killed = tuple((entry, m) for m in dead for entry in listed if entry.matches(m))
    return Verdict(tuple(sorted(unlisted, key=lambda m: m.key)), killed, len(alive) - len(unlisted))
