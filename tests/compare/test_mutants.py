"""Every kind of small change of a spec has exactly the findings in `mutants.txt`.

`python -m tests.compare.test_mutants` rewrites that file, `python -m tests.compare.test_mutants all` prints the findings
of every mutant of every spec. Where there are none, the mutant says the same in other words.
"""

from __future__ import annotations

import copy
import difflib
import functools
import itertools
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.compare import Change, Impact, compare
from canwright.compare.positions import positions
from canwright.diagnostics.diagnostic import SpecError
from canwright.language.edition import EditionSpec, json_schema
from canwright.model.edition import Edition
from canwright.project.loader import Loaded, load

from ..conformance.mutants import mutants
from ..samples import sampled
from ..spec_texts import SMALL, SPECS, called
from .recorded import findings, record, recorded

RECORDED = "mutants.txt"
OF_KIND = 3
"""So many mutants of each kind are recorded, of the small specs of the tests."""
OF_LARGE = 4
"""So many mutants are recorded of each spec of `spec/`, and one of each kind that no small spec has."""

Case = tuple[str, str]


@functools.cache
def _data(spec: str) -> dict[str, Any]:
    """A spec whose errata depend on nothing that a mutant may remove."""
    (file,) = (file for file in SPECS if called(file) == spec)
    data: dict[str, Any] = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
    for erratum in data.get("errata", ()):
        erratum["where"] = ["commands"]
    return data


@functools.cache
def _mutants(spec: str) -> dict[str, Callable[[dict[Any, Any]], None]]:
    return dict(mutants(_data(spec)))


@functools.cache
def _original(spec: str) -> Loaded:
    with tempfile.TemporaryDirectory() as folder:
        return _loaded(Path(folder), _data(spec))


def _loaded(folder: Path, data: dict[str, Any]) -> Loaded:
    """The spec with each key on a line of its own."""
    file = folder / "spec.yaml"
    file.write_text(_text(data), "utf-8")
    return load(file)


def _text(data: dict[str, Any]) -> str:
    return yaml.dump(data, Dumper=yaml.CSafeDumper, allow_unicode=True, sort_keys=False)


def _data_of(case: Case) -> dict[str, Any]:
    spec, mutant = case
    data = copy.deepcopy(_data(spec))
    _mutants(spec)[mutant](data)
    return data


def _changed(spec: str, mutant: str, folder: Path) -> Edition:
    """The changed edition. Raises SpecError where it is invalid."""
    return _loaded(folder, _data_of((spec, mutant))).specification.edition


def _compared(case: Case, folder: Path) -> tuple[str, list[str]]:
    """The findings of a mutant, and those that are at no line that it edits."""
    old, data = _original(case[0]), _data_of(case)
    try:
        new = _loaded(folder, data)
    except SpecError:
        return "rejected", []
    changes = compare(old.specification.edition, new.specification.edition)
    before, after = _edited(_text(_data(case[0])).splitlines(), _text(data).splitlines())

    def is_at_edit(change: Change) -> bool:
        at = positions(change, old.document, new.document)
        return at[0].line in before or at[1].line in after

    return findings(changes), [c.rule.id for c in changes if not is_at_edit(c)]


def _findings(case: Case, folder: Path) -> str:
    return _compared(case, folder)[0]


def _alike(old: list[str], new: list[str]) -> int:
    """How many lines are the same from the start."""
    return sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(old, new, strict=False)))


def _edited(old: list[str], new: list[str]) -> tuple[set[int], set[int]]:
    """The numbers of the lines that differ in each text."""
    same = _alike(old, new)
    tail = _alike(old[: same - 1 : -1] if same else old[::-1], new[: same - 1 : -1] if same else new[::-1])
    lines = old[same : len(old) - tail], new[same : len(new) - tail]
    before, after = set[int](), set[int]()
    for tag, i, j, k, m in difflib.SequenceMatcher(None, *lines, autojunk=False).get_opcodes():
        if tag != "equal":
            before |= set(range(same + i + 1, same + j + 1))
            after |= set(range(same + k + 1, same + m + 1))
    return before, after


@functools.cache
def _keys() -> frozenset[str]:
    schema = json_schema(EditionSpec)
    return frozenset(key for concept in (schema, *schema["$defs"].values()) for key in concept.get("properties", {}))


def _kind(mutant: str) -> str:
    """The section of a spec, the key there that differs, and the manner."""
    path, _, manner = mutant.partition(" ")
    first, *_, last = (path + "." + path).split(".")
    key = last if last in _keys() else "name"
    return f"{first} {key} {manner if manner == 'gone' else manner[0] if key == 'raw' else '<->' * ('<->' in manner)}"


