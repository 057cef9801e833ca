"""Hints for invalid specs: position, rule and suggestion."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import pytest
from canwright.language import aliases
from canwright.project.loader import specification

from ..spec_texts import MINIMAL, findings, places

LEVEL = "{level: {at: 2, type: level}}"

INVALID = [
    ("code: 0x10", "code: 1F", "10:11 value", "did you mean 0x1F?"),
    ("code: 0x10", 'code: "0x10"', "10:11 value", "write 0x10 without quotes"),
    (
        LEVEL,
        '{level: {at: 2, type: level}, mark: {at: 5, raw: u8, constant: "0x55"}}',
        "12:77 value",
        "write 0x55 without quotes",
    ),
    ("code: 0x10", "code: 10h", "10:11 value", "did you mean 0x10?"),
    ("code: 0x10", "code: ten", "10:11 value", "write a whole number"),
    ("code: 0x10", "code: 0xFFFFFFFFFFFFFFFFFFFF", "10:11 value", "a whole number has at most 31 digits"),
    ("nodes: 1..4", "nodes: 4", "4:45 value", "did you mean `1..4`?"),
    ("nodes: 1..4", "nodes: 1-4", "4:45 value", "did you mean `1..4`?"),
    ("nodes: 1..4", "nodes: [1, 2]", "4:45 value", "did you mean `1..2`?"),
    ("id: 0x100 + node", "id: node << 5 | 16", "4:24 value", "did you mean `node << 5 + 16`?"),
    ("0x100 + node", "0x100", "4:31 address-id", "0x100 + node"),
    ("id: 0x100", "reply: 0x200 + node, id: 0x100", "4:41 address-id", "keep `id`, or"),
    ("id: 0x100", "request: 0x100", "4:13 missing-key", "write `id`, or"),
    ("raw: u16", "raw: uint16_t", "7:16 value", "did you mean `u16`?"),
    ("raw: u16", "raw: float", "7:16 value", "did you mean `f32`?"),
    ("raw: u16", "raw: 16", "7:16 value", "did you mean `u16`?"),
    ("type: level", "type: u16", "12:36 unknown-reference", "write `raw: u16`"),
    ('unit: "%"', "unit: RPM", "7:27 unknown-reference", "did you mean `rpm`?"),
    ('unit: "%"', "unit: °C", "7:27 unknown-reference", "did you mean `degC`?"),
    ('unit: "%"', "unit: volts", "7:27 unknown-reference", "did you mean `V`?"),
    ('unit: "%"', "unit: turn", "7:27 unknown-reference", "did you mean `rev`?"),
    ('unit: "%"', "unit: turns/s", "7:27 unknown-reference", "did you mean `rev/s`?"),
    ('unit: "%"', "unit: furlong", "7:27 unknown-reference", "use A, mA, "),
    ('unit: "%"', "unit: ticks/s", "7:27 unknown-reference", "did you mean `count/s`?"),
    ("raw_range: 0..1000", "range: 0..65535", "7:51 beyond-width", "for raw integers, write raw_range: 0..65535"),
    ("raw_range: 0..1000", "range: 0..7000", "7:51 beyond-width", "for raw integers, write raw_range: 0..7000"),
    ("raw_range: 0..1000", "range: 0..70000", "7:51 beyond-width", "and the sign and width in `raw`"),
    ("raw_range: 0..1000", "min: 0", "7:44 unknown-key", "did you mean `range`?"),
    ("scale: 0.1", "factor: 0.1", "7:32 unknown-key", "did you mean `scale`?"),
    (
        "selector:",
        "bus: {modes: {fast: {bit_rates_kbps: [5000]}}}\nselector:",
        "5:39 value",
        "only the data of CAN FD frames have a higher bit rate",
    ),
    ("selector:", "endian: big\nselector:", "5:1 unknown-key", "did you mean `byte_order`?"),
    ("selector:", "byte_order: big-endian\nselector:", "5:13 value", "write big"),
    ("scale: 0.1, raw_range", "scale: none, range", "7:45 two-ranges", "write `raw_range`"),
    ("{level: {at: 2, type: level}}", "{level: {at: 2, type: level}, dlc: 4}", "12:15 unknown-key", "`layout`"),
    (
        "{level: {at: 2, type: level}}",
        "{layout: {level: {at: 2, type: level}}, dlc: 65}",
        "12:59 value",
        "Number of data bytes",
    ),
    ("raw_range: 0..1000", "no_value: {absent: nan}", "7:63 value", "write the raw integer, or f32 in `raw`"),
    (
        'raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000',
        "raw: f64, no_value: {absent: {raw: 0xFF}}",
        "7:40 value",
        "write absent: nan, or u or i in `raw`",
    ),
    ("raw_range: 0..1000", "names: {least: 0, lowest: 0}", "7:70 member-value", "give each a different value"),
    ("raw_range: 0..1000", "names: {most: 65536}", "7:58 member-value", "the sign and width in `raw`"),
    ("0..1000", "0..1000, names: {most: 1001}", "7:78 member-value", "widen the range, or write it in `no_value`"),
    (
        "raw_range: 0..1000",
        "no_value: {absent: 0xFF00..0xFFFF}, names: {most: 0xFF01}",
        "7:94 member-value",
        "keep it in `names` if it is a number",
    ),
    (
        'raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000',
        "raw: f32, names: {most: 0}",
        "7:21 no-effect",
        "write u or i in `raw`",
    ),
    (
        'raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000',
        "raw: u8, enum: {idle: 0}, names: {most: 3}",
        "7:37 mixed-type",
        "name these raw integers in `enum`",
    ),
    (
        'raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000',
        "raw: bcd4, names: {most: 3}",
        "7:22 no-effect",
        "remove it",
    ),
    ("reply: echo", "reply: ehco", "13:12 unknown-reference", "did you mean `echo`?"),
    ("  dim:", "  DimLamp:", "9:3 name", "`dim_lamp`"),
    ("  dim:", "  dim-lamp:", "9:3 name", "`dim_lamp`"),
    ("canwright: 1", "canwright: 2", "1:12 value", "write `1`"),
    ("canwright: 1", 'canwright: "1"', "1:12 value", "write `1`, without quotes"),
    ("    code: 0x10", "\tcode: 0x10", "10:1 yaml", "indent with spaces"),
    ("    code: 0x10", "    code 0x10", "10:5 yaml", "`code: 0x10`"),
    ("reply: echo", "reply: {layout: entry", "13:12 yaml", "this `{` is not closed"),
    ("unit: ", "enum: [idle, busy], unit: ", "7:27 type", "{idle: 0, busy: 1}"),
    ("commands:\n", "commands: {}\nold:\n", "8:11 value", "Commands, by name."),
]


@pytest.mark.parametrize(("old", "new", "place", "hint"), INVALID, ids=[new.strip() for _, new, _, _ in INVALID])
def test_hint_for_an_invalid_value(tmp_path: Path, old: str, new: str, place: str, hint: str) -> None:
    assert old in MINIMAL
    diagnostics = findings(tmp_path, MINIMAL.replace(old, new, 1))
    hints = dict(zip(places(diagnostics), (d.hint for d in diagnostics), strict=True))
    assert hint in hints[place], hints


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("selector: {at: 0, raw: u8}", "selector: 0"),
        ('types:\n  level: {raw: u16, unit: "%"', 'types:\n  - {raw: u16, unit: "%"'),
    ],
)
def test_an_error_has_no_further_findings(tmp_path: Path, old: str, new: str) -> None:
    assert old in MINIMAL
    assert len(findings(tmp_path, MINIMAL.replace(old, new, 1))) == 1


def test_an_invalid_list_item_has_one_finding(tmp_path: Path) -> None:
    diagnostics = findings(tmp_path, MINIMAL.replace("types:", "parameters: {size: {values: [big-one, 7]}}\ntypes:"))
    assert [(d.rule, d.hint.rpartition(": ")[2]) for d in diagnostics] == [("name", "`big_one`")]


def test_values_and_mappings_are_equivalent(tmp_path: Path) -> None:
    text = MINIMAL.replace(
        '{raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}', "{raw: u8, enum: {idle: 0, busy: 3}}"
    )
    (tmp_path / "short.yaml").write_text(text, "utf-8")
    (tmp_path / "long.yaml").write_text(
        text.replace("idle: 0", "idle: {value: 0}").replace("3}", "{value: 3}}"), "utf-8"
    )
    short, long = (specification(tmp_path / name).edition for name in ("short.yaml", "long.yaml"))
    assert [asdict(type_) for type_ in short.types] == [asdict(type_) for type_ in long.types]
    assert [(m.name, m.value) for m in short.types[0].enum] == [("idle", 0), ("busy", 3)]


def test_raw_formats_for_types_of_c_and_other_tools() -> None:
    formats = {"int8_t": "i8", "uint32_t": "u32", "s16": "i16", "double": "f64", "u0": "", "x": ""}
    assert {word: aliases.raw_format(word) for word in formats} == formats


def test_no_name_is_suggested_if_none_is_similar(tmp_path: Path) -> None:
    many = "types:\n" + "".join(f"  kind_{n}: {{raw: u8}}\n" for n in range(14))
    text = MINIMAL.replace("types:\n", many).replace("type: level", "type: qq")
    hints = [f.hint for f in findings(tmp_path, text) if f.rule == "unknown-reference"]
    assert hints == ["define it under `types`; none of the 15 names there is similar"]


@pytest.mark.parametrize(
    ("date", "exists"),
    [("2024", True), ("2024-02", True), ("2024-02-29", True), ("2024-02-30", False), ("2023-02-29", False)],
)
def test_dates_of_the_calendar(tmp_path: Path, date: str, exists: bool) -> None:
    reported = findings(tmp_path, MINIMAL.replace("edition: v1", f'edition: v1\ndate: "{date}"'))
    assert [finding.message for finding in reported] == ([] if exists else [f"`{date}` is not a date"])
