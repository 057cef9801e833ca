"""The hash of a spec: that of its meaning. Comments, the order of keys and white space change no generated file."""

from __future__ import annotations

import dataclasses
import difflib
import functools
import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.model import (
    checksum,
    deprecation,
    edition as edition_module,
    joined,
    layout,
    message,
    metadata,
    sending,
    types,
)
from canwright.model.meaning import NOT_MEANING, meaning_hash
from canwright.project.loader import frames_file, specification
from canwright.project.pipeline import generate
from canwright.targets.registry import default_targets

from ..compare.test_every_key import CHANGES, edition_with
from ..spec_texts import MEANT_ORDER, NAMED, ROOT, SPECS, called, reversed_keys

HOIST = """\
canwright: 1
family: hoist
edition: v1
title: Hoists
addresses:
  hoist: {id: 0x100 + node, nodes: 1..4}
selector: {at: 0, raw: u8}
types:
  level: {raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}
  mode: {raw: u8, enum: {slow: 0, fast: 1}}
commands:
  lift:
    code: 0x10
    title: Lifting
    request:
      level: {at: 2, type: level, title: Height}
      mode: {at: 4, type: mode}
    reply: echo
  read_level: {code: 0x11, reply: {code: 0x12, accept: [0x13], fields: {level: {at: 2, type: level}}}}
"""
MAIN = ROOT / "spec" / "mwd_motor" / "v2.36-2025-03.yaml"


def files(folder: Path, text: str, beside: Path | None = None) -> Mapping[str, str]:
    """Every generated file of every target for a spec, with the golden frames of another spec."""
    spec = folder / "spec.yaml"
    spec.write_text(text, "utf-8")
    if beside is not None:
        frames_file(spec).write_bytes(frames_file(beside).read_bytes())
    outputs = generate([specification(spec)], default_targets(), {}).files
    return {path: content.decode("utf-8", "replace") for path, content in outputs.items()}


def changed_lines(before: Mapping[str, str], after: Mapping[str, str]) -> list[str]:
    """The lines that differ, each with its file."""
    assert list(before) == list(after)
    return [
        f"{path}: {line[1:]}"
        for path in before
        for line in difflib.unified_diff(before[path].split("\n"), after[path].split("\n"), lineterm="", n=0)
        if re.match(r"[-+](?![-+]{2} )", line)
    ]


def with_comments(text: str) -> str:
    return f"# A remark\n\n{text.replace(chr(10), chr(10) * 2)}\n# Another remark\n"


@pytest.mark.parametrize(
    "change", [with_comments, functools.partial(reversed_keys, kept=NAMED)], ids=["comment", "keys"]
)
@pytest.mark.parametrize("spec", [None, MAIN], ids=["hoist", "main"])
def test_no_generated_file_depends_on_how_a_spec_is_written(
    spec: Path | None, change: Callable[[str], str], tmp_path: Path
) -> None:
    text = HOIST if spec is None else spec.read_text("utf-8")
    changed = change(text)
    assert changed != text
    assert changed_lines(files(tmp_path, text, spec), files(tmp_path, changed, spec)) == []


@pytest.mark.parametrize(
    ("spec", "title"), [(None, "Hoists"), (None, "Lifting"), (None, "Height"), (MAIN, "Motor series")]
)
def test_a_title_changes_only_the_lines_that_contain_it(spec: Path | None, title: str, tmp_path: Path) -> None:
    text = HOIST if spec is None else spec.read_text("utf-8")
    new = title.replace("i", "o")
    assert title in text
    lines = changed_lines(files(tmp_path, text, spec), files(tmp_path, text.replace(title, new), spec))
    assert lines
    assert [line for line in lines if title.lower() not in line.lower() and new.lower() not in line.lower()] == []


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_order_of_names_is_no_meaning(spec: Path, tmp_path: Path) -> None:
    (tmp_path / "spec.yaml").write_text(reversed_keys(spec.read_text("utf-8"), MEANT_ORDER), "utf-8")
    assert specification(tmp_path / "spec.yaml").edition.hash == specification(spec).edition.hash


HASHES = {
    "c": r'_SPEC_HASH +"(\w+)"',
    "python": r'^SPEC_HASH = "(\w+)"',
    "dbc": r'^VERSION "v1 (\w+)"',
    "docs": r"spec `(\w+)`|描述 `(\w+)`",
    "javascript": r'^ +hash: "(\w+)"',
    "wireshark": r'^ +hash = "(\w+)"',
    "columns": r'spec_hash="(\w+)"',
}
"""The place of the hash in the output of each target."""
MEANINGS = {
    "scale": ("scale: 0.1", "scale: 0.2"),
    "range": ("0..1000", "0..999"),
    "name": ("read_level", "get_level"),
    "name of a value": ("slow: 0", "low: 0"),
    "code": ("code: 0x11", "code: 0x14"),
    "accepted code": ("accept: [0x13]", "accept: [0x13, 0x14]"),
    "unit": ('unit: "%"', "unit: A"),
    "nodes": ("nodes: 1..4", "nodes: 1..5"),
}


