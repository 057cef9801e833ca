"""Hostile texts in every text of a spec: nothing but the texts differs in what is made of it."""

from __future__ import annotations

import ast
import functools
import html.parser
import itertools
import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import cantools
import markdown
import pytest
from canwright import site
from canwright.cli import main
from canwright.diagnostics import SpecError
from canwright.generate import TARGETS, generate
from canwright.model import Command
from click.testing import CliRunner
from markdown_it import MarkdownIt

from ..compilers import compilers
from ..targets.test_c_compiles import everything, headers
from .everything import SPEC, filled, filled_fields, text_fields
from .hostile import HARMLESS, HOSTILE, REFUSED

Files = dict[str, str]
Nodes = list[tuple[str, ...]]


def made(say: Sequence[str], folder: Path, languages: tuple[str, ...] = ("en", "zh")) -> Files:
    """All that is generated, where the texts are said in turn."""
    turns = itertools.cycle(say)
    described = filled(lambda: next(turns), folder, languages)
    return {path: content.decode("utf-8") for path, content in generate([described], list(TARGETS), {}).files.items()}


@pytest.fixture(scope="module")
def harmless(tmp_path_factory: pytest.TempPathFactory) -> Files:
    return made([HARMLESS], tmp_path_factory.mktemp("harmless"))


def test_every_text_of_the_language_is_filled() -> None:
    assert filled_fields() == text_fields()
    assert {"Command.notes", "Type.differs", "Address.title", "Frame.note"} <= filled_fields()


@pytest.mark.parametrize("text", HOSTILE)
def test_a_text_is_only_text(text: str, harmless: Files, tmp_path: Path) -> None:
    hostile = made([text], tmp_path)
    assert _same_files(hostile, harmless, text) == []


def _same_files(hostile: Files, harmless: Files, text: str) -> list[str]:
    assert list(hostile) == list(harmless)
    different = []
    for path, content in hostile.items():
        kind = path.rsplit(".", 1)[-1]
        same = {"h": _same_c, "c": _same_c, "py": _same_python, "dbc": _same_dbc, "md": _same_page}.get(kind, _equal)
        if not same(content, harmless[path], text):
            different.append(path)
    return different


def _equal(hostile: str, harmless: str, text: str) -> bool:
    return _without_hash(hostile) == _without_hash(harmless)


def _without_hash(text: str) -> str:
    return re.sub(r"[0-9a-f]{12,64}", "", text)


def _same_c(hostile: str, harmless: str, text: str) -> bool:
    return _words(hostile) == _words(harmless)


@functools.cache
def _words(source: str) -> list[str]:
    """The words of a source without its comments, as a compiler sees them: trigraphs and line ends first."""
    for trigraph, meant in zip(("??/", "??=", "??'", "??(", "??)", "??!", "??<", "??>", "??-"), "\\#^[]|{}~", strict=True):
        source = source.replace(trigraph, meant)
    return _without_hash(re.sub(r"/\*.*?\*/|//[^\n]*", " ", source.replace("\\\n", ""), flags=re.S)).split()


def _same_python(hostile: str, harmless: str, text: str) -> bool:
    return _tree(hostile) == _tree(harmless)


@functools.cache
def _tree(source: str) -> str:
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


def _same_dbc(hostile: str, harmless: str, text: str) -> bool:
    return _loaded(hostile) == _loaded(harmless)


@functools.cache
def _loaded(source: str) -> list[object]:
    database = cantools.database.load_string(source, "dbc")
    assert isinstance(database, cantools.database.can.Database)
    nodes = [node.name for node in database.nodes]
    return [nodes] + [
        (m.frame_id, m.name, m.length, m.senders, [(s.name, s.start, s.length, s.scale, s.offset, s.unit, s.minimum, s.maximum, s.choices and sorted(s.choices), s.multiplexer_ids, s.is_signed, s.byte_order) for s in m.signals])
        for m in database.messages
    ]


def _same_page(hostile: str, harmless: str, text: str) -> bool:
    shown = " ".join(text.split())
    for renderer in (_by_site, _by_every_extension, _by_commonmark):
        one, other = _page(renderer(hostile)), _page(renderer(harmless))
        if one.elements != other.elements or one.text.split() != other.text.replace(HARMLESS, shown).split():
            return False
    return True


@functools.cache
def _by_site(text: str) -> str:
    return markdown.markdown(text, extensions=site.EXTENSIONS)


EVERY_EXTENSION = (
    *("footnotes", "abbr", "admonition", "def_list", "wikilinks", "fenced_code", "sane_lists", "meta"),
    *("pymdownx." + name for name in ("emoji", "details", "tabbed", "caret", "tilde", "mark", "critic", "keys")),
    *("pymdownx." + name for name in ("arithmatex", "magiclink", "tasklist", "inlinehilite", "betterem", "snippets")),
)


@functools.cache
def _by_every_extension(text: str) -> str:
    """As a site shows it that has every extension turned on that gives words or signs a meaning."""
    return markdown.markdown(text, extensions=[*site.EXTENSIONS, *EVERY_EXTENSION])


@functools.cache
def _by_commonmark(text: str) -> str:
    return MarkdownIt("commonmark").enable("table").render(text)


@functools.cache
def _page(source: str) -> _Page:
    return _Page(source)


class _Page(html.parser.HTMLParser):
    """The elements of a page with the names of their attributes, and its text."""

    def __init__(self, source: str) -> None:
        super().__init__()
        self.elements: list[str] = []
        self.text = ""
        self.feed(source)
        self.text = _without_hash(self.text.replace("\u200b", ""))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        named = [f"{name}={value}" for name, value in attrs if not (tag.startswith("h") and name == "id")]
        self.elements.append(f"<{tag} {' '.join(named)}>")

    def handle_endtag(self, tag: str) -> None:
        self.elements.append(f"</{tag}>")

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_comment(self, data: str) -> None:
        self.elements.append("<!-- -->")
