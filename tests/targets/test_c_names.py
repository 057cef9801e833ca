"""Names in C: every one that is emitted is known beforehand, and two things never share one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import all_loaded, specification
from canwright.targets.c.names import defined
from canwright.targets.c.target import CTarget

from ..spec_texts import MINIMAL, findings
from .test_c_compiles import SPECS

MACRO = re.compile(r"^#define (\w+)", re.M)
TYPE = re.compile(r"^(?:\}|typedef \w+) (\w+);", re.M)
ENUMERATOR = re.compile(r"^    ([A-Z]\w*)(?: = \d+)?,?$", re.M)
FUNCTION = re.compile(r"^static inline [\w *]*?\*?(\w+)\(", re.M)


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_every_name_is_known_beforehand(spec: Path) -> None:
    edition_input = specification(spec)
    known = {name for name, _, _ in defined(edition_input.edition)}
    for output in CTarget().generate([edition_input], {}):
        if output.path.startswith("include/") and output.path.endswith(".h") and "canwright" not in output.path:
            emitted = {pattern: set(pattern.findall(output.text)) for pattern in (MACRO, TYPE, ENUMERATOR, FUNCTION)}
            assert all(emitted.values()) or output.path.endswith(("_float.h", "_print.h", "_selftest.h"))
            for names in emitted.values():
                assert names <= known, sorted(names - known)


CLASHES = {
    "two fields": (
        "request: {level: {at: 2, type: level}}",
        "request: {default: {at: 2, type: level}, default_: {at: 4, type: level}}",
        ["the field `default_` and the field `default` would both be `default_` in C"],
    ),
    "a shared layout and a request": (
        "commands:",
        "layouts: {dim_request: {fields: {level: {at: 2, type: level}}}}\ncommands:\n"
        "  show: {code: 0x11, reply: dim_request}",
        ["the request of `dim` and the shared layout `dim_request` would both be `lamp_v1_dim_request_t` in C"],
    ),
    "values of a parameter": (
        "types:",
        "parameters: {size: {values: {big: {}, BIG: {}}}}\ntypes:",
        ["the value `BIG` of `size` and the value `big` of `size` would both be `LAMP_V1_SIZE_BIG` in C"],
    ),
    "a type and what every edition has": (
        "types:",
        "types:\n  command: {raw: u8, enum: {dim: {value: 1}}}",
        [
            "the type `command` and a name in every edition would both be `lamp_v1_command_name` in C",
            "the command `dim` and the type `command` would both be `LAMP_V1_COMMAND_DIM` in C",
        ],
    ),
}


@pytest.mark.parametrize(("old", "new", "wanted"), CLASHES.values(), ids=CLASHES)
def test_clashes_within_an_edition(old: str, new: str, wanted: list[str], tmp_path: Path) -> None:
    diagnostics = findings(tmp_path, MINIMAL.replace(old, new))
    assert [d.message for d in diagnostics if d.rule == "name-collision" and " in C" in d.message] == wanted


def test_names_that_differ_too_late(tmp_path: Path) -> None:
    """`short_name` is the remedy that changes C alone."""
    long = "x" * 48
    diagnostics = [d for d in findings(tmp_path, MINIMAL.replace("dim:", f"{long}:")) if " in C" in d.message]
    hint = "use a shorter name, or `short_name` for a command"
    assert [(d.rule, d.message, d.hint) for d in diagnostics] == [
        (
            "name-collision",
            f"the first 63 characters of `lamp_v1_{long}_{name}` in C (the {direction} of `{long}`) are those of "
            f"`lamp_v1_{long}_{another}`",
            hint,
        )
        for direction, name, another in (
            ("request", "request_encode", "request_t"),
            ("reply", "reply_encode", "reply_t"),
        )
    ]
    text = MINIMAL.replace("dim:", f"{long}:\n    short_name: {long[:45]}")
    assert not [d for d in findings(tmp_path, text) if " in C" in d.message]


def test_clashes_between_editions(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text(MINIMAL.replace("dim:", "a_dim:"), "utf-8")
    (tmp_path / "other.yaml").write_text(MINIMAL.replace("edition: v1", "edition: v1-a"), "utf-8")
    with pytest.raises(SpecError) as refused:
        all_loaded([tmp_path / "one.yaml", tmp_path / "other.yaml"])
    (finding,) = refused.value.diagnostics
    assert finding.position.file.endswith("other.yaml")
    assert (finding.rule, finding.position.line) == ("name-collision", 3)
    assert re.fullmatch(r"lamp v1 would also have `(lamp_v1_a_dim|LAMP_V1_A_DIM)\w*` in C", finding.message)
