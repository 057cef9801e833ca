"""The pages of commands that a table gives several forms, and what else a page says only where it holds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from canwright.project.loader import specification
from canwright.targets.docs.target import DocsTarget

from ..spec_texts import MINIMAL, ROOT

TABLE = (
    MINIMAL.replace(
        "  dim:\n",
        """\
  read_setting:
    {code: 0x40, manual: "2", table: settings, reply: entry, notes: [Slow.], effects: [stays]}
  write_setting:
    {code: 0x42, manual: "3", table: settings, request: entry, reply: entry, effects: [stays]}
  dim:
""",
    )
    + """\
  dim_again: {code: 0x11, manual: "1", request: {level: {at: 2, raw: u8}}, reply: {of: dim}}
layouts:
  pair: {manual: "8", about: Two of them., fields: {kp: {at: 4, raw: u16}, ki: {at: 6, raw: u16, manual: "9"}}}
effects: {wears: {level: warning}, stays: {}}
tables:
  settings:
    title: Things | set
    about: What the lamp starts with.
    manual: "4"
    index: [{at: 1, raw: u8}, {at: 2, raw: u8}]
    entries:
      gains: {index: 0xA0, effects: [wears], about: Both at once., layout: pair}
      level: {index: [5, 0x0A], manual: "5", layout: {level: {at: 3, raw: u40}}}
errata:
  - {id: of_table, where: [tables.settings], manual: "4", printed: P, used: U, why: W}
  - {id: of_index, where: [tables.settings.index], manual: "4", printed: P, used: U, why: W}
  - {id: of_gains, where: [tables.settings.entries.gains], manual: "4", printed: P, used: U, why: W}
  - {id: of_level, where: [tables.settings.entries.level.layout.level], manual: "4", printed: P, used: U, why: W}
  - {id: of_dim, where: [commands.dim.reply], manual: "1", printed: P, used: U, why: W}
