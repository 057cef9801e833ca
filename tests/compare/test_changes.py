"""Every kind of change by its example, to the letter, and what is no change."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from canwright.cli import main
from canwright.cli.diff_report import Comparison, Policy, Report, text
from canwright.compare import CHANGES, compare
from canwright.compare.change import Category
from canwright.project.loader import load, specification
from canwright.templating.resources import CHANGE_EXAMPLES
from click.testing import CliRunner

from ..spec_texts import MINIMAL, ROOT, SPECS, called, edition
from ..verification.compare import dumped
from ..verification.edits import reordered

V2_35 = ROOT / "spec/mwd_motor/v2.35.yaml"


def test_every_kind_has_an_example() -> None:
    assert sorted(folder.name for folder in CHANGE_EXAMPLES.iterdir()) == sorted(CHANGES)


@pytest.mark.parametrize("rule", CHANGES)
def test_text_of_each_finding_of_a_comparison(rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CHANGE_EXAMPLES / rule)
    monkeypatch.setenv("NO_COLOR", "1")
    comparison = Comparison.of(load(Path("previous.yaml")), load(Path("current.yaml")), Policy())
    assert text(Report((comparison,))) + "\n" == Path("expected.txt").read_text("utf-8")
    assert rule in [change.rule.id for change in comparison.changes]
    assert not any(re.search(r"[{}]", change.says()) for change in comparison.changes)


@pytest.mark.parametrize("rule", CHANGES)
def test_explain(rule: str) -> None:
    result = CliRunner().invoke(main, ["explain", rule])
    assert result.exit_code == 0
    assert result.output.startswith(f"{rule} ({CHANGES[rule].category.value})\n\n{CHANGES[rule].purpose}\n")
    assert f"[{rule}]" in result.output and "Before, previous.yaml:" in result.output


def test_an_edition_does_not_differ_from_itself() -> None:
    whole = specification(V2_35).edition
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
    assert compare(specification(V2_35).edition, edition(tmp_path, changed)) == ()


@pytest.mark.parametrize("file", SPECS, ids=called)
def test_order_of_keys_is_no_change(file: Path, tmp_path: Path) -> None:
    """Except for addresses, states and modes, of which the first has a meaning, and for items of lists."""
    data = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
    turned = edition(tmp_path, dumped(reordered(data, lambda keys: keys[::-1])))
    original = specification(file).edition
    assert compare(original, turned) == ()
    assert compare(turned, original) == ()


@pytest.mark.parametrize("file", SPECS, ids=called)
def test_order_of_the_old_keys_makes_no_difference(file: Path, tmp_path: Path) -> None:
    """Of an old edition that is compared with one with other codes and other scales."""
    old, new = (yaml.load(file.read_text("utf-8"), yaml.CSafeLoader) for _ in range(2))
    codes = [c["code"] for c in new["commands"].values() if isinstance(c.get("code"), int)]
    single = [c for c in new["commands"].values() if codes.count(c.get("code")) == 1 and "table" not in c]
    for command in [c for c in single[1:] if c.get("address") == single[0].get("address")][:1]:
        single[0]["code"], command["code"] = command["code"], single[0]["code"]
    for type_ in new.get("types", {}).values():
        if isinstance(type_.get("scale"), dict):
            type_["scale"] = {key: value if key == "by" else "7/3" for key, value in type_["scale"].items()}
    changed = edition(tmp_path, dumped(new))
    turned = edition(tmp_path, dumped(reordered(old, lambda keys: keys[::-1])))
    expected, actual = (
        {(c.rule.id, str(c.item), c.says(), c.impact) for c in compare(edition_, changed)}
        for edition_ in (specification(file).edition, turned)
    )
    assert expected == actual


def test_a_text_in_one_language_is_shown_in_that_language(tmp_path: Path) -> None:
    text = MINIMAL.replace("family:", "languages: [en, zh]\nfamily:").replace(
        "unit:", "title: {en: Level, zh: 亮度}, unit:"
    )
    (change,) = compare(edition(tmp_path, text), edition(tmp_path, text.replace("zh: 亮度", "zh: Level")))
    assert change.says() == "the title of `level` is “Level” (was “亮度”)"


def test_ways_to_write_the_same_are_no_change(tmp_path: Path) -> None:
    old = edition(tmp_path, MINIMAL)
    assert compare(old, edition(tmp_path, MINIMAL.replace("at: 2", "at: 2.0"))) == ()
    assert compare(old, edition(tmp_path, MINIMAL.replace("u16", "u16, byte_order: little"))) == ()
    assert compare(old, edition(tmp_path, MINIMAL.replace("code: 0x10", "code: 16"))) == ()
    unscaled = MINIMAL.replace(", scale: 0.1", "")
    assert compare(edition(tmp_path, unscaled), edition(tmp_path, unscaled.replace("u16", "u16, scale: 1"))) == ()
    bare = MINIMAL.replace("level: {at: 2, type: level}", "level: {at: 2, raw: u16}")
    named = bare.replace("raw: u16}}", "type: plain}}").replace("types:", "types:\n  plain: {raw: u16}")
    assert compare(edition(tmp_path, bare), edition(tmp_path, named)) == ()
    usual, fast = "usual: {bit_rates_kbps: [500]}", "fast: {bit_rates_kbps: [1000]}"
    modes = [edition(tmp_path, f"{MINIMAL}bus: {{modes: {{{a}, {b}}}}}\n") for a, b in ((usual, fast), (fast, usual))]
    assert compare(modes[0], modes[1]) == ()


def test_other_languages_have_every_sentence_with_the_same_facts() -> None:
    languages = yaml.safe_load((ROOT / "templates/docs/changes.yaml").read_text("utf-8"))
    for sentences in (language["sentences"] for language in languages.values()):
        assert list(sentences) == list(CHANGES)
        for rule, sentence in sentences.items():
            facts = [set(re.findall(r"{(\w+)}", text)) for text in (sentence, CHANGES[rule].says)]
            assert facts[0] == facts[1], rule


USES_OTHER = (
    MINIMAL.replace(
        'level: {raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}',
        "level: {raw: u16, unit: V, scale: 2/65535*top, offset: -top, range: -top..top}\n"
        "  spare: {raw: u8, raw_range: 0..3*other}",
    ).replace("reply: echo", "reply: {spare: {at: 4, type: spare}}")
    + "parameters: {top: {number: {}}, other: {number: {}, title: Another}}\n"
)


@pytest.mark.parametrize(
    ("written", "sentences"),
    [
        (
            ("2/65535*top", "2/65534*top"),
            ["the resolution of `level` is 2/65534*top V (was 2/65535*top V)"],
        ),
        (("offset: -top, range: -top..top", "offset: -2*top"), ["the offset of `level` is -2*top V (was -top V)"]),
        (
            ("2/65535*top, offset: -top, range: -top..top", "2/65535, offset: -1, range: -1..1"),
            [
                "the resolution of `level` is 2/65535 V (was 2/65535*top V)",
                "the offset of `level` is -1 V (was -top V)",
            ],
        ),
        (
            ("2/65535*top, offset: -top, range: -top..top", "2/65535*other, offset: -other, range: -other..other"),
            [
                "the resolution of `level` is 2/65535*other V (was 2/65535*top V)",
                "the offset of `level` is -other V (was -top V)",
            ],
        ),
        (("range: -top..top", "range: 0..top"), ["the raw range of `level` is 32768..65535 (was 0..65535)"]),
        (("2/65535*top", "4/131070*top"), ["the scale of `level` is written as 4/131070*top V (was 2/65535*top V)"]),
        (("top: {number: {}}", "top: {number: {max: 9}}"), ["the bounds of `top` are ..9 (were ..)"]),
    ],
)
def test_a_multiple_of_a_parameter(written: tuple[str, str], sentences: list[str], tmp_path: Path) -> None:
    old = edition(tmp_path, USES_OTHER)
    changed = USES_OTHER.replace(*written)
    assert changed != USES_OTHER
    changes = compare(old, edition(tmp_path, changed))
    assert [change.says() for change in changes] == sentences
    kinds = {"scale-rewritten": Category.DOC, "parameters-of-type-changed": Category.API}
    assert [c.rule.category for c in changes] == [kinds.get(c.rule.id, Category.VALUE) for c in changes]


def test_a_renamed_parameter_does_not_change_scales(tmp_path: Path) -> None:
    changes = compare(edition(tmp_path, USES_OTHER), edition(tmp_path, USES_OTHER.replace("top", "uppermost")))
    assert [change.rule.id for change in changes] == ["parameter-renamed"]
