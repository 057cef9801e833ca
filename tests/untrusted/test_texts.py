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
from canwright.cli import main
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import load
from canwright.project.pipeline import generate
from canwright.targets.registry import target_names
from click.testing import CliRunner
from lupa import lua54
from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from myst_parser.config.main import MdParserConfig
from myst_parser.parsers.mdit import create_md_parser

from ..compilers import WARNINGS, Compiler, each_compiler
from ..node import run as run_node
from ..samples import sampled
from ..targets.test_c_compiles import everything, headers, write
from .everything import SPEC, filled, filled_fields, text_fields
from .hostile import HARMLESS, HOSTILE, REFUSED

Files = dict[str, str]


def made(say: Sequence[str], folder: Path, languages: tuple[str, ...] = ("en", "zh")) -> Files:
    """All that is generated, where the texts are said in turn."""
    turns = itertools.cycle(say)
    specifications = filled(lambda: next(turns), folder, languages)
    return {
        path: content.decode("utf-8") for path, content in generate([specifications], target_names(), {}).files.items()
    }


@pytest.fixture(scope="module")
def harmless_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("harmless")


@pytest.fixture(scope="module")
def harmless(harmless_folder: Path) -> Files:
    return made([HARMLESS], harmless_folder, ("en",))


@pytest.fixture(scope="module")
def shown(harmless_folder: Path, harmless: Files) -> str:
    """What the terminal shows of a command with harmless texts."""
    text = _shown(harmless_folder)
    assert text.count(HARMLESS) > 8
    return text


def test_javascript_reads_hostile_texts(tmp_path: Path) -> None:
    """All of them at once: the titles of the module are the texts of the spec, and the comments are only comments."""
    files = made(HOSTILE, tmp_path)
    for path in (path for path in files if path.startswith("javascript/")):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(files[path], "utf-8")
    (texts,) = tmp_path.glob("javascript/*/*.texts.js")
    module = json.dumps(texts.as_uri().replace(".texts", ""))
    found = run_node(f"""
        await import({module});
        const {{ TEXTS }} = await import({json.dumps(texts.as_uri())});
        console.log(JSON.stringify(TEXTS));""")
    assert not re.search(
        r"[^\n -~]|[<>]", "".join(line for line in files[texts.relative_to(tmp_path).as_posix()].splitlines()[2:])
    )
    shown = set(_strings(json.loads(found)))
    assert len(shown & {" ".join(text.split()) for text in HOSTILE} | shown & set(HOSTILE)) > 20


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (list, dict)):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _strings(one)


def test_every_text_of_the_language_is_filled() -> None:
    assert filled_fields() == text_fields()
    assert {"CommandSpec.notes", "TypeSpec.differs", "AddressSpec.title", "GoldenFrameSpec.note"} <= filled_fields()


@pytest.mark.parametrize("text", sampled(HOSTILE, 3))
def test_hostile_texts_stay_text_in_every_output(text: str, harmless: Files, shown: str, tmp_path: Path) -> None:
    """In generated files, on pages and in a terminal."""
    hostile = made([text], tmp_path, ("en",))
    assert _shown(tmp_path) == shown.replace(HARMLESS, " ".join(text.split()))
    assert list(hostile) == list(harmless)
    assert [path for path, content in hostile.items() if not _same_file(path, content, harmless[path])] == []
    assert _same_pages(hostile, harmless, text)


def _same_file(path: str, hostile: str, harmless: str) -> bool:
    """Whether a file that is no page says the same to those that it is for."""
    same = {
        "h": _same_c,
        "hpp": _same_c,
        "c": _same_c,
        "ino": _same_c,
        "py": _same_python,
        "dbc": _same_dbc,
        "lua": _same_lua,
        "js": _same_javascript,
        "ts": _same_c,
        "md": _any_page,
        "html": _same_html,
        "json": _same_json,
    }
    return same.get(path.rsplit(".", 1)[-1], _equal)(hostile, harmless)