"""
)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    spec = tmp_path_factory.mktemp("spec") / "spec.yaml"
    spec.write_text(TABLE, "utf-8")
    return {
        output.path.removeprefix("en/v1/"): output.text for output in DocsTarget().generate([specification(spec)], {})
    }


def test_the_overview_has_a_command_once_with_its_entries(pages: dict[str, str]) -> None:
    lines = [line for line in pages["index.md"].splitlines() if line.startswith("| `0x4")]
    assert lines == [
        "| `0x40` | [read_setting](commands/read_setting.md)<br>Read setting | layout of the entry |  | `stays` |",
        "| `0x42` | [write_setting](commands/write_setting.md)<br>Write setting | layout of the entry |  | `stays` |",
    ]


def test_the_overview_has_the_entries_of_a_table_by_index(pages: dict[str, str]) -> None:
    _, _, section = pages["index.md"].partition('## <a id="tables.settings"></a>Things \\| set\n\n')
    assert section.splitlines()[:6] == [
        "What the lamp starts with.",
        "",
        "| Index | Entry | Description | `read_setting` | `write_setting` | Effects |",
        "| --- | --- | --- | --- | --- | --- |",
        "| `0xA0` | `gains` | Gains | [`0x40`](commands/read_setting.md#entries.gains) | "
        "[`0x42`](commands/write_setting.md#entries.gains) | `wears` |",
        "| `0x05 0x0A` | `level` | Level | [`0x40`](commands/read_setting.md#entries.level) | "
        "[`0x42`](commands/write_setting.md#entries.level) |  |",
    ]


def _entry(page: str, name: str) -> str:
    """The section of an entry."""
    _, _, section = page.partition(f'<a id="entries.{name}">')
    return section.partition("\n## ")[0]


def test_a_page_of_a_table_command_has_the_notes_of_table_entry_and_command(pages: dict[str, str]) -> None:
    page = pages["commands/read_setting.md"]
    table = "[Things \\| set](../index.md#tables.settings): What the lamp starts with."
    for said in (table, "> [!NOTE]\n> - Stays\n> - Slow.\n", "| `0xA0` | [`gains`](#entries.gains) | Gains |"):
        assert said in page
    gains, level = _entry(page, "gains"), _entry(pages["commands/write_setting.md"], "level")
    for said in ("Both at once.", "Two of them."):
        assert said in gains
        assert said not in level
    wears = "> [!WARNING]\n> Wears\n"
    assert wears in _entry(pages["commands/write_setting.md"], "gains")
    assert wears not in gains, "an entry has its effects when it is written"
    assert "| `DATA[0]` |  | `u8`<br>`0x40` |  | command code |" in gains
    assert "| `DATA[1]` |  | `u8`<br>`0xA0` |  | index of the entry |" in gains
    assert level.count("| index of the entry |") == 2


def test_sections_of_the_manual_are_shown_where_they_differ(pages: dict[str, str]) -> None:
    page = pages["commands/read_setting.md"]
    gains = _entry(page, "gains")
    assert "· Manual 2\n" in page
    assert "| Id | Nodes | Frame | Form | Manual |" in gains
    assert "(Manual 9) |" in gains
    assert "| Kp |" in gains
    level = _entry(pages["commands/write_setting.md"], "level")
    assert "`level` · Manual 5\n" in level
    assert "Form | Manual" not in level


def test_errata_reach_the_commands_that_meet_them(pages: dict[str, str]) -> None:
    errata = {
        Path(path).stem: [
            line.split("]")[0].removeprefix("- [") for line in text.splitlines() if "../errata.md" in line
        ]
        for path, text in pages.items()
        if path.startswith("commands/")
    }
    of_setting = ["of_table", "of_index", "of_gains", "of_level"]
    assert errata == {
        "read_setting": of_setting,
        "write_setting": of_setting,
        "dim": ["of_dim"],
        "dim_again": ["of_dim"],
    }
    index, table = (re.search(rf"errata.{name}.*?\n\n(.*)", pages["errata.md"]) for name in ("of_gains", "of_table"))
    assert index is not None
    assert table is not None
    assert "[read_setting_gains](commands/read_setting.md#entries.gains)" in index[1]
    assert "[read_setting](commands/read_setting.md)" in table[1]


def test_bits_are_called_reserved_where_some_are_left(pages: dict[str, str]) -> None:
    said = "Other bits: 0"
    reading, writing = pages["commands/read_setting.md"], pages["commands/write_setting.md"]
    assert _entry(writing, "gains").count(said) == 1
    assert "| Fields |" in _entry(writing, "gains")
    assert _entry(writing, "level").count(said) == 0
    assert _entry(reading, "level").count(said) == 1


def test_errata_that_commands_share_are_one_line(pages: dict[str, str]) -> None:
    alone, shared = pages["commands/read_setting.md"], pages["commands/dim.md"]
    assert "- [of_dim](../errata.md#errata.of_dim): P\n" in shared
    assert "- [of_table](../errata.md#errata.of_table): P\n" in alone
    assert "Printed in the manual" not in shared
    assert "Printed in the manual" in pages["errata.md"]


def test_a_command_that_moves_says_what_stops(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    stop = '  halt: {code: 0x12, manual: "1", ends_motion: stop, effects: [moves], request: {}, reply: {}}\n'
    text = MINIMAL.replace("  dim:\n", f"{stop}  dim:\n    effects: [moves]\n")
    spec.write_text(f"{text}effects: {{moves: {{level: danger, consent: motion}}}}\n", "utf-8")
    texts = {output.path: output.text for output in DocsTarget().generate([specification(spec)], {})}
    assert "\nTo stop the motion: [0x12 Halt](halt.md)\n" in texts["en/v1/commands/dim.md"]
    assert "To stop the motion" not in texts["en/v1/commands/halt.md"]


def test_a_command_of_a_mode_in_which_nothing_stops_names_no_stop() -> None:
    """The manual of v2.35 excludes single-motor commands beside the broadcast."""
    assert "motor_stop.md" not in _committed("v2.35/commands/broadcast_torque.md")
    assert "To stop the motion: [0x81 Motor stop]" in _committed("v2.35/commands/set_torque.md")


@pytest.mark.parametrize(
    ("page", "change"),
    [
        ("v2.36-2025-03/commands/set_zero_ram.md", "the code of `set_angle` (0x95) now means `set_zero_ram`"),
        ("v2.35-2024-02/commands/set_angle.md", "the code of `clear_angle` (0x95) now means `set_angle`"),
        ("v2.36-2024-11/commands/read_control_parameter.md", "the code is 0xC0 (was 0xB0)"),
        ("v2.36-2025-03/commands/read_control_parameter.md", "the index 0x22 now means `upper_angle`"),
        ("v2.36-2025-03/commands/stage_stored_setting.md", "`stage_stored_setting` (0x42) is added"),
        ("v2.36-2024-11/commands/motor_off.md", "the reply id is `0x180 + node` (was `0x140 + node`)"),
        ("v2.35-2024-02/commands/read_encoder.md", "the value `18` of `encoder_bits` is removed"),
    ],
)
def test_a_command_has_the_changes_of_what_it_uses_and_of_its_predecessor(page: str, change: str) -> None:
    text = _committed(page)
    assert "\n## Changes since " in text and f": {change}" in text


def test_a_command_without_changes_says_so() -> None:
    sentence = "\nThis command has no changes since [v2.36-2024-11](../changes.md).\n"
    assert sentence in _committed("v2.36-2025-03/commands/motor_off.md")


def test_commands_that_changed_are_marked_and_new_ones_are_not() -> None:
    rows = {line.split("`")[1]: line for line in _committed("support.md").splitlines() if line.startswith("| `")}
    cells = {name: [cell.endswith("*changed* ") for cell in row.split("|")[2:6]] for name, row in rows.items()}
    assert cells["motor_off"] == [False, False, True, False]
    assert cells["set_zero_ram"] == [False, False, False, True]
    assert cells["read_stored_setting"] == cells["calibrate_encoder"] == [False] * 4


def _committed(page: str) -> str:
    return (ROOT / "generated/docs/en" / page).read_text("utf-8")
