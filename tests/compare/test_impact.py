"""Each change is reported once, for the item that it belongs to, with its impact and the sides that it affects."""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path

import pytest
from canwright.compare import compare
from canwright.model.edition import Edition

from ..spec_texts import ROOT, edition

V2_35 = (ROOT / "spec/mwd_motor/v2.35.yaml").read_text("utf-8")
V2_36 = (ROOT / "spec/mwd_motor/v2.36-2025-03.yaml").read_text("utf-8")
ID = "    id: 0x140 + node\n"
OFF = "    code: 0x80\n    manual: "
ON = "    code: 0x88\n    manual: "


@functools.cache
def _original(text: str) -> Edition:
    with tempfile.TemporaryDirectory() as folder:
        return edition(Path(folder), text)


def impacts(folder: Path, text: str, *changes: tuple[str, str]) -> list[str]:
    changed = text
    for old, new in changes:
        assert old in changed, old
        changed = changed.replace(old, new)
    return [
        f"{c.impact.value} {'+'.join(s.value for s in c.sides) or 'none'}: {c.item}: {c.rule.id}"
        for c in compare(_original(text), edition(folder, changed))
    ]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([(ID, ID.replace("0x140", "0x400"))], ["loud sending+receiving: address motor: id-changed"]),
        ([(ID, ID.replace("0x140", "0x148"))], ["silent sending+receiving: address motor: id-changed"]),
        ([(ID, f"{ID}    extended: true\n")], ["loud sending+receiving: address motor: id-changed"]),
        ([("nodes: 1..32", "nodes: 1..33")], ["loud receiving: address motor: nodes-changed"]),
        ([("nodes: 1..32", "nodes: 1..31")], ["loud sending: address motor: nodes-changed"]),
        (
            [(OFF, "    code: 0xFF\n    manual: "), (ON, OFF), ("    code: 0xFF\n    manual: ", ON)],
            [
                "silent sending+receiving: command motor_off: code-taken",
                "silent sending+receiving: command motor_on: code-taken",
            ],
        ),
        (
            [("电机关闭命令\n    reply: echo", "电机关闭命令\n    reply: motion_feedback")],
            ["loud receiving: command motor_off: reply-form-changed"],
        ),
        ([("clears_turns", "forgets_turns")], ["build sending+receiving: effect clears_turns: effect-renamed"]),
        ([("max_angle", "top_angle")], ["build sending+receiving: setting max_angle: setting-renamed"]),
        (
            [("\n  series:", "\n  model:"), ("by: series", "by: model"), ("only: {series", "only: {model")],
            ["build sending+receiving: parameter series: parameter-renamed"],
        ),
        (
            [("by: series, MF", "by: series, XF"), (" MF:", " XF:"), ("[MF,", "[XF,")],
            ["build sending+receiving: parameter series: parameter-value-renamed"],
        ),
        (
            [("by: series, MF: 16.5/2048", "by: series, XF: 17.5/2048"), (" MF:", " XF:"), ("[MF,", "[XF,")],
            [
                "build sending+receiving: parameter series: parameter-value-renamed",
                "silent sending+receiving: type torque_current: scale-changed",
            ],
        ),
    ],
)
def test_impacts_of_ids_codes_and_names(changes: list[tuple[str, str]], says: list[str], tmp_path: Path) -> None:
    assert impacts(tmp_path, V2_35, *changes) == says


def test_impacts_of_renamed_and_moved_tables(tmp_path: Path) -> None:
    renamed = [(f"{before}stored_settings", f"{before}kept_settings") for before in ("\n  ", "table: ", "tables.")]
    of_table = ("torque_limit_names", "tool_settings", "max_angle_and_limits", "read_index_of_gains")
    assert impacts(tmp_path, V2_36, *renamed) == [
        *(f"safe none: erratum {erratum}: erratum-moved" for erratum in of_table),
        "build sending: table stored_settings: table-renamed",
    ]
    index = "  control_parameters:\n    index: {at: 1, raw: u8}\n"
    assert impacts(tmp_path, V2_36, (index, index.replace("at: 1, raw: u8", "at: 1.1, raw: u7"))) == [
        "loud sending+receiving: table control_parameters: index-moved"
    ]


def test_impacts_of_reserved_bits(tmp_path: Path) -> None:
    """Receivers ignore them, until they are a constant with another value than the one that is sent."""
    cells = (ROOT / "tests/specs/cells/v1.yaml").read_text("utf-8")
    safe = ["safe none: command balance: constant-changed"]
    reply = "padding: {at: 1, raw: i16, reserved: -2}"
    assert impacts(tmp_path, cells, (reply, reply.replace("-2", "-1"))) == safe
    assert impacts(tmp_path, cells, (reply, reply.replace("reserved", "constant"))) == safe
    request = "priority: {at: id.26, raw: u3, reserved: 6}"
    assert impacts(tmp_path, cells, (request, request.replace("6}", "3}"))) == safe
    assert impacts(tmp_path, cells, (request, request.replace("reserved: 6", "constant: 6"))) == safe
    loud = ["loud sending: command balance: constant-changed"]
    assert impacts(tmp_path, cells, (request, request.replace("reserved: 6", "constant: 3"))) == loud


@pytest.mark.parametrize("name", ["mark", "code", "index"])
def test_impacts_of_constants_without_a_selector(tmp_path: Path, name: str) -> None:
    """A constant is no code and no index, whatever its name: only the constant of the request has changed."""
    text = (
        "canwright: 1\nfamily: lamp\nedition: v1\naddresses: {lamp: {id: 0x100 + node, nodes: 1..4}}\ncommands:\n"
        f"  dim: {{request: {{{name}: {{at: 0, raw: u8, constant: 5}}, level: {{at: 1, raw: u8}}}}, reply: none}}\n"
        f"  stop: {{request: {{{name}: {{at: 0, raw: u8, constant: 7}}}}, reply: none}}\n"
    )
    constant = ["loud sending: command dim: constant-changed"]
    assert impacts(tmp_path, text, ("constant: 5", "constant: 6")) == constant
    moved = ("{at: 0, raw: u8, constant", "{at: 2, raw: u8, constant")
    assert impacts(tmp_path, text, moved) == [
        f"loud sending: command {command}: field-moved" for command in ("dim", "stop")
    ]


def test_impacts_of_a_constant_that_distinguishes_messages(tmp_path: Path) -> None:
    """Such a constant is a key and no field of the layout; its name and its removal are changes all the same."""
    joint = (ROOT / "tests/specs/joint/v1.yaml").read_text("utf-8")
    zero = "zero: {at: 1, raw: u8, constant: 0}, "
    assert impacts(tmp_path, joint, (zero, "")) == ["safe none: command read_word: field-removed"]
    without = joint.replace(zero, "")
    added = ("holds: node}, word", f"holds: node}}, {zero}word")
    assert impacts(tmp_path, without, added) == ["safe none: command read_word: field-added"]
    renamed = ["build receiving: command read_word: field-renamed"]
    assert impacts(tmp_path, joint, (zero, zero.replace("zero", "nought"))) == renamed
    changed = ["silent receiving: command read_word: constant-changed"]
    assert impacts(tmp_path, joint, (zero, zero.replace("constant: 0", "constant: 9"))) == changed