def _same_html(hostile: str, harmless: str) -> bool:
    """The same page around data of the same shape."""
    if 'id="data">' not in harmless:
        return _equal(hostile, harmless)
    (page, data, rest), (other, other_data, other_rest) = (
        (start, *end.split("</script>", 1))
        for start, _, end in (t.partition('id="data">') for t in (hostile, harmless))
    )
    return (page, rest) == (other, other_rest) and _blank(json.loads(data)) == _blank(json.loads(other_data))


def _any_page(hostile: str, harmless: str) -> bool:
    return True


def _equal(hostile: str, harmless: str) -> bool:
    return _without_hash(hostile) == _without_hash(harmless)


def _without_hash(text: str) -> str:
    return re.sub(r"[0-9a-f]{12,64}|\b0x[0-9a-f]{8}u\b", "", text)


def _same_c(hostile: str, harmless: str) -> bool:
    return _words(hostile) == _words(harmless)


@functools.cache
def _words(source: str) -> list[str]:
    """The words of a source without its comments, as a compiler sees them: trigraphs and line ends first."""
    for trigraph, meant in zip(
        ("??/", "??=", "??'", "??(", "??)", "??!", "??<", "??>", "??-"), "\\#^[]|{}~", strict=True
    ):
        source = source.replace(trigraph, meant)
    return _without_hash(re.sub(r"/\*.*?\*/|//[^\n]*", " ", source.replace("\\\n", ""), flags=re.S)).split()


def _same_python(hostile: str, harmless: str) -> bool:
    return _tree(hostile) == _tree(harmless)


@functools.cache
def _tree(source: str) -> str:
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


def _same_lua(hostile: str, harmless: str) -> bool:
    return _lua_tokens(hostile) == _lua_tokens(harmless)


@functools.cache
def _lua_tokens(source: str) -> str:
    """A source that Lua compiles, without the contents of its literals and without layout."""
    assert lua54.LuaRuntime().compile(source)
    literals = re.sub(r'"(?:[^"\\]|\\.)*"', '""', _without_hash(source))
    return re.sub(r",?}", "}", "".join(literals.split()))


def _same_json(hostile: str, harmless: str) -> bool:
    return _blank(json.loads(hostile)) == _blank(json.loads(harmless))


