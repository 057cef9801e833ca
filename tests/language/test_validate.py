from __future__ import annotations

from pathlib import Path

import pytest

from ..spec_texts import MINIMAL, findings, places


@pytest.mark.parametrize(
    ("old", "new", "expected", "hint"),
    [
        ("selector:", "selecter:", "5:1 unknown-key", "did you mean `selector`?"),
        ("family: lamp\n", "", "1:1 missing-key", "prefix of generated names"),
        ("raw: u16", "raw: u65", "7:16 value", ""),
        ("raw: u16", "raw: 16", "7:16 value", ""),
        ("raw_range: 0..1000", "raw_range: 1000..0", "7:55 value", ""),
        ("scale: 0.1", "scale: 1/0", "7:39 value", ""),
        ("scale: 0.1", "scale: yes", "7:39 ambiguous-scalar", "in quotes"),
        ('manual: "1"', "manual: 2.10", "11:13 type", "put it in quotes"),
        ("  dim:", "  Dim:", "9:3 name", "`dim`"),
        ("code: 0x10", "code: [1]", "10:11 value", ""),
        ("at: 2,", "at: 2, typ: x,", "12:30 unknown-key", "did you mean `type`?"),
        ("reply: echo", "reply: {layout: x, cod: 1}", "13:24 unknown-key", "did you mean `code`?"),
        ("edition: v1", "edition: ../v1", "3:10 name", ""),
    ],
)
def test_position_and_hint_of_a_structural_error(tmp_path: Path, old: str, new: str, expected: str, hint: str) -> None:
    assert old in MINIMAL
    reported = findings(tmp_path, MINIMAL.replace(old, new, 1))
    assert expected in places(reported)
    assert any(hint in finding.hint for finding in reported)


def test_one_run_reports_all_findings_in_file_order(tmp_path: Path) -> None:
    text = MINIMAL.replace("u16", "u99").replace("selector", "selecter").replace("reply: echo", "repl: echo")
    assert places(findings(tmp_path, text)) == ["5:1 unknown-key", "7:16 value", "13:5 unknown-key"]


def test_the_minimal_spec_is_valid(tmp_path: Path) -> None:
    assert findings(tmp_path, MINIMAL) == []


def test_a_mapping_for_a_raw_type_is_reported(tmp_path: Path) -> None:
    (finding,) = findings(tmp_path, MINIMAL.replace("raw: u16", "raw: {x: u16}"))
    assert (finding.rule, finding.message) == ("value", "expected a number or a short text here, for example u8")


@pytest.mark.parametrize("languages", ["[en, de]", "de", "[en, [zh]]"])
def test_texts_are_not_checked_for_invalid_languages(tmp_path: Path, languages: str) -> None:
    text = MINIMAL.replace("edition: v1", f"edition: v1\nlanguages: {languages}\ntitle: {{en: Lamp}}\nabout: A lamp.")
    assert [finding.position.line for finding in findings(tmp_path, text)] == [4]
