"""Every kind of small change of a spec has exactly the findings in `mutants.txt`.

`python -m tests.compare.test_mutants` rewrites that file, `python -m tests.compare.test_mutants all` prints the findings
of every mutant of every spec. Where there are none, the mutant says the same in other words.
"""

from __future__ import annotations

import copy
import functools
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.compare import Impact, compare
from canwright.diagnostics.diagnostic import SpecError
from canwright.language.edition import EditionSpec, json_schema
from canwright.model.edition import Edition

from ..conformance.mutants import mutants
from ..spec_texts import SMALL, SPECS, called, edition
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
def _original(spec: str) -> Edition:
    with tempfile.TemporaryDirectory() as folder:
        return _edition(Path(folder), _data(spec))


def _edition(folder: Path, data: dict[str, Any]) -> Edition:
    return edition(folder, yaml.dump(data, Dumper=yaml.CSafeDumper, allow_unicode=True, sort_keys=False))


def _changed(spec: str, mutant: str, folder: Path) -> Edition:
    """The changed edition. Raises SpecError where it is invalid."""
    data = copy.deepcopy(_data(spec))
    _mutants(spec)[mutant](data)
    return _edition(folder, data)


def _findings(case: Case, folder: Path) -> str:
    spec, mutant = case
    try:
        return findings(compare(_original(spec), _changed(spec, mutant, folder)))
    except SpecError:
        return "rejected"


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
    """Cases that are spread over the list and valid; one that is rejected where no other is found."""
    valid = []
    for start in range(most):
        part = cases[start * len(cases) // most : (start + 1) * len(cases) // most]
        valid += [next(((case, found) for case in part if (found := _findings(case, folder)) != "rejected"), None)]
    shown = [one for one in valid if one is not None]
    yield from shown or [(cases[0], "rejected")]


def _write(folder: Path) -> None:
    small = [called(file) for file in SMALL]
    large = [called(file) for file in SPECS if file not in SMALL]
    chosen = dict(one for cases in _cases(small).values() for one in _spread(cases, OF_KIND, folder))
    known = {_kind(mutant) for (_, mutant), found in chosen.items() if found != "rejected"}
    others = [cases for kind, cases in _cases(large).items() if kind not in known]
    chosen |= dict(one for cases in others for one in _spread(cases, 1, folder))
    whole = [[(spec, mutant) for mutant in _mutants(spec)] for spec in large]
    chosen |= dict(one for cases in whole for one in _spread(cases, OF_LARGE, folder))
    record(RECORDED, {" ".join(case): chosen[case] for case in sorted(chosen)})


@pytest.mark.parametrize(("case", "found"), recorded(RECORDED).items(), ids=recorded(RECORDED))
def test_findings(case: str, found: str, tmp_path: Path) -> None:
    spec, _, mutant = case.partition(" ")
    assert _findings((spec, mutant), tmp_path) == found


def test_every_kind_of_mutant_is_recorded() -> None:
    kinds = {_kind(case.partition(" ")[2]) for case in recorded(RECORDED)}
    assert kinds == set(_cases([called(file) for file in SPECS]))


def test_a_scale_a_sign_and_a_byte_are_silent(tmp_path: Path) -> None:
    for mutant, rule in (
        ("types.voltage.scale 1", "scale-changed"),
        ("types.voltage.raw i16", "sign-changed"),
        ("layouts.status_1.fields.voltage.at 4", "field-moved"),
    ):
        found = compare(_original("mwd_motor/v2.35"), _changed("mwd_motor/v2.35", mutant, tmp_path))
        (change,) = (c for c in found if c.rule.id == rule)
        assert change.impact is Impact.SILENT
        assert [side.value for side in change.sides] == ["receiving"]
        assert set(change.used_by) == {"read_status_1", "clear_errors"}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        if sys.argv[1:] == ["all"]:
            for name in map(called, SPECS):
                for one in _mutants(name):
                    print(f"{name} {one}: {_findings((name, one), Path(made))}")
        else:
            _write(Path(made))
