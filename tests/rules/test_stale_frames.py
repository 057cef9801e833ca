"""Golden frames of a copied edition with a changed spec: `check` reports those that contradict the spec."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from canwright.diagnostics.diagnostic import Diagnostic, Severity, SpecError
from canwright.project.loader import frames_file, load

from ..spec_texts import ROOT

LATEST = "spec/mwd_motor/v2.36-2025-03"
FIRST = "spec/mwd_motor/v2.35"
CASES = {
    "a range is wider": (LATEST, "raw_range: -2048..2048", "raw_range: -3000..3000", "iq raw 2049"),
    "a range is narrower": (LATEST, "raw_range: -2048..2048", "raw_range: -2000..2000", "raw 2048 is invalid for `iq`"),
    "a scale is known": (
        LATEST,
        "MS: none, MH: none}",
        "MS: 1, MH: 1}",
        "the request of set_torque",
    ),
    "a name is new": (LATEST, "read: {value: 0x10,", "grip: {value: 2}\n      read: {value: 0x10,", "action raw 2"),
    "fields no longer depend on a parameter": (
        LATEST,
        "      power: {at: 2, type: output_power, only: {series: [MS]}}\n"
        "      iq: {at: 2, type: measured_torque_current, only: {series: [MF, MH, MG]}}\n",
        "      iq: {at: 2, type: measured_torque_current}\n",
        "the spec accepts this frame: the reply of set_speed, node 1: temperature 50 °C, iq raw 100",
    ),
    "a code is another": (
        LATEST,
        "code: 0xA1\n",
        "code: 0xAF\n",
        "the request is rejected: no request on 0x141 has DATA[0] 0xA1",
    ),
    "a code is taken": (
        LATEST,
        "code: 0xA1\n",
        "code: 0x12\n",
        "the spec accepts this frame: the request of set_torque",
    ),
    "an echo is a reply of its own": (
        LATEST,
        "manual_name: 电机关闭命令\n    reply: echo",
        "manual_name: 电机关闭命令\n    reply: {state: {at: 7, raw: u8}}",
        "this is the reply: the reply of motor_off, node 1",
    ),
    "a reply is an echo": (
        LATEST,
        "    reply: {state: {at: 1, type: brake_state, variable: brake}}",
        "    reply: echo",
        "the reply of brake is an echo",
    ),
    "there are more nodes": (
        LATEST,
        "nodes: 1..32",
        "nodes: 0..33",
        "the spec accepts this frame: the request of motor_off, node 33",
    ),
    "there are fewer nodes": (
        LATEST,
        "nodes: 1..32",
        "nodes: 1..31",
        "the request is rejected: no request has the id 0x160",
    ),
    "replies come elsewhere": (
        LATEST,
        "reply: 0x180 + node",
        "reply: 0x140 + node",
        "0x181 is not an id of motor_off_reply",
    ),
    "an entry has another index": (
        LATEST,
        "index: 0x0A\n",
        "index: 0x0E\n",
        "no request on 0x143 has DATA[0] 0xC0 and DATA[1] 0x0A",
    ),
    "a command has another name": (
        LATEST,
        "\n  set_torque:\n",
        "\n  set_torques:\n",
        "there is no command `set_torque`",
    ),
    "a field has another name": (LATEST, "request: {iq: {at: 4", "request: {iqs: {at: 4", "there is no field `iq`"),
    "a constant is gone": (
        LATEST,
        "      key: {at: 2, raw: u8, constant: 0xFA, title: {en: Fixed byte, zh: 固定值}}\n",
        "",
        "the spec accepts this frame: the request of save_stored_settings",
    ),
    "fewer nodes reply to all": (
        FIRST,
        "from_each: 1..4",
        "from_each: 1..3",
        "this is not the reply: it comes from node 4, not 1..3",
    ),
    "a first byte is no longer accepted": (
        FIRST,
        "accept: [0x9B]",
        "accept: []",
        "this is not the reply: DATA[0] is 0x9B, but clear_errors_reply has 0x9A",
    ),
    "no field says who replies": (
        "tests/specs/joint/v1",
        "joint: {at: 0.3, raw: u4, holds: node,",
        "joint: {at: 0.3, raw: u4,",
        "this is the reply: the reply of control",
    ),
}


def changed(folder: Path, edition: str, old: str, new: str) -> tuple[Diagnostic, ...]:
    """What is found in an edition with its golden frames when its spec says something else in one place."""
    file = folder / "changed.yaml"
    shutil.copy(frames_file(ROOT / f"{edition}.yaml"), frames_file(file))
    text = (ROOT / f"{edition}.yaml").read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), "utf-8")
    with pytest.raises(SpecError) as rejected:
        load(file)
    return rejected.value.diagnostics


@pytest.mark.parametrize("name", CASES)
def test_stale_golden_frames_are_reported(name: str, tmp_path: Path) -> None:
    edition, old, new, says = CASES[name]
    rejected = changed(tmp_path, edition, old, new)
    rules = {d.rule for d in rejected if d.severity is Severity.ERROR}
    assert rules <= {"frame-contradiction", "refused-contradiction", "exchange-contradiction"}
    assert any(says in d.message for d in rejected)


def test_a_fixed_id_takes_precedence_over_an_id_with_a_code(tmp_path: Path) -> None:
    """With one node more, its id without a code is that of the broadcast, which stays what it is."""
    rejected = changed(tmp_path, "tests/specs/blower/v1", "nodes: 0..62", "nodes: 0..63")
    assert {d.rule for d in rejected} == {"refused-contradiction"}
