"""A comparison for people and for machines: text, Markdown, a section of a changelog, JSON, GitHub annotations."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import click

from ..compare import Category, Change, Impact, Item, by_impact, compare
from ..diagnostics.diagnostic import DocumentPath, Position
from ..model import formatting
from ..project.loader import Loaded
from ..targets.registry import targets
from ..templating.markup import markdown as markdown_text
from .printers import annotation

_COLOURS = {Impact.SILENT: "red", Impact.LOUD: "yellow", Impact.BUILD: "cyan", Impact.SAFE: "green"}
_MEANING = {
    Impact.SILENT: "Silent: a program of the old edition keeps running, and reads or commands something else",
    Impact.LOUD: "Loud: a program of the old edition gets no answer, or an error",
    Impact.BUILD: "Names: a program has to be changed before it builds with the new bindings",
    Impact.SAFE: "Nothing breaks",
}


@dataclass(frozen=True)
class Comparison:
    """Two editions, their texts with positions, and what changed between them."""

    old: Loaded
    new: Loaded
    changes: tuple[Change, ...]

    @classmethod
    def of(cls, old: Loaded, new: Loaded) -> Comparison:
        return cls(old, new, compare(old.specification.edition, new.specification.edition, targets()))

    @property
    def title(self) -> str:
        """`lamp v1 -> v2`."""
        old, new = self.old.specification.edition, self.new.specification.edition
        return f"{old.family} {old.name} -> {new.name}"

    def places(self, change: Change) -> tuple[Position, Position]:
        """Where a change stands in both specs."""
        return _position(self.old, change.old), _position(self.new, change.new)


def _position(loaded: Loaded, path: DocumentPath | None) -> Position:
    return loaded.document.position(path or (), key=True)


def _grouped(changes: Sequence[Change]) -> dict[Item, list[Change]]:
    """Changes by item, the most affected items first."""
    groups: dict[Item, list[Change]] = {}
    for change in by_impact(tuple(changes)):
        groups.setdefault(change.item, []).append(change)
    return groups


def _who(change: Change) -> str:
    return f"host {' and '.join(side.value for side in change.sides)}" if change.sides else ""


def _reach(item: Item, changes: Sequence[Change]) -> str:
    names = dict.fromkeys(name for change in changes for name in change.used_by)
    others = [name for name in names if name != item.name]
    return f" ({', '.join(others)})" if others else ""


def text(found: Comparison) -> str:
    """Grouped by what they belong to, silent ones first, each with its place in both files."""
    lines = [found.title, ""]
    for item, changes in _grouped(found.changes).items():
        lines.append(_styled(str(item), None) + _reach(item, changes))
        for change in changes:
            old, new = found.places(change)
            impact = _styled(f"{change.impact.value:6}", _COLOURS[change.impact])
            lines.append(f"  {impact}  {change.rule.category.value:5}  {change.says()} [{change.rule.id}]")
            who = _who(change) and f"{_who(change)}; "
            lines.append(f"                 {who}{_place(old)} -> {_place(new)}")
        lines.append("")
    return "\n".join([*lines, summary(found.changes)])


def _styled(written: str, colour: str | None) -> str:
    return written if os.environ.get("NO_COLOR") else click.style(written, fg=colour, bold=True)


def _place(at: Position) -> str:
    return f"{at.file}:{at.line}:{at.column}"


def summary(changes: Sequence[Change]) -> str:
    """`12 changes: 3 wire, 9 doc; 2 silent, 1 loud`."""
    categories = Counter(change.rule.category for change in changes)
    impacts = Counter(change.impact for change in changes)
    kinds = ", ".join(f"{categories[c]} {c.value}" for c in Category if categories[c])
    broken = ", ".join(f"{impacts[i]} {i.value}" for i in (Impact.SILENT, Impact.LOUD) if impacts[i])
    count = formatting.counted(len(changes), "change")
    return (
        count + (f": {kinds}" if kinds else "") + (f"; {broken}" if broken else "; nothing breaks" if changes else "")
    )


def markdown(found: Comparison) -> str:
    """A table for each impact."""
    lines = [f"# {found.title}", "", summary(found.changes), ""]
    for impact in Impact:
        changes = [change for change in found.changes if change.impact is impact]
        if changes:
            lines += [f"## {_MEANING[impact]}", "", "| what | change | kind | host | old | new |"]
            lines += ["| --- | --- | --- | --- | --- | --- |", *(_row(found, change) for change in changes), ""]
    return "\n".join(lines).rstrip("\n")


def _row(found: Comparison, change: Change) -> str:
    old, new = found.places(change)
    host = ", ".join(side.value for side in change.sides)
    kind = f"{change.rule.category.value} `{change.rule.id}`"
    places = [markdown_text(f"{at.file}:{at.line}") for at in (old, new)]
    return f"| {' | '.join([str(change.item), change.says(escape=markdown_text), kind, host, *places])} |"


def changelog(found: Comparison) -> str:
    """A section to paste into a changelog."""
    new = found.new.specification.edition
    lines = [f"## {new.name}" + (f" ({new.date})" if new.date else ""), ""]
    lines += [f"Since {found.old.specification.edition.name}, {summary(found.changes)}.", ""]
    by_heading: dict[str, list[str]] = {heading: [] for heading in ("Changed", "Added", "Removed")}
    documents: dict[str, list[str]] = {}
    for change in by_impact(found.changes):
        if change.rule.category is Category.DOC:
            documents.setdefault(change.rule.purpose, []).append(f"`{change.item.name or change.item.kind}`")
        else:
            by_heading[_heading(change)].append(_entry(change))
    by_heading["Documents"] = [
        f"- {purpose.rstrip('.')}: {', '.join(dict.fromkeys(on))}" for purpose, on in documents.items()
    ]
    for heading, entries in by_heading.items():
        if entries:
            lines += [f"### {heading}", "", *dict.fromkeys(entries), ""]
    return "\n".join(lines).rstrip("\n")


def _heading(change: Change) -> str:
    ending = change.rule.id.rpartition("-")[2]
    return {"added": "Added", "removed": "Removed"}.get(ending, "Changed")


def _entry(change: Change) -> str:
    impact = f"**{change.impact.value}**, {_who(change)}: " if change.impact in (Impact.SILENT, Impact.LOUD) else ""
    named = "" if change.item.name and f"`{change.item.name}`" in change.says() else f"{change.item}: "
    return f"- {impact}{named}{change.says(escape=markdown_text)}"


def as_json(found: Comparison) -> str:
    """An object with `old`, `new` and `changes`."""

    def place(at: Position) -> dict[str, object]:
        return {"file": at.file, "line": at.line, "column": at.column}

    changes = [
        {
            "rule": change.rule.id,
            "category": change.rule.category.value,
            "impact": change.impact.value,
            "host": [side.value for side in change.sides],
            "item": {"kind": change.item.kind, "name": change.item.name},
            "message": change.says(),
            "used_by": list(change.used_by),
            "old": place(found.places(change)[0]),
            "new": place(found.places(change)[1]),
        }
        for change in by_impact(found.changes)
    ]
    old, new = found.old.specification.edition, found.new.specification.edition
    listed = {"family": old.family, "old": old.name, "new": new.name, "changes": changes}
    return json.dumps(listed, indent=2, ensure_ascii=False)


def github(found: Comparison) -> str:
    """Workflow commands that GitHub shows beside the lines of the new spec."""

    def line(change: Change) -> str:
        old, new = found.places(change)
        level = "warning" if change.impact in (Impact.SILENT, Impact.LOUD) else "notice"
        who = f"{change.impact.value}, {_who(change)}: " if change.sides else ""
        return annotation(level, new, change.rule.id, f"{who}{change.item}: {change.says()} (was {_place(old)})")

    return "\n".join(map(line, by_impact(found.changes)))


REPORTS: Mapping[str, Callable[[Comparison], str]] = {
    "text": text,
    "markdown": markdown,
    "changelog": changelog,
    "json": as_json,
    "github": github,
}
