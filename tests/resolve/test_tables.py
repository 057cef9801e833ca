"""A second selector: a table gives a command one form for each entry."""

from __future__ import annotations

from pathlib import Path

from ..spec_texts import MINIMAL, edition, findings, marked

TABLE = (
    MINIMAL
    + """\
  read_setting: {code: 0x40, manual: "2", table: settings, reply: entry}
  write_setting: {code: 0x42, manual: "3", table: settings, request: entry, reply: echo}
effects: {wears: {level: warning}}
tables:
  settings:
    title: Settings
    manual: "4"
    index: [{at: 1, raw: u8}, {at: 2, raw: u8}]
    entries:
      gains: {index: 0xA0, effects: [wears], layout: {kp: {at: 2, raw: u16}, ki: {at: 4, raw: u16}}}
      level: {index: [5, 0x0A], layout: {level: {at: 4, type: level}}}
"""
)


def test_a_command_has_a_form_for_each_entry(tmp_path: Path) -> None:
    commands = {c.name: c for c in edition(tmp_path, TABLE).commands}
    assert list(commands) == [
        "dim",
        "read_setting_gains",
        "read_setting_level",
        "write_setting_gains",
        "write_setting_level",
    ]
    write = commands["write_setting_level"]
    assert (write.spec_name, write.title["en"]) == ("write_setting", "Write setting: Level")
    assert write.request and [(k.segments[0].byte, k.value) for k in write.request.keys] == [(0, 0x42), (1, 5), (2, 10)]
    assert [k.value for k in commands["read_setting_gains"].reply.keys] == [0x40, 0xA0]  # type: ignore[union-attr]


def test_reading_and_writing_share_the_layout_of_the_entry(tmp_path: Path) -> None:
    tables = edition(tmp_path, TABLE)
    read, write = tables.command("read_setting_level"), tables.command("write_setting_level")
    assert read.request and not read.request.layout.fields
    assert read.reply and write.request and read.reply.layout is write.request.layout
    assert read.reply.layout.name == "settings_level"
    assert read.reply.layout.manual == "4"


def test_the_effects_of_an_entry_are_those_of_writing_it(tmp_path: Path) -> None:
    tables = edition(tmp_path, TABLE)
    assert [e.name for e in tables.command("write_setting_gains").effects] == ["wears"]
    assert not tables.command("read_setting_gains").effects


def test_position_of_an_error_in_a_table(tmp_path: Path) -> None:
    text = TABLE.replace("index: 0xA0, effects: [wears]", "index: [1, 2, 0x100]")
    assert marked(findings(tmp_path, text)) == ["too-many-values: ["]
    assert marked(findings(tmp_path, TABLE.replace("[wears]", "[ware]"))) == ["unknown-reference: ware"]
    assert marked(findings(tmp_path, TABLE.replace("[5, 0x0A]", "[5, 0x100]"))) == ["code-width: 0x100"]
    text = TABLE.replace("table: settings, reply", "reply")
    assert marked(findings(tmp_path, text)) == ["entry-of-nothing: entry"]
    text = TABLE.replace("table: settings, request", "table: seting, request")
    assert marked(findings(tmp_path, text))[0] == "unknown-reference: seting"
    assert "did you mean `settings`?" in findings(tmp_path, text)[0].hint
    text = TABLE.replace("    reply: echo\n", "    reply: {of: read_setting}\n")
    assert marked(findings(tmp_path, text)) == ["reply-of-table: read_setting"]
