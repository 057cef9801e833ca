"""Compares the verdicts of `canwright diff` with the behaviour of generated code, for thousands of edits of specs.

Each edit gives a new edition. The Python bindings of the old and of the new edition exchange frames as an old host and
a new node (`behaviour.py`): an edit is silent where a frame is accepted with another meaning, loud where it is rejected or
not answered, and safe otherwise, on each side. The findings of the comparison must say the same.

Each printed frame is decoded with both bindings and compared with its sentence (`witnesses.py`). The keys of each
edition are also put in another order, which must give the same findings.

Not decided here, and accepted either way: values outside a range, which generated code checks only before it sends;
replies to requests that a new node rejects or takes for other requests, or that only a new host on the same bus can have
sent; frames from nodes that an old host does not know.
"""

from __future__ import annotations

import argparse
import copy
import difflib
import gc
import random
import re
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from canwright.compare import Category, Change, compare
from canwright.compare.positions import positions
from canwright.diagnostics.diagnostic import SpecError
from canwright.document.document import Document
from canwright.project.loader import Loaded, load, spec_files

from ..spec_texts import ROOT, SPECS, called
from .behaviour import LOUD, NAMES, SAFE, SIDES, SILENT, Behaviour, Binding, Old, behaviour
from .edits import Data, Edit, edits, reordered
from .witnesses import learn_units, wrong_witnesses

OWN = spec_files(ROOT / "tests/verification/specs")
"""Specs that only this comparison uses."""

FUNCTIONAL = (Category.WIRE, Category.VALUE, Category.API)
_IMPACT = {"silent": SILENT, "loud": LOUD, "build": SAFE, "safe": SAFE}

OVER_WARNED = 0.02
"""The share of verdicts that may warn of more than what happens."""


@dataclass
class Case:
    """One edit: what was found, what happens, and what is wrong with the findings."""

    spec: str
    edit: Edit
    changes: tuple[Change, ...]
    happened: Behaviour
    reported: dict[str, int]
    dangerous: list[str] = field(default_factory=list)
    over_warned: list[str] = field(default_factory=list)
    debatable: list[str] = field(default_factory=list)
    wrong_witnesses: list[str] = field(default_factory=list)
    ordered: list[str] = field(default_factory=list)
    missing: str = ""
    elsewhere: list[str] = field(default_factory=list)
    several: int = 0
    lines: int = 0

    @property
    def name(self) -> str:
        return f"{self.spec}: {self.edit.name}"

    @property
    def is_wrong(self) -> bool:
        return bool(self.dangerous or self.over_warned or self.wrong_witnesses or self.ordered or self.missing)

    @property
    def rules(self) -> str:
        return ", ".join(
            f"{c.rule.id}({c.item})" + ", ".join(f" {side.value} {impact.value}" for side, impact in c.verdicts.items())
            for c in functional(self.changes)
        )


def functional(changes: Iterable[Change]) -> list[Change]:
    """All changes besides those of texts."""
    return [c for c in changes if c.rule.category in FUNCTIONAL]


def reported(changes: Iterable[Change]) -> dict[str, int]:
    """The worst verdict of each side."""
    worst = dict.fromkeys(SIDES, SAFE)
    for change in changes:
        for side, impact in change.verdicts.items():
            worst[side.value] = max(worst[side.value], _IMPACT[impact.value])
    return worst


