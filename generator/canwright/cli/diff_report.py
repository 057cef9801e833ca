"""Reports of a comparison: text, Markdown, a section of a changelog, JSON, GitHub annotations."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import click

from ..compare import (
    REASONS,
    Category,
    Change,
    Impact,
    Item,
    Witness,
    by_impact,
    compare,
    examples,
    reason_without_witness,
)
from ..compare.positions import positions
from ..diagnostics.diagnostic import Position
from ..model import formatting
from ..project.loader import Loaded
from ..targets.registry import targets
from ..templating.markup import markdown as markdown_text
from .printers import annotation

_COLOURS = {Impact.SILENT: "red", Impact.LOUD: "yellow", Impact.BUILD: "cyan", Impact.SAFE: "green"}
_MEANING = {
    Impact.SILENT: "Silent: the program keeps running, but reads or commands something else",
    Impact.LOUD: "Loud: the program receives no reply or reports an error",
    Impact.BUILD: "Names: the program must be adapted before it builds with the new bindings",
    Impact.SAFE: "Existing programs are not affected",
}


@dataclass(frozen=True)
class Comparison:
    """Two editions, their documents, and the changes between them."""

    old: Loaded
    new: Loaded
    changes: tuple[Change, ...]

    @classmethod
    def of(cls, old: Loaded, new: Loaded) -> Comparison:
        return cls(old, new, compare(old.specification.edition, new.specification.edition, targets()))

    @property
    def title(self) -> str:
        """The heading of a report: `lamp v1 -> v2`."""
        old, new = self.old.specification.edition, self.new.specification.edition
        return f"{old.family} {old.name} -> {new.name}"

    def positions(self, change: Change) -> tuple[Position, Position]:
        """The positions of a change in both specs."""
        return positions(change, self.old.document, self.new.document)


def _grouped(changes: Sequence[Change]) -> dict[Item, list[Change]]:
    """Changes by item, the most affected items first."""
    groups: dict[Item, list[Change]] = {}
    for change in by_impact(tuple(changes)):
        groups.setdefault(change.item, []).append(change)
    return groups


def _affected(change: Change) -> str:
    return f"host {' and '.join(side.value for side in change.sides)}" if change.sides else ""


def _reach(item: Item, changes: Sequence[Change]) -> str:
    names = dict.fromkeys(name for change in changes for name in change.used_by)
    others = [name for name in names if name != item.name]
    return f" ({', '.join(others)})" if others else ""


def text(comparison: Comparison) -> str:
    """Changes grouped by item, silent ones first, each with its positions in both files."""
    lines = [comparison.title, ""]
    for item, changes in _grouped(comparison.changes).items():
        lines.append(_styled(str(item), None) + _reach(item, changes))
        for change in changes:
            old, new = comparison.positions(change)
            impact = _styled(f"{change.impact.value:6}", _COLOURS[change.impact])
            lines.append(f"  {impact}  {change.rule.category.value:5}  {change.says()} [{change.rule.id}]")
            affected = _affected(change) and f"{_affected(change)}; "
            lines.append(f"                 {affected}{_location(old)} -> {_location(new)}")
            lines += (f"                 {line}" for line in _examples(change))
        lines.append("")
    return "\n".join([*lines, summary(comparison.changes)])


def _styled(written: str, colour: str | None) -> str:
    return written if os.environ.get("NO_COLOR") else click.style(written, fg=colour, bold=True)


def _examples(change: Change) -> list[str]:
    """The witnesses of a change, one for each side, or why it has none."""
    reason = reason_without_witness(change)
    return [REASONS[reason]] if reason else [_example(witness) for witness in examples(change)]


def _example(witness: Witness) -> str:
    condition = f"[{witness.condition}] " if witness.assignment else ""
    return f"{witness.impact.value}: {condition}{witness.says()}"


def _location(at: Position) -> str:
    return f"{at.file}:{at.line}:{at.column}"


def summary(changes: Sequence[Change]) -> str:
    """The counts of changes: `12 changes: 3 wire, 9 doc; 2 silent, 1 loud`."""
    categories = Counter(change.rule.category for change in changes)
    impacts = Counter(change.impact for change in changes)
    kinds = ", ".join(f"{categories[c]} {c.value}" for c in Category if categories[c])
    broken = ", ".join(f"{impacts[i]} {i.value}" for i in (Impact.SILENT, Impact.LOUD) if impacts[i])
    count = formatting.counted(len(changes), "change")
    return (
        count + (f": {kinds}" if kinds else "") + (f"; {broken}" if broken else "; nothing breaks" if changes else "")
    )


def markdown(comparison: Comparison) -> str:
    """A table of changes for each impact."""
    lines = [f"# {comparison.title}", "", summary(comparison.changes), ""]
    for impact in Impact:
        changes = [change for change in comparison.changes if change.impact is impact]
        if changes:
            lines += [f"## {_MEANING[impact]}", "", "| item | change | frame | kind | host | old | new |"]
            lines += [
                "| --- | --- | --- | --- | --- | --- | --- |",
                *(_row(comparison, change) for change in changes),
                "",
            ]
    return "\n".join(lines).rstrip("\n")


def _row(comparison: Comparison, change: Change) -> str:
    old, new = comparison.positions(change)
    host = ", ".join(side.value for side in change.sides)
    kind = f"{change.rule.category.value} `{change.rule.id}`"
    locations = [markdown_text(f"{at.file}:{at.line}") for at in (old, new)]
    frames = "<br>".join(_examples(change))
    return f"| {' | '.join([str(change.item), change.says(escape=markdown_text), frames, kind, host, *locations])} |"


def changelog(comparison: Comparison) -> str:
    """A section to paste into a changelog."""
    new = comparison.new.specification.edition
    lines = [f"## {new.name}" + (f" ({new.date})" if new.date else ""), ""]
    lines += [f"Since {comparison.old.specification.edition.name}, {summary(comparison.changes)}.", ""]
    by_heading: dict[str, list[str]] = {heading: [] for heading in ("Changed", "Added", "Removed")}
    documents: dict[str, list[str]] = {}
    for change in by_impact(comparison.changes):
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
    impact = (
        f"**{change.impact.value}**, {_affected(change)}: " if change.impact in (Impact.SILENT, Impact.LOUD) else ""
    )
    item = "" if change.item.name and f"`{change.item.name}`" in change.says() else f"{change.item}: "
    return f"- {impact}{item}{change.says(escape=markdown_text)}"


def as_json(comparison: Comparison) -> str:
    """An object with `old`, `new` and `changes`."""

    def location(at: Position) -> dict[str, object]:
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
            "witnesses": list(map(_witness, change.witnesses)),
            "no_witness": reason_without_witness(change) or None,
            "old": location(comparison.positions(change)[0]),
            "new": location(comparison.positions(change)[1]),
        }
        for change in by_impact(comparison.changes)
    ]
    old, new = comparison.old.specification.edition, comparison.new.specification.edition
    listed = {"family": old.family, "old": old.name, "new": new.name, "changes": changes}
    return json.dumps(listed, indent=2, ensure_ascii=False)


def _witness(witness: Witness) -> dict[str, object]:
    return {
        "host": witness.side.value,
        "impact": witness.impact.value,
        "parameters": dict(witness.assignment),
        "frame": witness.sent or None,
        "message": witness.says(),
    }


def github(comparison: Comparison) -> str:
    """Workflow commands that GitHub shows at the lines of the new spec."""

    def line(change: Change) -> str:
        old, new = comparison.positions(change)
        level = "warning" if change.impact in (Impact.SILENT, Impact.LOUD) else "notice"
        affected = f"{change.impact.value}, {_affected(change)}: " if change.sides else ""
        return annotation(
            level, new, change.rule.id, f"{affected}{change.item}: {change.says()} (was {_location(old)})"
        )

    return "\n".join(map(line, by_impact(comparison.changes)))


REPORTS: Mapping[str, Callable[[Comparison], str]] = {
    "text": text,
    "markdown": markdown,
    "changelog": changelog,
    "json": as_json,
    "github": github,
}