def _cases(specs: Sequence[str]) -> dict[str, list[Case]]:
    """The mutants of specs by their kind."""
    kinds: dict[str, list[Case]] = {}
    for spec in specs:
        for mutant in _mutants(spec):
            kinds.setdefault(_kind(mutant), []).append((spec, mutant))
    return kinds


def _spread(cases: list[Case], most: int, folder: Path) -> Iterator[tuple[Case, str]]:
    """Cases that are spread over the list, and whose changed spec is valid."""
    valid = []
    for start in range(most):
        part = cases[start * len(cases) // most : (start + 1) * len(cases) // most]
        valid += [next(((case, result) for case in part if (result := _findings(case, folder)) != "rejected"), None)]
    yield from filter(None, valid)


def _write(folder: Path) -> None:
    small = [called(file) for file in SMALL]
    large = [called(file) for file in SPECS if file not in SMALL]
    chosen = dict(pair for cases in _cases(small).values() for pair in _spread(cases, OF_KIND, folder))
    known = {_kind(mutant) for _, mutant in chosen}
    remaining = [cases for kind, cases in _cases(large).items() if kind not in known]
    chosen |= dict(pair for cases in remaining for pair in _spread(cases, 1, folder))
    whole = [[(spec, mutant) for mutant in _mutants(spec)] for spec in large]
    chosen |= dict(pair for cases in whole for pair in _spread(cases, OF_LARGE, folder))
    record(RECORDED, {" ".join(case): chosen[case] for case in sorted(chosen)})


REFERRED = ("crank/v1 tables.objects.entries.torque_actual.", "chassis/v1 layouts.outcome.fields.sum.raw ")
"""Items on which others depend: an entry to which a field refers, the width of a checksum."""
SHARED = ("axis/v1 commands.read_state.reply.mode gone", "spindle/v1 addresses.objects.alternative_replies gone")
"""Edits in one place that change two things: bits in a word of flags, and the replies of all commands of an address."""
COUNTERS = ".counter "
"""The values of a counter are its range, too."""


@pytest.mark.parametrize("case", sampled([*recorded(RECORDED)], 2))
def test_findings(case: str, tmp_path: Path) -> None:
    """Each finding is at an edited line, but that of a removed item of a list, which is at the list."""
    spec, _, mutant = case.partition(" ")
    result, elsewhere = _compared((spec, mutant), tmp_path)
    assert result == recorded(RECORDED)[case]
    assert not elsewhere or ".accept " in case or COUNTERS in case or case.startswith((*REFERRED, *SHARED))


def test_mutants_with_several_findings_have_several_edits() -> None:
    """Positions that are exchanged are two edits, and so is a scale whose offset is a multiple of the same parameter."""
    several = {case for case, text in recorded(RECORDED).items() if text.count("(") > 1}
    single = {case for case in several if "<->" not in case and " as " not in case and COUNTERS not in case}
    assert {case for case in single if not case.startswith((*REFERRED, *SHARED))} == set()
    assert "none" not in recorded(RECORDED).values()


def test_every_kind_of_mutant_is_recorded(tmp_path: Path) -> None:
    """Except those that contradict the rest of every spec, so that there is nothing to compare."""
    kinds = {_kind(case.partition(" ")[2]) for case in recorded(RECORDED)}
    cases = _cases([called(file) for file in SPECS])
    assert kinds <= set(cases)
    for kind in set(cases) - kinds:
        comparable = [case for case in cases[kind][::3] if _findings(case, tmp_path) != "rejected"]
        assert comparable == [], f"`python -m tests.compare.test_mutants` records them as {kind}"


def test_a_scale_a_sign_and_a_byte_are_silent(tmp_path: Path) -> None:
    for mutant, rule in (
        ("types.voltage.scale 1", "scale-changed"),
        ("types.voltage.raw i16", "sign-changed"),
        ("layouts.status_1.fields.voltage.at 4", "field-moved"),
    ):
        changes = compare(
            _original("mwd_motor/v2.35").specification.edition, _changed("mwd_motor/v2.35", mutant, tmp_path)
        )
        (change,) = (c for c in changes if c.rule.id == rule)
        assert change.impact is Impact.SILENT
        assert [side.value for side in change.sides] == ["receiving"]
        assert set(change.used_by) == {"read_status_1", "clear_errors"}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        if sys.argv[1:] == ["all"]:
            counts: Counter[str] = Counter()
            for name in map(called, SPECS):
                for mutant in _mutants(name):
                    result, elsewhere = _compared((name, mutant), Path(made))
                    print(
                        f"{name} {mutant}: {result}" + (f"; not at the edited line: {elsewhere}" if elsewhere else "")
                    )
                    counts["rejected" if result == "rejected" else f"{result.count('(')} findings"] += 1
                    counts["findings that are not at an edited line"] += len(elsewhere)
            print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
        else:
            _write(Path(made))