class Spec:
    """An old edition with its text."""

    def __init__(self, file: Path, folder: Path) -> None:
        self.name = called(file)
        self.folder = folder
        self.data: Data = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
        self.data.pop("errata", None)
        self.text = dumped(self.data)
        self.loaded = self._load(self.text)
        self.old = Old(self.loaded.specification)
        self.turned = self._load(dumped(reordered(self.data, lambda keys: keys[::-1])))

    def _load(self, text: str) -> Loaded:
        file = self.folder / "spec.yaml"
        file.write_text(text, "utf-8")
        return load(file)

    def edits(self) -> list[Edit]:
        return list(edits(self.data))

    def case(self, edit: Edit) -> Case | None:
        """The result of an edit; None where the new spec is invalid or the same."""
        data = copy.deepcopy(self.data)
        try:
            edit.change(data)
            text = dumped(data)
            if text == self.text:
                return None
            loaded = self._load(text)
            dice = random.Random(text)
            turned = self._load(dumped(reordered(data, lambda keys: dice.sample(keys, len(keys)))))
        except (SpecError, KeyError, TypeError, ValueError, AttributeError, IndexError):
            return None
        case = self._judged(edit, text, loaded)
        case.ordered += _different(case.changes, _compared(self.loaded, turned))
        case.ordered += _different(case.changes, _compared(self.turned, loaded))
        return case

    def _judged(self, edit: Edit, text: str, loaded: Loaded) -> Case:
        changes, new = _compared(self.loaded, loaded), Binding(loaded.specification)
        happened = behaviour(self.old, new, edit.names)
        case = Case(self.name, edit, changes, happened, reported(changes))
        learn_units(self.old.edition, new.edition)
        case.wrong_witnesses += wrong_witnesses(changes, self.old.binding, new, edit.names)
        for name in SIDES:
            side, said = happened.sides[name], case.reported[name]
            if said < side.low:
                case.dangerous.append(f"{name} is {NAMES[side.low]}, reported {NAMES[said]}: {side.low_why}")
            elif said > side.high:
                case.over_warned.append(f"{name} is {NAMES[side.high]}, reported {NAMES[said]}: {side.high_why}")
            elif said != side.low:
                case.debatable.append(f"{name} is {NAMES[side.low]}, reported {NAMES[said]}: {side.high_why}")
        findings = functional(changes)
        changed = any(happened.sides[name].low for name in SIDES)
        if not findings and (changed or happened.names_differ):
            case.missing = "names" if not changed else "behaviour"
        if edit.nothing and changes:
            case.missing = "nothing changed, but: " + ", ".join(c.rule.id for c in changes)
        before, after = _changed_lines(self.text, text)
        case.lines = max(len(before), len(after))
        for change in findings:
            if not _near(change, before, after, self.loaded.document, loaded.document):
                case.elsewhere.append(f"{change.rule.id}({change.item}) at {change.old} -> {change.new}")
        case.several = len(findings)
        return case


def _compared(old: Loaded, new: Loaded) -> tuple[Change, ...]:
    return compare(old.specification.edition, new.specification.edition)


def _different(first: Iterable[Change], second: Iterable[Change]) -> list[str]:
    """The changes that only one of two comparisons finds; of editions that differ in the order of keys alone, none."""
    before, after = (sorted(map(_described, changes)) for changes in (first, second))
    return [line for line in difflib.ndiff(before, after) if not line.startswith((" ", "?"))]


def _described(change: Change) -> str:
    verdicts = ", ".join(f"{side.value} {impact.value}" for side, impact in sorted(change.verdicts.items()))
    return f"{change.rule.id} {change.item}: {change.says()} [{verdicts}] {', '.join(sorted(change.used_by))}"


def dumped(data: Data) -> str:
    """A spec as text, one key a line."""
    return yaml.dump(data, Dumper=_Dumper, allow_unicode=True, sort_keys=False, default_flow_style=False)


