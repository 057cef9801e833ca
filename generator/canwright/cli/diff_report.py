"""Reports of comparisons: text, Markdown, a summary for pull requests, a changelog, JSON, JUnit, GitHub annotations."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

from ..compare import Category, Change, Impact, Item, by_impact, compare
from ..compare.positions import positions
from ..compare.verdicts import examples, reason_without_witness
from ..compare.witnesses.witness import REASONS, Witness
from ..diagnostics.diagnostic import Position
from ..diagnostics.unicode_safety import visible
from ..model import formatting
from ..project.accepted import Identity, identity
from ..project.configuration import BREAKING, DiffConfiguration
from ..project.loader import Loaded
from ..targets.registry import targets
from ..templating.markup import markdown as markdown_text
from .printers import annotation
from .terminal import bold, json_text

_COLOURS = {Impact.SILENT: "red", Impact.LOUD: "yellow", Impact.BUILD: "cyan", Impact.SAFE: "green"}
_MEANING = {
    Impact.SILENT: "Silent: the program keeps running, but reads or commands something else",
    Impact.LOUD: "Loud: the program receives no reply or reports an error",
    Impact.BUILD: "Names: the program must be adapted before it builds with the new bindings",
    Impact.SAFE: "Existing programs are not affected",
}


@dataclass(frozen=True)
class Policy:
    """Which changes are shown, accepted, and make `diff` fail on some kinds."""

    configuration: DiffConfiguration = field(default_factory=DiffConfiguration)
    kinds: Sequence[str] = (BREAKING,)
    reasons: Mapping[Identity, str] = field(default_factory=dict)
    without_doc: bool = False

    def shows(self, change: Change) -> bool:
        return not (self.configuration.ignores(change) or (self.without_doc and change.rule.category is Category.DOC))


class Comparison(NamedTuple):
    """Two editions with their documents: the changes to show, accepted ones with their reasons, and those that fail."""

    old: Loaded
    new: Loaded
    changes: tuple[Change, ...]
    accepted: tuple[tuple[Change, str], ...]
    ids_of_failing: frozenset[int]

    @classmethod
    def of(cls, old: Loaded, new: Loaded, policy: Policy) -> Comparison:
        title = _title(old, new)
        reasoned = [
            (change, policy.reasons.get(identity(title, change)))
            for change in by_impact(compare(old.specification.edition, new.specification.edition, targets()))
        ]
        changes = tuple(change for change, reason in reasoned if reason is None and policy.shows(change))
        accepted = tuple((change, reason) for change, reason in reasoned if reason is not None)
        failing = frozenset(id(change) for change in changes if policy.configuration.fails(change, policy.kinds))
        return cls(old, new, changes, accepted, failing)

    @property
    def title(self) -> str:
        """The heading of a report: `lamp v1 -> v2`."""
        return _title(self.old, self.new)

    @property
    def summary(self) -> str:
        """The counts of changes: `12 changes: 3 wire, 9 doc; 2 silent, 1 loud; 1 more accepted`."""
        more = f"; {len(self.accepted)} more accepted" if self.accepted else ""
        return summary(self.changes) + more

    @property
    def failing(self) -> Sequence[Change]:
        """The changes that fail `diff`."""
        return [change for change in self.changes if self.fails(change)]

    def fails(self, change: Change) -> bool:
        """Whether one of the changes fails `diff`."""
        return id(change) in self.ids_of_failing

    def positions(self, change: Change) -> tuple[Position, Position]:
        """The positions of a change in both specs."""
        return positions(change, self.old.document, self.new.document)


class Report(NamedTuple):
    """All comparisons of a run, and the specs added and removed since a git revision."""

    comparisons: tuple[Comparison, ...]
    added: tuple[Loaded, ...] = ()
    removed: tuple[Loaded, ...] = ()
    against: str | None = None

    @property
    def accepted(self) -> set[Identity]:
        """The identities of the accepted changes."""
        return {
            identity(comparison.title, change) for comparison in self.comparisons for change, _ in comparison.accepted
        }

    def written(
        self, comparison: Callable[[Comparison], str], spec: Callable[[str], str], nothing: Callable[[str], str]
    ) -> str:
        """The reports of all comparisons, then the specs added and removed: `added: lamp v3 (spec/lamp/v3.yaml)`."""
        specs = "\n".join(
            spec(f"{kind}: {of.specification.edition.family} {of.specification.edition.name} ({of.document.name})")
            for kind, specs in (("added", self.added), ("removed", self.removed))
            for of in specs
        )
        parts = [*map(comparison, self.comparisons), *([specs] if specs else [])]
        return "\n\n".join(parts) or nothing(f"spec differs from {self.against}")


def _title(old: Loaded, new: Loaded) -> str:
    before, after = old.specification.edition, new.specification.edition
    return f"{before.family} {before.name} -> {after.name}"


def _affected(change: Change) -> str:
    """`host sending and receiving`; with the impacts where they differ: `host sending: loud, receiving: silent`."""
    if not change.verdicts:
        return ""
    if change.differs_by_side:
        return "host " + ", ".join(f"{side.value}: {impact.value}" for side, impact in change.verdicts.items())
    return f"host {' and '.join(side.value for side in change.verdicts)}"


def _host(change: Change) -> str:
    """The affected sides for a cell of a table."""
    return _affected(change).removeprefix("host ").replace(" and ", ", ")


def _reach(item: Item, changes: Sequence[Change]) -> str:
    names = dict.fromkeys(name for change in changes for name in change.used_by)
    affected = [name for name in names if name != item.name]
    return f" ({', '.join(affected)})" if affected else ""


def _text(comparison: Comparison) -> str:
    """Changes grouped by item, silent ones first, each with its positions in both files."""
    lines, groups = [comparison.title, ""], defaultdict[Item, list[Change]](list)
    for change in comparison.changes:
        groups[change.item].append(change)
    for item, changes in groups.items():
        lines.append(bold(str(item)) + _reach(item, changes))
        for change in changes:
            impact = bold(f"{change.impact.value:6}", _COLOURS[change.impact])
            lines.append(f"  {impact}  {change.rule.category.value:5}  {change.says()} [{change.rule.id}]")
            affected = _affected(change) and f"{_affected(change)}; "
            details = affected + " -> ".join(map(_location, comparison.positions(change))), *_examples(change)
            lines += (f"                 {line}" for line in details)
        lines.append("")
    return "\n".join([*lines, comparison.summary])


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
    kinds = ", ".join(f"{categories[c]} {c.value}" for c in Category if categories[c])
    if not changes:
        return "0 changes"
    broken = ", ".join(_broken(changes)) or "nothing breaks"
    return f"{formatting.counted(len(changes), 'change')}: {kinds}; {broken}"


def _is_broken(change: Change) -> bool:
    """Whether a change breaks existing programs."""
    return change.impact in (Impact.SILENT, Impact.LOUD)


def _broken(changes: Sequence[Change]) -> list[str]:
    """The counts of the changes that break programs: `2 silent`, `1 loud`."""
    impacts = Counter(change.impact for change in changes if _is_broken(change))
    return [f"{impacts[impact]} {impact.value}" for impact in Impact if impacts[impact]]


def _markdown(comparison: Comparison) -> str:
    """A table of changes for each impact."""
    lines = [f"# {comparison.title}", "", comparison.summary, ""]
    for impact in Impact:
        changes = [change for change in comparison.changes if change.impact is impact]
        if changes:
            rows = [_row(comparison, change) for change in changes]
            heads = "item", "change", "frame", "kind", "host", "old", "new"
            lines += [f"## {_MEANING[impact]}", "", *_table(heads, rows), ""]
    return "\n".join(lines).rstrip("\n")


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(row)} |" for row in (heads, ["---"] * len(heads), *rows)]


def _row(comparison: Comparison, change: Change) -> Sequence[str]:
    kind = f"{change.rule.category.value} `{change.rule.id}`"
    locations = [markdown_text(f"{at.file}:{at.line}") for at in comparison.positions(change)]
    frames = "<br>".join(_examples(change))
    return [str(change.item), change.says(escape=markdown_text), frames, kind, _host(change), *locations]


def _changelog(comparison: Comparison) -> str:
    """A section to paste into a changelog."""
    new = comparison.new.specification.edition
    lines = [f"## {new.name}" + (f" ({new.date})" if new.date else ""), ""]
    lines += [f"Since {comparison.old.specification.edition.name}, {summary(comparison.changes)}.", ""]
    by_heading: dict[str, list[str]] = {heading: [] for heading in ("Changed", "Added", "Removed")}
    documents: dict[str, list[str]] = {}
    for change in comparison.changes:
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
    impact = f"**{change.impact.value}**, {_affected(change)}: " if _is_broken(change) else ""
    item = "" if change.item.name and f"`{change.item.name}`" in change.says() else f"{change.item}: "
    return f"- {impact}{item}{change.says(escape=markdown_text)}"


def _json(comparison: Comparison) -> dict[str, object]:
    """An object with `old`, `new`, `changes` and the number of `accepted` ones."""

    def of(change: Change) -> dict[str, object]:
        old, new = ({"file": at.file, "line": at.line, "column": at.column} for at in comparison.positions(change))
        return {
            "rule": change.rule.id,
            "category": change.rule.category.value,
            "impact": change.impact.value,
            "fails": comparison.fails(change),
            "host": [side.value for side in change.verdicts],
            "verdicts": {side.value: impact.value for side, impact in change.verdicts.items()},
            "item": {"kind": change.item.kind, "name": change.item.name},
            "message": change.says(),
            "used_by": list(change.used_by),
            "witnesses": list(map(_witness, change.witnesses)),
            "no_witness": reason_without_witness(change) or None,
            "old": old,
            "new": new,
        }

    changes = list(map(of, comparison.changes))
    accepted = [
        {"rule": change.rule.id, "message": change.says(), "reason": reason} for change, reason in comparison.accepted
    ]
    old, new = comparison.old.specification.edition, comparison.new.specification.edition
    return {"family": old.family, "old": old.name, "new": new.name, "changes": changes, "accepted": accepted}


def _witness(witness: Witness) -> dict[str, object]:
    return {
        "host": witness.side.value,
        "impact": witness.impact.value,
        "parameters": dict(witness.assignment),
        "frame": witness.sent or None,
        "message": witness.says(),
    }


def _github(comparison: Comparison) -> str:
    """Workflow commands that GitHub shows at the lines of the new spec; what fails `diff` is an error."""

    def line(change: Change) -> str:
        old, new = comparison.positions(change)
        level = "error" if comparison.fails(change) else "warning" if _is_broken(change) else "notice"
        affected = f"{change.impact.value}, {_affected(change)}: " if change.sides else ""
        return annotation(
            level, new, change.rule.id, f"{affected}{change.item}: {change.says()} (was {_location(old)})"
        )

    return "\n".join(map(line, comparison.changes))


def _pull_request(comparison: Comparison) -> str:
    """The verdict, a table of what breaks, and the rest, collapsed."""
    broken = [change for change in comparison.changes if _is_broken(change)]
    lines = [f"### {comparison.title}", ""]
    if broken:
        heads = "impact", "item", "change", "frame", "host", "where"
        count, kinds = formatting.counted(len(broken), "change"), " and ".join(_broken(broken))
        lines += [f"**Existing programs break: {count}, {kinds}.**", ""]
        lines += [*_table(heads, (_broken_row(comparison, change) for change in broken)), ""]
    else:
        lines += ["**Existing programs keep working.**", ""]
    bullets = [_bullet(change) for change in comparison.changes if change not in broken]
    bullets += [f"{_bullet(change)} (accepted: {markdown_text(reason)})" for change, reason in comparison.accepted]
    if bullets:
        count = formatting.counted(len(bullets), "other change" if broken else "change")
        lines += ["<details>", f"<summary>{count}</summary>", "", *bullets, "", "</details>"]
    return "\n".join(lines).rstrip("\n")


def _broken_row(comparison: Comparison, change: Change) -> Sequence[str]:
    item, says, frames, _, host, _, new = _row(comparison, change)
    return [change.impact.value, item, says, frames.partition("<br>")[0], host, new]


def _bullet(change: Change) -> str:
    return f"- {change.item}: {change.says(escape=markdown_text)}"


def text(report: Report) -> str:
    """Text for the terminal."""
    return report.written(_text, str, lambda nothing: f"no {nothing}")


def _in_markdown(comparison: Callable[[Comparison], str], report: Report) -> str:
    return report.written(
        comparison, lambda spec: f"- {markdown_text(spec)}", lambda nothing: markdown_text(f"No {nothing}.")
    )


def as_json(report: Report) -> str:
    """One object of a comparison; with `--against`, all of them, and the files of the specs added and removed."""
    objects = [_json(comparison) for comparison in report.comparisons]
    if report.against is None:
        return json_text(objects[0])
    added, removed = ([spec.document.name for spec in specs] for specs in (report.added, report.removed))
    return json_text({"against": report.against, "comparisons": objects, "added": added, "removed": removed})


def github(report: Report) -> str:
    """Workflow commands for GitHub."""
    return "\n".join(filter(None, map(_github, report.comparisons)))


def junit(report: Report) -> str:
    """JUnit XML in ASCII: a suite for each comparison, a test for each change; those that fail `diff` are failures."""
    from xml.etree import ElementTree  # other reports need none

    suites = ElementTree.Element("testsuites", name="canwright diff")
    for comparison in report.comparisons:
        counts = {"tests": str(max(1, len(comparison.changes))), "failures": str(len(comparison.failing))}
        suite = ElementTree.SubElement(suites, "testsuite", {"name": comparison.title, **counts})
        if not comparison.changes:
            ElementTree.SubElement(suite, "testcase", classname=comparison.title, name="no change")
        for change in comparison.changes:
            old, new = map(_location, comparison.positions(change))
            name = visible(f"{change.item}: {change.says()} [{change.rule.id}]")
            case = ElementTree.SubElement(suite, "testcase", classname=comparison.title, name=name)
            if comparison.fails(change):
                says = visible(f"{change.impact.value}, {_affected(change)}: {change.says()}")
                failure = ElementTree.SubElement(case, "failure", message=says, type=change.rule.id)
                failure.text = "\n".join(map(visible, (f"{old} -> {new}", *_examples(change))))
    ElementTree.indent(suites)
    text = str(ElementTree.tostring(suites, "us-ascii", xml_declaration=True), "ascii")
    return text.replace("##", "#&#35;")  # texts are not executed by a CI system


FOR_PROGRAMS = ("json", "github", "junit")
"""Formats that are escaped completely; the others are for people."""

REPORTS: Mapping[str, Callable[[Report], str]] = {
    "text": text,
    "markdown": partial(_in_markdown, _markdown),
    "summary": partial(_in_markdown, _pull_request),
    "changelog": partial(_in_markdown, _changelog),
    "json": as_json,
    "junit": junit,
    "github": github,
}
"""Text for the terminal, tables for each impact, a summary for a pull request, a section of a changelog, and formats for programs."""
