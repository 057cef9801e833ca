"""Every text of a spec reaches a page, in its language; every change of one reaches the page of changes."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.compare import CHANGES, compare
from canwright.compare.change import Keyword, SentenceArgument
from canwright.language.edition import EditionSpec, json_schema
from canwright.project.loader import spec_files, specification
from canwright.targets.base import EditionInput
from canwright.targets.docs.editions import PLACES
from canwright.targets.docs.target import DocsTarget
from canwright.targets.examples import Examples
from canwright.templating.markup import markdown
from canwright.templating.resources import CHANGE_EXAMPLES

from ..spec_texts import ROOT, SPECS, called
from ..untrusted.everything import filled

Places = dict[str, str]
"""Texts of one language, by where they stand."""


def _text_keys() -> set[str]:
    """The keys that take a text in every language, as the JSON Schema has them."""
    schema = json_schema(EditionSpec)
    concepts = [schema, *schema["$defs"].values()]
    text = _choices(schema["properties"]["about"])
    keys = {
        key
        for concept in concepts
        for key, definition in concept.get("properties", {}).items()
        if _choices(definition) == text
    }
    return keys | {"notes"}


def _choices(schema: dict[str, Any]) -> list[Any]:
    """What a key can hold, a text in one language or in several apart; nothing where it is left out."""
    parts = [choice for kind in ("anyOf", "oneOf") for option in schema.get(kind, ()) for choice in _choices(option)]
    return parts or [{k: v for k, v in schema.items() if k not in ("description", "title", "default")}] * (
        schema.get("type") != "null"
    )


def _texts(part: Any, language: str, keys: set[str], path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(part, dict):
        for key, inner in part.items():
            for i, element in enumerate(inner if key == "notes" and isinstance(inner, list) else [inner]):
                at = f"{path}.{key}" if key != "notes" else f"{path}.{key}.{i}"
                if key in keys and (isinstance(element, str) or (isinstance(element, dict) and language in element)):
                    yield at, element if isinstance(element, str) else element[language]
                else:
                    yield from _texts(element, language, keys, at)
    elif isinstance(part, list):
        for i, inner in enumerate(part):
            yield from _texts(inner, language, keys, f"{path}.{i}")


def _missing(of: EditionInput, data: Any) -> list[str]:
    """Where the texts stand that are on no page."""
    pages = list(DocsTarget().generate([of], {}))
    keys = _text_keys()
    missing = []
    for language in of.edition.languages:
        shown = "\n".join(p.text for p in pages if p.path.startswith(f"{language}/") and p.path.endswith(".md"))
        texts = dict(_texts(data, language, keys))
        assert texts
        missing += [f"{language}{path}: {text}" for path, text in texts.items() if markdown(text) not in shown]
    return missing


def test_the_texts_are_known() -> None:
    assert _text_keys() >= {"title", "about", "notes", "printed", "used", "why", "differs", "manual"}


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_every_text_of_a_spec_is_on_a_page(spec: Path) -> None:
    data = yaml.load(spec.read_text("utf-8"), Loader=yaml.CSafeLoader)
    sections = _without_sections(data)
    assert _missing(specification(spec), sections) == []


def test_every_text_there_can_be_is_on_a_page(tmp_path: Path) -> None:
    numbers = itertools.count(1)
    whole = filled(lambda: f"said {next(numbers)} here", tmp_path)
    data = _without_sections(json.loads((tmp_path / "lamp.yaml").read_text("utf-8")))
    assert next(numbers) > 200
    assert _missing(whole, data) == []


def _without_sections(data: Any, top: bool = True) -> Any:
    """A spec without the sections of its manual, which have the key of its title."""
    if isinstance(data, list):
        return [_without_sections(element, False) for element in data]
    if not isinstance(data, dict):
        return data
    return {key: _without_sections(value, False) for key, value in data.items() if top or key != "manual"}


def _said(facts: Sequence[SentenceArgument]) -> Iterator[str]:
    for fact in facts:
        if isinstance(fact, Keyword):
            yield str(fact)
        elif isinstance(fact, tuple):
            yield from _said(fact)


def test_other_languages_have_every_word_of_a_sentence() -> None:
    languages = yaml.safe_load((ROOT / "templates/docs/changes.yaml").read_text("utf-8"))
    written = [path.read_text("utf-8") for path in (ROOT / "generator/canwright/compare").glob("*.py")]
    matches = [re.findall(r'Keyword\("([^"]+)"(?:\)| if [^\n]* else "([^"]+)"\))', text) for text in written]
    words = {word for pairs in matches for pair in pairs for word in pair if word}
    assert {"remote frame", "data frame"} <= words
    for folder in CHANGE_EXAMPLES.iterdir():
        old, new = (specification(folder / f"{name}.yaml").edition for name in ("previous", "current"))
        words |= {word for change in compare(old, new) for word in _said(tuple(change.facts.values()))}
    for language, says in languages.items():
        assert words <= says["words"].keys(), language


ENGLISH = re.compile(r"\b(any|none|nothing|all|section|request|reply|default|not|true|false|the|is|was|of)\b")


@pytest.mark.parametrize("rule", CHANGES)
def test_a_change_is_told_in_the_language_of_its_page(rule: str, tmp_path: Path) -> None:
    specs = []
    for name in ("previous", "current"):
        text = (CHANGE_EXAMPLES / rule / f"{name}.yaml").read_text("utf-8")
        data = yaml.safe_load(text)
        data["languages"], data["date"] = ["en", "zh"], "2024" if name == "previous" else "2025"
        data["edition"] = name
        _translate(data, _text_keys())
        file = tmp_path / f"{name}.yaml"
        file.write_text(json.dumps(data, ensure_ascii=False), "utf-8")
        specs.append(specification(file))
    pages = {page.path: page.text for page in DocsTarget().generate(specs, {})}
    rows = [line for line in pages["zh/current/changes.md"].splitlines() if line.startswith("| ")]
    assert bool(rows) is (rule not in {"languages-changed", *PLACES})  # both are in two languages here
    for row in rows:
        assert not ENGLISH.search(re.sub(r"`[^`]*`", "", row)), row
        assert not re.search(r"[\u4e00-\u9fff] [\u4e00-\u9fff]", row), row


def test_chinese_pages_are_chinese_throughout() -> None:
    made = DocsTarget().generate([specification(spec) for spec in spec_files(ROOT / "spec")], {})
    pages = {page.path: page.text for page in made if page.path.startswith("zh/") and page.path.endswith(".md")}
    assert "zh/v2.36-2025-03/changes.md" in pages
    del pages["zh/glossary.md"]  # names in both languages
    for path, text in pages.items():
        for line in re.sub(r"`[^`]*`|<!--.*?-->|\]\([^)]*\)|<a id[^>]*>", "", text).splitlines():
            assert not ENGLISH.search(line), f"{path}: {line}"


def test_notes_of_shown_golden_frames_are_in_every_language() -> None:
    shown = 0
    for spec in spec_files(ROOT / "spec"):
        edition, frames = specification(spec)
        examples = Examples(edition, frames)
        for selected in map(examples.select, edition.commands):
            for frame in (*selected.requests, *selected.replies):
                if frame.note:
                    shown += 1
                    assert set(frame.note) == set(edition.languages)
    assert shown > 10


def _translate(part: Any, keys: set[str]) -> None:
    """Every text in two languages."""
    if isinstance(part, dict):
        for key, inner in part.items():
            if key == "notes":
                part[key] = [{"en": note, "zh": "文字"} if isinstance(note, str) else note for note in inner]
            elif key in keys and isinstance(inner, (str, dict)) and (key != "manual" or "family" in part):
                text = inner if isinstance(inner, str) else inner["en"]
                part[key] = {"en": text, "zh": f"文字 {len(text)}"}
            else:
                _translate(inner, keys)
    elif isinstance(part, list):
        for inner in part:
            _translate(inner, keys)