class _Dumper(yaml.CSafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True


def _changed_lines(old: str, new: str) -> tuple[set[int], set[int]]:
    """The lines that differ, in each text; both lines around a place where some were removed or added."""
    a, b = old.splitlines(), new.splitlines()
    start = 0
    while start < min(len(a), len(b)) and a[start] == b[start]:
        start += 1
    end = 0
    while end < min(len(a), len(b)) - start and a[-1 - end] == b[-1 - end]:
        end += 1
    before: set[int] = set()
    after: set[int] = set()
    matcher = difflib.SequenceMatcher(None, a[start : len(a) - end], b[start : len(b) - end], autojunk=False)
    for tag, i, j, k, m in matcher.get_opcodes():
        if tag != "equal":
            before |= set(range(start + i + 1, start + j + 1))
            after |= set(range(start + k + 1, start + m + 1))
    return before, after


def _near(change: Change, before: set[int], after: set[int], old: Document, new: Document) -> bool:
    """Whether a change is at an edited line of one of the specs."""
    earlier, later = positions(change, old, new)
    return earlier.line in before or later.line in after


@dataclass
class Totals:
    """The sum of all cases."""

    cases: list[Case] = field(default_factory=list)
    rejected: int = 0

    def report(self, shown: int) -> Iterator[str]:
        judged = len(self.cases) * len(SIDES)
        kinds = {
            "not found": [c for c in self.cases if c.missing],
            "wrong witnesses": [c for c in self.cases if c.wrong_witnesses],
            "dependent on the order of keys": [c for c in self.cases if c.ordered],
            "dangerous": [c for c in self.cases if c.dangerous],
            "over-warned": [c for c in self.cases if c.over_warned],
            "debatable": [c for c in self.cases if c.debatable],
            "not at an edited line": [c for c in self.cases if c.elsewhere],
            "more than one finding": [c for c in self.cases if c.several > 1],
        }
        yield f"{len(self.cases)} edits, {self.rejected} rejected, {judged} verdicts"
        warned = sum(max(c.reported.values()) > SAFE for c in self.cases)
        yield f"{warned} edits with a warning; share over-warned {self.share:.2%}"
        for name, cases in kinds.items():
            examples: dict[str, list[str]] = {}
            for case in cases:
                examples.setdefault(_pattern(case, name), []).append(case.name)
            yield f"\n== {name}: {len(cases)}"
            for pattern, names in sorted(examples.items(), key=lambda item: -len(item[1]))[:shown]:
                yield f"   {len(names):5} {pattern}  e.g. {names[len(names) // 2]}"

    @property
    def share(self) -> float:
        verdicts = sum(value > SAFE for c in self.cases for value in c.reported.values())
        return sum(len(c.over_warned) for c in self.cases) / max(verdicts, 1)

    @property
    def passed(self) -> bool:
        wrong = any(c.dangerous or c.wrong_witnesses or c.ordered or c.missing for c in self.cases)
        return not wrong and self.share <= OVER_WARNED


def _pattern(case: Case, kind: str) -> str:
    lists = {"dangerous": case.dangerous, "over-warned": case.over_warned, "debatable": case.debatable}
    rules = ", ".join(sorted({f"{c.impact.value} {c.rule.id}" for c in functional(case.changes)})) or "no finding"
    if kind in lists:
        said = "; ".join(line.partition(":")[0] for line in lists[kind])
        return f"{said}  [{rules}]"
    if kind == "wrong witnesses":
        return re.sub(r"[0-9A-F]{3,}#\S+|[0-9.]+", "…", case.wrong_witnesses[0])
    if kind == "dependent on the order of keys":
        return case.ordered[0]
    if kind == "not found":
        return f"{case.missing}"
    if kind == "not at an edited line":
        return f"{', '.join(sorted({e.partition('(')[0] for e in case.elsewhere}))}"
    return f"[{', '.join(sorted(c.rule.id for c in functional(case.changes)))}]"


def detail(case: Case) -> Iterator[str]:
    """A case in full."""
    yield case.name
    yield f"    findings: {case.rules or 'none'}"
    for witness in (w for change in case.changes for w in change.witnesses):
        yield f"    witness {witness.impact.value} {witness.side.value}: {witness.sent} {witness.says()}"
    for kind in ("dangerous", "over_warned", "debatable", "wrong_witnesses", "ordered", "elsewhere"):
        yield from (f"    {kind}: {line}" for line in getattr(case, kind))
    if case.missing:
        yield f"    not found: {case.missing}"


def run(files: Sequence[Path], folder: Path, sample: int | None = None, seed: int = 1, only: str = "") -> Totals:
    """The cases of all edits of some specs, or of a random sample of them."""
    totals = Totals()
    dice = random.Random(seed)
    for file in files:
        spec = Spec(file, folder)
        chosen = [e for e in spec.edits() if only in e.name]
        if sample is not None and len(chosen) > sample:
            chosen = dice.sample(chosen, sample)
        for number, edit in enumerate(chosen):
            case = spec.case(edit)
            if case is None:
                totals.rejected += 1
            else:
                totals.cases.append(case)
            if number % 200 == 199:
                gc.collect()
    return totals


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 1 if a verdict is dangerous, or too many warn of what does not happen."""
    parser = argparse.ArgumentParser(
        "python -m tests.verification.compare",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--sample", type=int, help="so many edits of each spec (default: all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spec", action="append", help="as pump/v1 (default: all specs of spec/ and of the tests)")
    parser.add_argument("--edit", default="", help="only edits whose name contains this text")
    parser.add_argument("--show", type=int, default=0, help="print so many wrong cases in full")
    parser.add_argument(
        "--kinds", type=int, default=40, help="print so many patterns of each list (default %(default)s)"
    )
    given = parser.parse_args(arguments)
    files = [f for f in (*OWN, *SPECS) if not given.spec or called(f) in given.spec or f.parent.name in given.spec]
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        totals = run(files, Path(folder), given.sample, given.seed, given.edit)
    print("\n".join(totals.report(given.kinds)))
    print(f"\n{time.perf_counter() - start:.0f} s")
    wrong = [c for c in totals.cases if c.is_wrong]
    for case in wrong[: given.show]:
        print("\n".join(detail(case)))
    return 0 if totals.passed else 1


if __name__ == "__main__":
    sys.exit(main())
