"""Typical problems of the author of a first spec."""

from __future__ import annotations

from pathlib import Path

import cantools
import pytest
from canwright.cli import main
from canwright.diagnostics.diagnostic import Severity, SpecError
from canwright.language.units import read_units
from canwright.project.loader import load, specification
from click.testing import CliRunner

from ..spec_texts import MINIMAL, findings

LEVEL = "{level: {at: 2, type: level}}"
LONG = "a_name_of_more_than_forty_eight_characters_is_too_long"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (LEVEL, "{layout: {level: {at: 2, raw: u8, enum: {low: 0}}}}", "unknown key `enum`"),
        (LEVEL, f"{{layout: {{level: {{at: 2, type: {LONG}}}}}}}", "54 characters exceed the maximum of 48"),
        ("level:", f"{LONG}:", "54 characters exceed the maximum of 48"),
        (LEVEL, "{layout: [2]}", "expected a name or a mapping here, not a list"),
    ],
)
def test_one_mistake_is_one_finding(tmp_path: Path, old: str, new: str, message: str) -> None:
    texts = [d.message for d in findings(tmp_path, MINIMAL.replace(old, new, 1)) if d.rule != "unknown-reference"]
    assert texts == [message]


def test_a_key_of_a_type_in_a_field_has_a_hint(tmp_path: Path) -> None:
    (finding,) = findings(tmp_path, MINIMAL.replace("type: level}", "raw: u8, unit: V}"))
    assert "`type: NAME`" in finding.hint


@pytest.mark.parametrize(
    ("entry", "messages"),
    [
        ("node: 1, id: 0x101", ["neither `raw` nor `values` has `level`"]),
        ("node: 1, id: 0x101, raw: {levle: 7}", ["there is no field `levle`"]),
        ("node: 2, id: 0x101, raw: {level: 7}", ["the id 0x101 belongs to node 1"]),
        ("id: 0x101, raw: {level: 7}", []),
        ("node: 1, raw: {level: 7}", []),
        ("node: 1, values: {level: 0.7}", []),
        ("node: 1, values: {level: 0.8}", ["`level` is 0.7 according to the scale in the spec"]),
        ("node: 9, raw: {level: 7}", ["the address `lamp` has no node 9"]),
        ("node: 1, extended: true, raw: {level: 7}", ["dim_request has an 11-bit id"]),
        ("raw: {level: 7}", ["`node` is missing; the nodes of dim_request are 1..4"]),
        ("node: 1, id: 0x101, raw: {level: 7}", []),
    ],
)
def test_contradictions_of_a_golden_frame(tmp_path: Path, entry: str, messages: list[str]) -> None:
    assert contradictions(tmp_path, MINIMAL, entry) == messages


def test_a_golden_frame_of_a_fixed_id_has_no_node(tmp_path: Path) -> None:
    fixed = MINIMAL.replace("id: 0x100 + node, nodes: 1..4", "id: 0x101")
    assert contradictions(tmp_path, fixed, "node: 1, id: 0x101, raw: {level: 7}") == ["the id 0x101 has no node"]
    assert contradictions(tmp_path, fixed, "id: 0x101, raw: {level: 7}") == []


def contradictions(folder: Path, text: str, entry: str) -> list[str]:
    """Messages about a golden frame of `dim`."""
    (folder / "v1.yaml").write_text(text, "utf-8")
    frames = f'{{request: dim, {entry}, data: "10 00 07 00 00 00 00 00", source: manual}}'
    (folder / "v1.frames.yaml").write_text(
        f"canwright: 1\nfamily: lamp\nedition: v1\nsources: {{manual: M}}\nframes: [{frames}]\n", "utf-8"
    )
    try:
        findings = load(folder / "v1.yaml").warnings
    except SpecError as error:
        findings = error.diagnostics
    return [finding.message for finding in findings if finding.rule in ("frame-contradiction", "missing-key")]


TABLE = """\
tables:
  things:
    index: {at: 1, raw: u8}
    entries:
      level: {index: 1, dlc: 4, layout: {level: {at: 2, type: level}}}
      night: {index: 2, layout: {night: {at: 2, raw: u1}}}
commands:
  read: {code: 1, table: things, reply: REPLY}
  write: {code: 2, table: things, request: {layout: entry, dlc: 3}, reply: {of: done}}
  done: {code: 3, request: none, reply: {layout: status, fields: {spare: {at: 3, raw: u8}}}}
"""


def table(reply: str) -> str:
    text = MINIMAL.partition("commands:")[0] + "layouts:\n  status: {fields: {status: {at: 1, raw: u8}}}\n"
    return text + TABLE.replace("REPLY", reply)


