"""What people get wrong in a spec, and what they are told: where it is, what it is, and what they probably meant."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import pytest
from canwright.language import aliases
from canwright.project.loader import specification

from ..spec_texts import MINIMAL, findings

LEVEL = "{level: {at: 2, type: level}}"

WRONG = [
    ("code: 0x10", "code: 1F", "10:11 `1F` is not a whole number", "did you mean 0x1F?"),
    ("code: 0x10", 'code: "0x10"', "10:11 `0x10` is not a whole number", "write 0x10 without quotes"),
    ("code: 0x10", "code: 10h", "10:11 `10h` is not a whole number", "did you mean 0x10?"),
    ("code: 0x10", "code: ten", "10:11 `ten` is not a whole number", "a whole number is written like 16 or 0x10"),
    (
        "code: 0x10",
        "code: 0x" + "F" * 20,
        "10:11 this number has 22 characters",
        "a whole number has at most 31 digits",
    ),
    ("nodes: 1..4", "nodes: 4", "4:45 `4` is not a range", ""),
    ("nodes: 1..4", "nodes: 1-4", "4:45 `1-4` is not a range of whole numbers; write it as 1..4", ""),
    ("nodes: 1..4", "nodes: [1, 2]", "4:45 expected a number or a short text here, like 1..32", ""),
    ("id: 0x100 + node", "id: node << 5 | 16", "4:24 `node << 5 | 16` does not belong in an id", ""),
    (
        "0x100 + node",
        "0x100",
        "4:31 there are nodes, but no id depends on `node`",
        "write the id with `node`, like 0x100",
    ),
    ("id: 0x100", "reply: 0x200 + node, id: 0x100", "4:41 `id` is that of both directions", "keep `id`, or"),
    ("id: 0x100", "request: 0x100", "4:13 `lamp` says nothing of the id of replies", "write `id`, or"),
    ("raw: u16", "raw: uint16_t", "7:16 `uint16_t` is not a raw format", "did you mean `u16`?"),
    ("raw: u16", "raw: float", "7:16 `float` is not a raw format", "did you mean `f32`?"),
    ("raw: u16", "raw: 16", "7:16 `16` is not a raw format", "did you mean `u16`?"),
    ("type: level", "type: u16", "12:36 there is no type `u16`", "write `raw: u16`"),
    ('unit: "%"', "unit: RPM", "7:27 there is no unit `RPM`", "did you mean `rpm`?"),
    ('unit: "%"', "unit: °C", "7:27 there is no unit `°C`", "did you mean `degC`?"),
    ('unit: "%"', "unit: volts", "7:27 there is no unit `volts`", "did you mean `V`?"),
    (
        'unit: "%"',
        "unit: furlong",
        "7:27 there is no unit `furlong`",
        "name it in `title`, or use A, mA, ",
    ),
    ('unit: "%"', "unit: ticks/s", "7:27 there is no unit `ticks/s`", "did you mean `count/s`?"),
    ("raw_range: 0..1000", "min: 0", "7:44 unknown key `min`", "did you mean `range`?"),
    ("scale: 0.1", "factor: 0.1", "7:32 unknown key `factor`", "did you mean `scale`?"),
    ("selector:", "endian: big\nselector:", "5:1 unknown key `endian`", "did you mean `byte_order`?"),
    ("selector:", "byte_order: big-endian\nselector:", "5:13 `big-endian` is not `little` or `big`", "write big"),
    ("scale: 0.1, raw_range", "scale: none, range", "7:45 `range` is in the unit, and", "write `raw_range`"),
    (LEVEL, "{level: {at: 2, type: level}, dlc: 4}", "12:15 unknown key `level`", "a field stands in `layout` here"),
    (LEVEL, "{level: {at: [2, 3], type: level}}", "12:27 expected a number or a short text here, like 4, 4.3", ""),
    (LEVEL, f"{{layout: {LEVEL}, dlc: 64}}", "12:59 64 exceeds the maximum of 8", "Data bytes"),
    ("reply: echo", "reply: ehco", "13:12 there is no layout `ehco`", "did you mean `echo`?"),
    ("  dim:", "  DimLamp:", "9:3 `DimLamp` is not a valid name", "small letters, digits and `_`: `dim_lamp`"),
    ("  dim:", "  dim-lamp:", "9:3 `dim-lamp` is not a valid name", "`dim_lamp`"),
    ("canwright: 1", "canwright: 2", "1:12 `2` is not `1`", "write `1`"),
    ("canwright: 1", 'canwright: "1"', "1:12 the text `1` is not the number `1`", "write `1`, without quotes"),
    ("    code: 0x10", "\tcode: 0x10", "10:1 this is not YAML", "indent with spaces"),
    (
        "    code: 0x10",
        "    code 0x10",
        "10:5 this is not YAML",
        "`code: 0x10`",
    ),
    ("reply: echo", "reply: {layout: entry", "13:12 this is not YAML", "this `{` is not closed"),
    (
        "unit: ",
        "enum: [idle, busy], unit: ",
        "7:27 expected a mapping here",
        "say the value of each: {idle: 0, busy: 1}",
    ),
    ("commands:\n", "commands: {}\nold:\n", "8:11 this is empty; at least one is needed here", "Commands, by name."),
]


@pytest.mark.parametrize(("old", "new", "says", "hint"), WRONG, ids=[new.strip() for _, new, _, _ in WRONG])
def test_what_a_mistake_is_told(tmp_path: Path, old: str, new: str, says: str, hint: str) -> None:
    assert old in MINIMAL
    found = findings(tmp_path, MINIMAL.replace(old, new, 1))
    told = {f"{d.position.line}:{d.position.column} {d.message}": d.hint for d in found}
    at = next((text for text in told if text.startswith(says)), None)
    assert at is not None, list(told)
    assert hint in told[at], told[at]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("selector: {at: 0, raw: u8}", "selector: 0"),
        ('types:\n  level: {raw: u16, unit: "%"', 'types:\n  - {raw: u16, unit: "%"'),
    ],
)
def test_what_follows_from_another_finding_is_not_told(tmp_path: Path, old: str, new: str) -> None:
    assert old in MINIMAL
    assert len(findings(tmp_path, MINIMAL.replace(old, new, 1))) == 1


def test_a_wrong_item_of_a_list_is_told_once(tmp_path: Path) -> None:
    found = findings(tmp_path, MINIMAL.replace("types:", "parameters: {size: {values: [big-one, 7]}}\ntypes:"))
    assert [(d.message, d.hint.rpartition(": ")[2]) for d in found] == [
        ("`big-one` is not a valid name here", "`big_one`")
    ]


def test_short_values_and_mappings_mean_the_same(tmp_path: Path) -> None:
    text = MINIMAL.replace(
        '{raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}', "{raw: u8, enum: {idle: 0, busy: 3}}"
    )
    (tmp_path / "short.yaml").write_text(text, "utf-8")
    (tmp_path / "long.yaml").write_text(
        text.replace("idle: 0", "idle: {value: 0}").replace("3}", "{value: 3}}"), "utf-8"
    )
    short, long = (specification(tmp_path / name).edition for name in ("short.yaml", "long.yaml"))
    assert [asdict(one) for one in short.types] == [asdict(one) for one in long.types]
    assert [(m.name, m.value) for m in short.types[0].enum] == [("idle", 0), ("busy", 3)]


def test_words_of_c_and_of_other_tools() -> None:
    formats = {"int8_t": "i8", "uint32_t": "u32", "s16": "i16", "double": "f64", "u0": "", "x": ""}
    assert {word: aliases.raw_format(word) for word in formats} == formats


def test_a_name_like_none_of_many_is_not_said_to_be_the_first(tmp_path: Path) -> None:
    many = "types:\n" + "".join(f"  kind_{n}: {{raw: u8}}\n" for n in range(14))
    text = MINIMAL.replace("types:\n", many).replace("type: level", "type: qq")
    hints = [f.hint for f in findings(tmp_path, text) if f.rule == "unknown-reference"]
    assert hints == ["none of the 15 under `types` is like it; define it there"]