def hashes(outputs: Mapping[str, str]) -> dict[str, set[str]]:
    """The starts of the hashes that stand in the output of each target."""
    return {
        target: {
            next(filter(None, place.groups()))[:12]
            for path, text in outputs.items()
            if path.startswith(f"{target}/")
            for place in re.finditer(pattern, text, re.M)
        }
        for target, pattern in HASHES.items()
    }


@pytest.mark.parametrize("old, new", MEANINGS.values(), ids=MEANINGS)
def test_another_meaning_has_another_hash_in_each_target(old: str, new: str, tmp_path: Path) -> None:
    assert old in HOIST
    before, after = (files(tmp_path, text) for text in (HOIST, HOIST.replace(old, new)))
    (first,), (second,) = (set().union(*hashes(outputs).values()) for outputs in (before, after))
    assert first != second
    assert hashes(before) == {target: {first} for target in default_targets()}


def test_no_first_line_has_a_hash(tmp_path: Path) -> None:
    (tmp_path / "spec.yaml").write_text(HOIST, "utf-8")
    start = specification(tmp_path / "spec.yaml").edition.hash[:8]
    outputs = {path: text for path, text in files(tmp_path, HOIST).items() if not path.endswith(".dbc")}
    assert any("hoist v1. Generated by canwright, do not edit." in text for text in outputs.values())
    assert [path for path, text in outputs.items() if start in "".join(text.split("\n")[:3])] == []


_TITLED = frozenset(
    (
        *("Address", "Command", "Edition", "Effect", "Entry", "Field", "Layout", "Member", "Mode", "NoValue"),
        *("Neighbour", "Parameter", "ParameterValue", "Setting", "State", "Table", "Type"),
    )
)
LEFT_OUT = {
    "title": _TITLED | {"Unit"},
    "about": _TITLED,
    "notes": {"Command"},
    "differs": {"Type"},
    "manual": {"Address", "Bus", "Command", "Edition", "Entry", "Erratum", "Field", "Layout", "Table"},
    "manual_name": {"Command", "Field"},
    "printed": {"Erratum", "Linear"},
    "errata": {"Edition"},
    "languages": {"Edition"},
    "date": {"Edition"},
    "deprecated": {"Command", "Field", "Member", "NoValue"},
    "renamed_from": {"Entry", "Field", "Member", "NoValue"},
    "previous_name": {"Command"},
    "neighbours": {"Bus"},
    "path": {"Address", "Command", "Entry", "Field", "Key", "Layout", "Message", "Table", "Type"},
}
"""The attributes of the model that are no meaning, with their classes."""
TEXT_KEYS = frozenset(
    (
        *("title", "about", "notes", "differs", "manual", "manual_name", "languages", "errata"),
        *("id", "where", "printed", "used", "why"),  # of an erratum
        *("deprecated", "since", "until"),
    )
)
"""Keys of the language whose change leaves the hash."""


def test_every_key_is_meaning_except_texts(tmp_path: Path) -> None:
    unchanged = edition_with(tmp_path, {}).hash
    same = {key for key, changes in CHANGES.items() if edition_with(tmp_path, changes).hash == unchanged}
    texts = {key for key in CHANGES if key.partition(".")[2] in TEXT_KEYS} - {"AddressSpec.id"}
    assert same == texts | {"BusSpec.neighbours", "NeighbourSpec.ids"}


def test_what_is_left_out_of_the_model() -> None:
    modules = (checksum, deprecation, edition_module, joined, layout, message, metadata, sending, types)
    classes = {c for m in modules for c in vars(m).values() if isinstance(c, type) and dataclasses.is_dataclass(c)}
    left_out: dict[str, set[str]] = {}
    for c in classes:
        for field in dataclasses.fields(c):
            if field.name in NOT_MEANING:
                left_out.setdefault(field.name, set()).add(c.__name__)
    assert left_out == LEFT_OUT


def test_a_number_of_the_meaning_is_exact() -> None:
    third = types.Linear(Fraction(1, 3), Fraction(0), printed="1/3")
    rounded = types.Linear(Fraction(333333333333333, 10**15), Fraction(0), printed="1/3")
    again = types.Linear(Fraction(2, 6), Fraction(0), printed="2/6")
    assert meaning_hash(third) == meaning_hash(again) != meaning_hash(rounded)


def test_a_value_without_a_canonical_form_is_reported() -> None:
    with pytest.raises(TypeError, match="no canonical form of float"):
        meaning_hash(types.ParameterValue(name="a", number=1.5, title={}, about={}))  # type: ignore[arg-type]