def test_a_layout_in_a_reply_with_further_fields_is_not_unused(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(table("entry"), "utf-8")
    assert [finding.rule for finding in load(tmp_path / "v1.yaml").warnings] == ["missing-frame"]


def test_an_entry_may_have_its_own_length(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(table("entry"), "utf-8")
    commands = {c.name: c for c in specification(tmp_path / "v1.yaml").edition.commands}
    lengths = {name: tuple(m and m.dlc for m in (command.request, command.reply)) for name, command in commands.items()}
    assert lengths == {
        "read_level": (8, 4),
        "read_night": (8, 8),
        "write_level": (4, 8),
        "write_night": (3, 8),
        "done": (None, 8),
    }


def test_a_reply_without_the_index_has_a_hint(tmp_path: Path) -> None:
    diagnostics = findings(tmp_path, table("status"))
    assert {d.rule for d in diagnostics} == {"overlap"}
    assert all("`reply: {of: COMMAND}`" in d.hint for d in diagnostics)
    (tmp_path / "v1.yaml").write_text(table("{of: done}"), "utf-8")
    assert [finding.rule for finding in load(tmp_path / "v1.yaml").warnings] == ["missing-frame"]


def test_a_dbc_has_identical_messages_once(tmp_path: Path) -> None:
    commands = "  one: {request: level, reply: none}\n  other: {request: level, reply: none}\n"
    text = MINIMAL.replace("selector: {at: 0, raw: u8}\n", "").partition("commands:")[0]
    text += "layouts: {level: {fields: {level: {at: 2, type: level}}}}\ncommands:\n" + commands
    (tmp_path / "v1.yaml").write_text(text, "utf-8")
    result = CliRunner().invoke(main, ["generate", "--spec", str(tmp_path / "v1.yaml"), "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    database = cantools.database.load_file(tmp_path / "out/dbc/lamp-v1-command.dbc", strict=True)
    assert isinstance(database, cantools.database.can.Database)
    assert [[signal.name for signal in message.signals] for message in database.messages] == [["c_level"]] * 4
    guide = (tmp_path / "out/dbc/README.md").read_text("utf-8")
    assert "`other` (command)" in guide


def test_show_lists_the_forms_of_a_command_with_a_table(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(table("entry"), "utf-8")
    shown = CliRunner().invoke(main, ["show", "read", "--spec", str(tmp_path / "v1.yaml")])
    assert [line.split()[0] for line in shown.output.split("\n") if "  0x01  " in line] == ["read_level", "read_night"]


def test_every_unit_has_distinct_texts() -> None:
    _, units = read_units()
    assert all(unit.dbc.isascii() and '"' not in unit.dbc for unit in units.values())
    assert all(set(unit.title) == {"en", "zh"} and all(unit.title.values()) for unit in units.values())
    for texts in zip(*((u.dbc, u.symbol, u.title["en"], u.title["zh"]) for u in units.values()), strict=True):
        assert len(set(texts)) == len(units), "two units have the same text"


FRAME = '{request: dim, node: 1, id: 0x101, data: "10 00 64 00 00 00 00 00", raw: {level: 100}, source: manual}'
BLOCK = """dim:
    code: 0x10
    manual: "1"
    request: {level: {at: 2, type: level}}
    reply: echo
"""


@pytest.mark.parametrize(
    ("old", "new", "message", "hint"),
    [
        (BLOCK, f"- {BLOCK}", "this is an item of a list, and `dim` has no value", "mapping without dashes: `dim:`"),
        (
            BLOCK,
            "- dim: {code: 0x10, reply: none}\n",
            "expected a mapping here, not a list",
            "write a mapping without dashes: {dim: {code: 16, reply: none}}",
        ),
        ("0.1", f"0.{'1' * 33}", "this number has 33 decimals", "33/2048"),
        ("type: level}", "type: level, count: 4}", "unknown key `count`", "did you mean `array`?"),
        ("type: level}", "raw: u8, step: 0.5}", "unknown key `step`", "did you mean `scale`? It belongs to a type"),
    ],
)
def test_message_and_hint_of_a_mistake_in_a_spec(tmp_path: Path, old: str, new: str, message: str, hint: str) -> None:
    assert old in MINIMAL
    finding = findings(tmp_path, MINIMAL.replace(old, new, 1))[0]
    assert message in finding.message
    assert hint in finding.hint


@pytest.mark.parametrize(
    ("spec", "frame", "message", "hint"),
    [
        (("", ""), ("64 00", "00 64"), "`level` is 25600 in `data`", "the other byte order gives 100"),
        (
            ("", ""),
            ("level: 100", "level: 10"),
            "`level` is 100 in `data`",
            "10 is its value in %; `raw` is an integer",
        ),
        (("", ""), ("level: 100", "level: 10.5"), "`10.5` is not a whole number", "`values`"),
        (("", ""), ("level: 100", "level: idle"), "`idle` is not a whole number", "`values`"),
        (
            ("", ""),
            ("level: 100}", "level: 100}, values: {level: 100}"),
            "`level` is 10 according to the scale",
            "this is the raw integer; `values` has the value in %",
        ),
        (
            ("scale: 0.1", "scale: 1/3"),
            ("raw: {level: 100}", "values: {level: 33.33}"),
            "`level` is 100/3 according to the scale",
            "if the manual rounds it, write 100/3; otherwise check the value and the type in the spec",
        ),
        (
            ("scale: 0.1", "scale: 1/3"),
            ("raw: {level: 100}", "values: {level: 33.32}"),
            "`level` is 100/3 according to the scale",
            "check the value and the type in the spec",
        ),
        (
            ("id: 0x100 + node, nodes: 1..4", "id: 0x100"),
            ("", ""),
            "the address `lamp` has no node: the id of all its frames is 0x100",
            "remove `node`, or write the id of the address with `node`",
        ),
        (
            ("id: 0x100 + node, nodes: 1..4", "id: 0x101"),
            ("", ""),
            "the id 0x101 has no node",
            "remove `node`, or write the id of the address with `node`",
        ),
        (
            ("commands:\n  dim:\n", "parameters: {size: {values: [A, B]}}\ncommands:\n  dim:\n    only: {size: [A]}\n"),
            ("level: 100}", "level: 100}, parameters: {size: B}"),
            "this frame cannot be encoded: dim is available with size=A, not B",
            "check `only` of the command",
        ),
    ],
)
def test_message_and_hint_of_a_mistake_in_a_golden_frame(
    tmp_path: Path, spec: tuple[str, str], frame: tuple[str, str], message: str, hint: str
) -> None:
    head = "canwright: 1\nfamily: lamp\nedition: v1\nsources: {manual: The manual.}\nframes:\n"
    (tmp_path / "x.yaml").write_text(MINIMAL.replace(*spec), "utf-8")
    (tmp_path / "x.frames.yaml").write_text(f"{head}  - {FRAME.replace(*frame)}\n", "utf-8")
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "x.yaml")
    (finding,) = (d for d in refused.value.diagnostics if d.severity is Severity.ERROR)
    assert message in finding.message
    assert hint in finding.hint
    assert ("rounds" in finding.hint) == ("rounds" in hint)


def test_messages_without_a_golden_frame_are_listed_in_one_warning(tmp_path: Path) -> None:
    commands = "".join(f"  glow_{n}: {{code: {n}, manual: '1', reply: none}}\n" for n in range(5))
    head = "canwright: 1\nfamily: lamp\nedition: v1\nsources: {manual: The manual.}\nframes:\n"
    (tmp_path / "x.yaml").write_text(MINIMAL + commands, "utf-8")
    (tmp_path / "x.frames.yaml").write_text(f"{head}  - {FRAME}\n", "utf-8")
    (warning,) = load(tmp_path / "x.yaml").warnings
    assert warning.message == (
        "6 messages have no golden frame: `dim` (reply), `glow_0` (request), `glow_1` (request) and 3 more"
    )


IN_DATA = MINIMAL.replace("id: 0x100 + node, nodes: 1..4", "id: 0x101").replace(
    "{level: {at: 2, type: level}}", "{lamp: {at: 1, raw: u8, holds: node}, level: {at: 2, type: level}}"
)
"""A spec whose node is a field."""


@pytest.mark.parametrize(
    ("entry", "messages"),
    [
        ("raw: {level: 7}", []),
        ("node: 0, raw: {level: 7}", []),
        ("raw: {lamp: 0, level: 7}", []),
        ("node: 2, raw: {level: 7}", ["`lamp` is 0 in `data`"]),
        ("raw: {lamp: 2, level: 7}", ["`lamp` is 0 in `data`"]),
    ],
)
def test_the_node_of_a_golden_frame_may_be_a_field(tmp_path: Path, entry: str, messages: list[str]) -> None:
    assert contradictions(tmp_path, IN_DATA, entry) == messages


def test_a_node_that_differs_from_the_field_is_corrected(tmp_path: Path) -> None:
    assert contradictions(tmp_path, IN_DATA, "node: 2, raw: {level: 7}")
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "v1.yaml")
    hints = [finding.hint for finding in refused.value.diagnostics if finding.severity is Severity.ERROR]
    assert hints == ["this field contains the node: write `node: 0`, or check `data`"]
