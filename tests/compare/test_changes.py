"""Every kind of change by its example, to the letter, and what is no change."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from canwright.cli import main
from canwright.compare import CHANGES, compare
from canwright.compare.report import Comparison, text
from canwright.load import described, load
from canwright.resources import CHANGE_EXAMPLES
from click.testing import CliRunner

from ..spec_texts import MINIMAL, ROOT, edition

V2_35 = ROOT / "spec/mwd_motor/v2.35.yaml"


def test_every_kind_has_an_example() -> None:
    assert sorted(folder.name for folder in CHANGE_EXAMPLES.iterdir()) == sorted(CHANGES)


@pytest.mark.parametrize("rule", CHANGES)
def test_what_a_comparison_says(rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CHANGE_EXAMPLES / rule)
    monkeypatch.setenv("NO_COLOR", "1")
    found = Comparison.of(load(Path("previous.yaml")), load(Path("current.yaml")))
    assert text(found) + "\n" == Path("expected.txt").read_text("utf-8")
    assert rule in [change.rule.id for change in found.changes]
    assert not any(re.search(r"[{}]", change.says()) for change in found.changes)


@pytest.mark.parametrize("rule", CHANGES)
def test_explain(rule: str) -> None:
    result = CliRunner().invoke(main, ["explain", rule])
    assert result.exit_code == 0
    assert result.output.startswith(f"{rule} ({CHANGES[rule].category.value})\n\n{CHANGES[rule].purpose}\n")
    assert f"[{rule}]" in result.output and "Before, previous.yaml:" in result.output


def test_an_edition_does_not_differ_from_itself() -> None:
    whole = described(V2_35).edition
    assert compare(whole, whole) == ()


def _reordered(text: str) -> str:
    """The same spec with its commands, types and layouts in reverse order."""
    parts = re.split(r"(?m)^(?=[a-z_]+:)", text)
    for i, part in enumerate(parts):
        if part.startswith(("types:", "layouts:", "commands:", "effects:", "settings:")):
            head, *items = re.split(r"(?m)^(?=  [a-z0-9_]+:)", part)
            parts[i] = head + "".join(item if item.endswith("\n") else item + "\n" for item in reversed(items))
    return "".join(parts)


def test_order_in_the_file_is_no_change(tmp_path: Path) -> None:
    original = V2_35.read_text("utf-8")
    changed = _reordered(original)
    assert changed != original and sorted(changed.splitlines()) == sorted(original.splitlines())
    assert compare(described(V2_35).edition, edition(tmp_path, changed)) == ()


def test_ways_to_write_the_same_are_no_change(tmp_path: Path) -> None:
    old = edition(tmp_path, MINIMAL)
    shared = MINIMAL.replace("request: {level: {at: 2, type: level}}", "request: light") + (
        "layouts: {light: {fields: {level: {at: 2.0, type: level}}}}\n"
    )
    assert compare(old, edition(tmp_path, shared)) == ()
    assert compare(old, edition(tmp_path, MINIMAL.replace("u16", "u16, byte_order: little"))) == ()
    assert compare(old, edition(tmp_path, MINIMAL.replace("code: 0x10", "code: 16"))) == ()


def test_other_languages_have_every_sentence_with_the_same_facts() -> None:
    languages = yaml.safe_load((ROOT / "templates/docs/changes.yaml").read_text("utf-8"))
    for said in (language["sentences"] for language in languages.values()):
        assert list(said) == list(CHANGES)
        for rule, sentence in said.items():
            facts = [set(re.findall(r"{(\w+)}", text)) for text in (sentence, CHANGES[rule].says)]
            assert facts[0] == facts[1], rule
