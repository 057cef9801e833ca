"""Exact findings of comparisons, one case a line: `case: impact rule(item), ...`; the lines are read before they are committed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from canwright.compare import Change

FOLDER = Path(__file__).parent


def findings(changes: Iterable[Change]) -> str:
    """Every change with its impact; the same rule of the same item counts as often as it is found."""
    return ", ".join(sorted(f"{c.impact.value} {c.rule.id}({c.item})" for c in changes)) or "none"


def recorded(name: str) -> dict[str, str]:
    """The recorded findings of every case."""
    lines = (FOLDER / name).read_text("utf-8").splitlines()
    return {case: text for case, _, text in (line.rpartition(": ") for line in lines)}


def record(name: str, cases: Mapping[str, str]) -> None:
    """Replaces the recorded findings."""
    (FOLDER / name).write_text("".join(f"{case}: {text}\n" for case, text in cases.items()), "utf-8")
