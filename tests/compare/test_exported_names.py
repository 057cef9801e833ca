"""Names that targets export: changes without a change of bits are found, and one edit gives one finding."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from canwright import DocumentPath, Edition
from canwright.compare import compare
from canwright.targets.base import EditionInput
from canwright.targets.dbc.target import DbcTarget
from canwright.targets.registry import targets

from ..spec_texts import edition

SPEC = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
parameters: {size: {values: {small: {title: Small}, big: {title: Big}}}}
types:
  level: {raw: u16, unit: "%", scale: 0.1, names: {full: {value: 1000, title: Full}}}
  glare: {raw: u8, raw_range: {by: size, small: 0..9, big: 0..99}}
  faults: {raw: u8, flags: {hot: {bit: 0, title: Hot}}}
  state: {raw: u8, enum: {idle: {value: 0, title: Idle}}}
  spare: {raw: u8, enum: {up: 1}}
layouts:
  light: {fields: {level: {at: 2, type: level}}}
commands:
  dim: {short_name: dm, code: 0x10, request: light, reply: echo}
  read: {code: 0x11, reply: {faults: {at: 1, type: faults}, state: {at: 2, type: state}}}
  glow: {code: 0x12, request: light, reply: none}
  blind: {code: 0x20, request: {glare: {at: 2, type: glare}}, reply: none}
"""
INLINE = {"request: light, reply: none": "request: {level: {at: 2, type: level}}, reply: none"}
EDITS: list[tuple[str, dict[str, str], list[str]]] = [
    ("member-renamed", {"{hot:": "{warm:"}, ["…_FAULTS_WARM", "r11_faults_warm", "Python `HOT` → `WARM`"]),
    ("member-renamed", {"{idle:": "{rest:"}, ["…_STATE_REST", "DBC `idle` → `rest`", "Python `IDLE` → `REST`"]),
    ("member-renamed", {"{full:": "{most:"}, ["`…_LEVEL_FULL` → `…_LEVEL_MOST`"]),
    ("type-renamed", {"level:": "share:", "type: level": "type: share", "{share: {at": "{level: {at"}, ["…_share_to_milli` (+"]),
    ("layout-of-command-changed", INLINE, ["…_light_t` → `…_glow_request_t", "`Light` → `GlowRequest`"]),
    ("layout-renamed", {"light": "lamp_light"}, ["`…_light_t` → `…_lamp_light_t`", "Python `Light` → `LampLight`"]),
    ("short-name-changed", {"short_name: dm": "short_name: dx"}, ["C `…_COMMAND_DM` → `…_COMMAND_DX` (+1)"]),
    ("parameter-value-renamed", {"{small: {title": "{little: {title", "small: 0": "little: 0"}, ["`…_SIZE_SMALL` → `…_SIZE_LITTLE`"]),
    ("names-changed", {"  spare: {raw: u8, enum: {up: 1}}\n": ""}, ["Python `Spare`, `UP`"]),
]  # fmt: skip


class FirstLetters:
    """A target of another package, with a name that depends on another item."""

    title = "Letters"

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        number = len(edition.commands)
        yield from ((layout.path, f"{layout.name[0]}{number}") for layout in edition.layouts)


def _replaced(text: str, edits: dict[str, str]) -> str:
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(("rule", "edits", "says"), EDITS)
def test_one_edit_gives_one_finding_with_the_names(
    tmp_path: Path, rule: str, edits: dict[str, str], says: list[str]
) -> None:
    old, new = edition(tmp_path, SPEC), edition(tmp_path, _replaced(SPEC, edits))
    (change,) = compare(old, new, targets())
    assert change.rule.id == rule
    for part in says:
        assert part in change.says()


@pytest.mark.parametrize(
    ("rule", "old", "new"),
    [
        ("command-added", "", "  more: {code: 0x13, reply: {level: {at: 1, raw: u32}}}\n"),
        (
            "field-added",
            "  scan: {code: 0x13, request: {level: {at: 2, type: level}}, reply: {a: {at: 1, raw: u8}}}\n",
            "  scan: {code: 0x13, request: {level: {at: 2, type: level}}, reply: {a: {at: 1, raw: u8}, level: {at: 2, raw: u32}}}\n",
        ),
    ],
)
def test_functions_get_another_name_because_of_a_field(tmp_path: Path, rule: str, old: str, new: str) -> None:
    """C adds the raw format to the functions of a type if a field of another type has its name."""
    changes = compare(edition(tmp_path, SPEC + old), edition(tmp_path, SPEC + new), targets())
    by_rule = {change.rule.id: change for change in changes}
    assert set(by_rule) == {rule, "names-changed"}
    assert str(by_rule["names-changed"].item) == "type level"
    assert "`…_level_to_milli` → `…_level_u16_to_milli`" in by_rule["names-changed"].says()


def test_removals_explain_their_names(tmp_path: Path) -> None:
    old = edition(tmp_path, SPEC)
    command = "  read: {code: 0x11, reply: {faults: {at: 1, type: faults}, state: {at: 2, type: state}}}\n"
    types = (
        "  faults: {raw: u8, flags: {hot: {bit: 0, title: Hot}}}\n",
        "  state: {raw: u8, enum: {idle: {value: 0, title: Idle}}}\n",
    )
    new = edition(tmp_path, _replaced(SPEC, dict.fromkeys((command, *types), "")))
    assert [change.rule.id for change in compare(old, new, targets())] == ["command-removed"]


def test_long_names_of_dbc_are_those_of_its_files(tmp_path: Path) -> None:
    """A longer name ends in a hash of it, here the first digits of `sha256sum`."""
    state, name = "state: {at: 2, type: state}", "failure_cell_overvoltage_warning_index_0"
    text = _replaced(SPEC, {state: f"{state}, {name}1: {{at: 5, raw: u8}}, {name}2: {{at: 6, raw: u8}}"})
    old, new = edition(tmp_path, text), edition(tmp_path, _replaced(text, {f"{name}1": f"{name}0"}))
    dbc = DbcTarget()
    (change,) = compare(old, new, [dbc])
    assert change.rule.id == "field-renamed"
    assert "DBC `r11_failure_cell_overvolt_650d35` → `r11_failure_cell_overvolt_c3b5c1`" in change.says()
    outputs = dbc.generate([EditionInput(old, None)], {})
    signals = {signal for output in outputs for signal in re.findall(r" SG_ (\w+)", output.text)}
    assert signals.issuperset(name for path, name in dbc.exported_names(old) if "fields" in path)


def test_targets_of_other_packages(tmp_path: Path) -> None:
    old, new = edition(tmp_path, SPEC), edition(tmp_path, f"{SPEC}  more: {{code: 0x13, reply: none}}\n")
    by_rule = {change.rule.id: change for change in compare(old, new, [FirstLetters()])}
    assert by_rule["names-changed"].says() == "names in the bindings disappear: Letters `l4` → `l5`"
