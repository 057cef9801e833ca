"""Every small change of a spec is found by a comparison, named, and put into the right category."""

from __future__ import annotations

import copy
import functools
import re
from dataclasses import asdict
from pathlib import Path

import pytest
import yaml
from canwright.compare import Category, Change, Impact, compare
from canwright.diagnostics.diagnostic import SpecError
from canwright.model.edition import Edition
from canwright.project.loader import described

from ..conformance.mutants import mutants
from ..spec_texts import SPECS, called

MOST = 40
"""So many mutants of one spec are tried, evenly spread over it, for the sake of time."""

ORIGINALS = {called(spec): described(spec).edition for spec in SPECS}
DATA = {called(spec): yaml.load(spec.read_text("utf-8"), yaml.CSafeLoader) for spec in SPECS}
MUTANTS = {name: dict(mutants(data)) for name, data in DATA.items()}
_VALUE = re.compile(r"types\.\w+\.(scale|offset|range|raw_range|enum|flags)\b")


def _spread(names: list[str]) -> list[str]:
    return [names[int(i * max(1.0, len(names) / MOST))] for i in range(min(MOST, len(names)))]


def _changed(spec: str, mutant: str, folder: Path) -> Edition | None:
    """The changed edition; None when it is refused, or when the change says the same in other words."""
    data = copy.deepcopy(DATA[spec])
    MUTANTS[spec][mutant](data)
    for erratum in data.get("errata", ()):
        erratum["where"] = ["commands"]
    file = folder / "changed.yaml"
    file.write_text(yaml.dump(data, Dumper=yaml.CSafeDumper, allow_unicode=True, sort_keys=False), "utf-8")
    try:
        edition = described(file).edition
    except SpecError:
        return None
    return None if _meaning(edition) == _original(spec) else edition


@functools.cache
def _original(spec: str) -> dict[str, object]:
    return _meaning(ORIGINALS[spec])


def _meaning(edition: Edition) -> dict[str, object]:
    """What an edition says, but for where and how it is written, and for its errata, which a mutant lacks."""

    def facts(pairs: list[tuple[str, object]]) -> dict[str, object]:
        return {name: value for name, value in pairs if name not in ("hash", "errata", "path", "printed")}

    return asdict(edition, dict_factory=facts)


def _about(found: tuple[Change, ...]) -> list[Change]:
    return [change for change in found if change.rule.category not in (Category.API, Category.DOC)]


@pytest.mark.parametrize(
    ("spec", "mutant"), [(spec, mutant) for spec, found in MUTANTS.items() for mutant in _spread(list(found))]
)
def test_a_change_is_found_and_named(spec: str, mutant: str, tmp_path: Path) -> None:
    edition = _changed(spec, mutant, tmp_path)
    if edition is None:
        return
    found = _about(compare(ORIGINALS[spec], edition))
    category = Category.VALUE if _VALUE.match(mutant) else Category.WIRE
    assert category in {change.rule.category for change in found}, mutant
    last = re.sub(r" .*", "", mutant).split(".")
    named = {part for part in last if part in {c.item.name.split(".")[-1] for c in found} or part in str(found)}
    assert named, mutant


def test_a_scale_a_sign_and_a_byte_are_silent(tmp_path: Path) -> None:
    for mutant, rule in (
        ("types.voltage.scale 1", "scale-changed"),
        ("types.voltage.raw i16", "sign-changed"),
        ("layouts.status_1.fields.voltage.at 4", "field-moved"),
    ):
        edition = _changed("mwd_motor/v2.35", mutant, tmp_path)
        assert edition is not None
        (change,) = (c for c in compare(ORIGINALS["mwd_motor/v2.35"], edition) if c.rule.id == rule)
        assert change.impact is Impact.SILENT
        assert [side.value for side in change.sides] == ["receiving"]
        assert set(change.used_by) == {"read_status_1", "clear_errors"}