def _blank(value: object) -> object:
    """The structure of a value, with its numbers and names, without the texts."""
    if isinstance(value, dict):
        return {name: _blank(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_blank(one) for one in value]
    return "" if isinstance(value, str) else value


def _same_javascript(hostile: str, harmless: str) -> bool:
    return _javascript_tokens(hostile) == _javascript_tokens(harmless)


@functools.cache
def _javascript_tokens(source: str) -> str:
    """A source without the contents of its literals and without layout; all spec text is in ASCII literals."""
    literals = re.sub(r'"(?:[^"\\<>]|\\.)*"', '""', _without_hash(source))
    return re.sub(r",?([}\]])", r"\1", "".join(re.sub(r"^//.*", "", literals).split()))


def _same_dbc(hostile: str, harmless: str) -> bool:
    return _loaded(hostile) == _loaded(harmless)


@functools.cache
def _loaded(source: str) -> list[object]:
    database = cantools.database.load_string(source, "dbc")
    assert isinstance(database, cantools.database.can.Database)
    nodes = [node.name for node in database.nodes]
    return [nodes] + [
        (
            m.frame_id,
            m.name,
            m.length,
            m.senders,
            [
                (
                    s.name,
                    s.start,
                    s.length,
                    s.scale,
                    s.offset,
                    s.unit,
                    s.minimum,
                    s.maximum,
                    s.choices and sorted(s.choices),
                    s.multiplexer_ids,
                    s.is_signed,
                    s.byte_order,
                )
                for s in m.signals
            ],
        )
        for m in database.messages
    ]


LAST = "A *last* paragraph."
"""Changes when a text does not end where its block does."""


def _same_pages(hostile: Files, harmless: Files, text: str) -> bool:
    """Whether the pages have the same elements, and show the text wherever the others show the harmless one.

    Blocks that are the same in both are left out, as rendering takes most of the time.
    """
    shown = " ".join(text.split())
    pages = _blocks(hostile), _blocks(harmless)
    common = {*pages[0]} & {*pages[1]}
    sources = ["\n\n".join([*(block for block in blocks if block not in common), LAST]) for blocks in pages]
    for renderer in (_by_site, _by_every_extension, _by_commonmark):
        one, other = (_page(renderer(source)) for source in sources)
        if one.elements != other.elements or one.text.split() != other.text.replace(HARMLESS, shown).split():
            return False
    return True


def _blocks(files: Files) -> list[str]:
    """The blocks of all pages, each once."""
    pages = (content for path, content in files.items() if path.endswith(".md"))
    return list(dict.fromkeys(block for page in pages for block in page.split("\n\n")))


@functools.cache
def _by_site(text: str) -> str:
    return str(create_md_parser(MdParserConfig(gfm_only=True), RendererHTML).render(text))


EVERY_EXTENSION = (
    *("tables", "toc", "attr_list", "md_in_html"),
    *("footnotes", "abbr", "admonition", "def_list", "wikilinks", "fenced_code", "sane_lists"),
    *("pymdownx." + name for name in ("emoji", "details", "tabbed", "caret", "tilde", "mark", "critic", "keys")),
    *("pymdownx." + name for name in ("arithmatex", "magiclink", "tasklist", "inlinehilite", "betterem", "snippets")),
)


@functools.cache
def _by_every_extension(text: str) -> str:
    """As a site shows it that has every extension turned on that gives words or signs a meaning."""
    return _every_extension().reset().convert(text)


@functools.cache
def _every_extension() -> markdown.Markdown:
    return markdown.Markdown(extensions=EVERY_EXTENSION)


@functools.cache
def _by_commonmark(text: str) -> str:
    return str(MarkdownIt("commonmark").enable("table").render(text))


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


@each_compiler
def test_hostile_texts_do_not_change_compiled_headers(compiler: Compiler, tmp_path: Path) -> None:
    """All hostile texts at once, from another one on in each turn, so that they meet different places."""
    objects = [_object([HARMLESS], compiler, tmp_path / "harmless")]
    objects += [_object(HOSTILE[n:] + HOSTILE[:n], compiler, tmp_path / str(n)) for n in (0, 31)]
    assert objects[1:] == objects[:1] * 2


def _object(say: Sequence[str], compiler: Compiler, folder: Path) -> bytes:
    turns = itertools.cycle(say)
    specifications = [filled(lambda: next(turns), folder)]
    include = write(specifications, folder) / "include"
    (folder / "all.c").write_text(everything(include, headers(specifications)), "utf-8")
    flags = (*WARNINGS, "-Wcomment", "-O2", "-g0")  # zig adds debug information by default: paths and line numbers
    compiler.run("c99", *flags, f"-I{include}", "-c", folder / "all.c", "-o", folder / "all.o")
    return (folder / "all.o").read_bytes()


def _shown(folder: Path) -> str:
    """What the terminal shows of a command."""
    arguments = ["show", "dim", "--spec", str(folder / "lamp.yaml")]
    result = CliRunner(env={"COLUMNS": "2000"}).invoke(main, arguments, catch_exceptions=False)
    assert result.exit_code == 0
    return " ".join(result.output.split())


@pytest.mark.parametrize("text", REFUSED, ids=ascii)
def test_texts_with_invisible_characters_are_rejected(text: str, tmp_path: Path) -> None:
    """As it is and as an escape, in the text, in a comment, and in a key."""
    plain, escaped = f'"{text}"', '"' + "".join(f"\\U{ord(c):08X}" for c in text) + '"'
    places = ("title: X\n" + SPEC, SPEC.replace("notes: []", "X: []"))
    specs = [place.replace("X", one) for place in places for one in (plain, escaped)]
    for spec in (*specs, f"{SPEC}# {text}\n"):
        (tmp_path / "x.yaml").write_bytes(spec.encode("utf-8"))
        with pytest.raises(SpecError) as refused:
            load(tmp_path / "x.yaml")
        assert "unsafe-character" in {d.rule for d in refused.value.diagnostics}
        assert all(c.isprintable() for c in str(refused.value).replace("\n", ""))
