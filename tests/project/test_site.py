"""The site: strict, in both languages, and without a request to another host; tests in a browser are beside it."""

from __future__ import annotations

import functools
import importlib
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest
from canwright.cli import main
from canwright.output.paths import OutputError
from canwright.output.writer import Content, write
from canwright.project.loader import specification
from canwright.project.site import SiteError, build
from canwright.project.site.build import NEEDED
from canwright.project.site.markdown import heading_ids
from canwright.targets.base import EditionInput
from canwright.targets.docs.target import DocsTarget
from click.testing import CliRunner

from ..spec_texts import ROOT, SPECS
from ..untrusted.everything import filled
from ..untrusted.hostile import HARMLESS


def pages_of(specifications: Sequence[EditionInput], folder: Path) -> Path:
    """A folder with the pages of some specs."""
    for page in DocsTarget().generate(specifications, {}):
        file = folder / page.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(page.text, "utf-8")
    return folder


class Page(HTMLParser):
    """The elements of a page with their attributes, and its text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, Mapping[str, str | None]]] = []
        self.text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text.append(data)

    def all(self, tag: str, attribute: str) -> list[str]:
        """The values of an attribute of all elements with a tag."""
        return [value for name, attributes in self.elements if name == tag and (value := attributes.get(attribute))]

    @functools.cached_property
    def ids(self) -> set[str | None]:
        return {attributes.get("id") for _, attributes in self.elements}


@functools.cache
def page(file: Path) -> Page:
    return Page(file.read_text("utf-8"))


OLD, NEW = "v2-2024-02", "v3"
"""The editions of the shared site. The new one has a text about `set_volume` and no command `read_drift`."""


@pytest.fixture(scope="module")
def specifications(tmp_path_factory: pytest.TempPathFactory) -> list[EditionInput]:
    """Two editions of one small family in two languages."""
    old = ROOT / f"tests/specs/mixer/{OLD}.yaml"
    text = re.sub(r"  read_drift:\n(?:    .*\n)+", "", old.read_text("utf-8"))
    text = text.replace(f"edition: {OLD}", f"edition: {NEW}")
    text = text.replace("  set_volume:\n", "  set_volume:\n    about: {en: For one desk., zh: 用于单台。}\n")
    new = tmp_path_factory.mktemp("mixer") / f"{NEW}.yaml"
    new.write_text(text, "utf-8")
    return [specification(old), specification(new)]


@pytest.fixture(scope="module")
def site(specifications: list[EditionInput], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Their site, with a frame explorer; tests only read it."""
    return complete_site(specifications, tmp_path_factory.mktemp("site"))


def complete_site(specifications: Sequence[EditionInput], folder: Path) -> Path:
    """The site of some specs, with a frame explorer."""
    (folder / "javascript/explorer").mkdir(parents=True)
    (folder / "javascript/explorer/index.html").write_text("<title>Explorer</title>")
    build(pages_of(specifications, folder / "docs"), folder / "site")
    return folder / "site"


def test_title_description_and_switches_of_a_page(site: Path) -> None:
    english, chinese = (page(site / language / NEW / "commands/set_volume.html") for language in ("en", "zh"))
    assert "0x11 Set volume, v3 · canwright" in english.text
    assert "0x11 设定音量, v3 · canwright" in chinese.text
    descriptions = [a["content"] for tag, a in english.elements if tag == "meta" and a.get("name") == "description"]
    assert descriptions == ["For one desk."]
    (switch,) = (a["href"] for tag, a in english.elements if tag == "a" and a.get("hreflang") == "zh")
    assert switch == "../../../zh/v3/commands/set_volume.html"


def test_pages_have_no_label_in_another_language(site: Path) -> None:
    chinese = page(site / "zh" / NEW / "commands/set_volume.html")
    labels = [a["aria-label"] for _, a in chinese.elements if a.get("aria-label")]
    titles = re.findall(r"<symbol.*?<title>(.*?)</title>", (site / "zh/index.html").read_text("utf-8"), re.DOTALL)
    assert len(titles) > 5
    assert [text for text in [*labels, *titles] if text and not re.search("[\u4e00-\u9fff]", text)] == []


def test_the_switch_of_editions_leads_to_the_same_page_or_to_the_first(site: Path) -> None:
    for command, target in (("set_volume", "commands/set_volume.html"), ("read_drift", "index.html")):
        text = (site / "en" / OLD / f"commands/{command}.html").read_text("utf-8")
        switch = text.partition('<nav class="site-editions"')[2].partition("</nav>")[0]
        assert re.findall(r'href="([^"]+)"', switch) == ["#", f"../../{NEW}/{target}"]


def test_the_menu_has_every_command_of_its_edition_once_with_its_code(
    site: Path, specifications: list[EditionInput]
) -> None:
    ids = {"clock": "0x400", "time_left": "0x401"}
    for item in specifications:
        text = (site / "en" / item.edition.name / "index.html").read_text("utf-8")
        menu = re.findall(
            r'<li class="toctree-l2"><a class="reference internal" href="commands/(\w+)\.html">(?:<code>(\w+)</code> )?',
            text,
        )
        codes = [(c.spec_name, f"0x{c.code:02X}" if c.code is not None else ids[c.name]) for c in item.edition.commands]
        assert menu == codes


def test_languages_have_the_same_anchors_and_none_twice(site: Path) -> None:
    files = sorted((site / "en").rglob("*.html"))
    assert len(files) > 40
    for file in files:
        ids = {}
        for language in ("en", "zh"):
            translation = site / language / file.relative_to(site / "en")
            if translation.is_file():
                ids[language] = [
                    a["id"] for tag, a in page(translation).elements if a.get("id") and tag in ("section", "span")
                ]
        assert len({tuple(listed) for listed in ids.values()}) == 1, file
        assert [name for name, count in Counter(ids["en"]).items() if count > 1] == [], file


def broken_links(site: Path) -> list[str]:
    """Links of a site to a page or an anchor that does not exist; after `#` of the explorer follows a frame."""
    broken = []
    for file in site.rglob("*.html"):
        for link in {*page(file).all("a", "href"), *page(file).all("img", "src"), *page(file).all("link", "href")}:
            path, _, anchor = link.partition("#")
            target = (file.parent / unquote(path.partition("?")[0])).resolve() if path else file.resolve()
            is_page = target.suffix == ".html" and target.parent.name != "explorer"
            if link == "data:,":  # no icon
                continue
            if not target.is_file() or (anchor and is_page and unquote(anchor) not in page(target).ids):
                broken.append(f"{file.relative_to(site)}: {link}")
    return broken


def test_every_link_leads_to_a_page_and_an_anchor(site: Path) -> None:
    assert broken_links(site) == []


@pytest.mark.exhaustive
def test_every_link_of_a_site_of_all_specs_leads_to_a_page_and_an_anchor(tmp_path: Path) -> None:
    assert broken_links(complete_site([specification(spec) for spec in SPECS], tmp_path)) == []


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    for file in site.rglob("*.html"):
        sources = [v for tag in ("script", "img", "iframe", "source") for v in page(file).all(tag, "src")]
        foreign = [v for v in (*sources, *page(file).all("link", "href")) if re.match(r"(https?:)?//", v)]
        assert foreign == [], file.name
    for style in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(?:https?:)?//", style.read_text("utf-8")), style.name


def test_the_index_is_a_script_with_every_record(site: Path) -> None:
    text = (site / "zh/_static/search-index.js").read_text("utf-8")
    index = json.loads(text.removeprefix("searchIndex = ").removesuffix(";\n"))
    (edition,) = (e for e in index["editions"] if e["folder"] == OLD)
    records = {(record["kind"], record["name"]) for record in edition["records"]}
    assert {("command", "set_volume"), ("field", "volume"), ("erratum", "lamp_width"), ("value", "bright")} <= records
    assert any("急停" in group and "e-stop" in group for group in index["synonyms"])
    for entry in index["editions"]:
        for record in entry["records"]:
            for name in record["pages"]:
                path, _, anchor = name.partition("#")
                found_page = page(site / "en" / entry["folder"] / f"{path}.html")
                assert not anchor or anchor in found_page.ids


def test_texts_of_a_spec_are_escaped_in_the_site(tmp_path: Path) -> None:
    """Wherever a spec has a text, also in menus and titles: the elements are those of a site with harmless texts."""
    text = "<b title='x'>1</b><script>alert(1)</script> {{ 7*7 }} {x}`y` [a](b) &lt;"
    sites = {}
    for name, said in (("hostile", text), ("harmless", HARMLESS)):
        folder = tmp_path / name
        specification = filled(functools.partial(str, said), tmp_path / f"{name}-spec", ("en",))
        build(pages_of([specification], folder / "docs"), folder / "site")
        sites[name] = {file.relative_to(folder): page(file) for file in sorted((folder / "site/en").rglob("*.html"))}
    assert list(sites["hostile"]) == list(sites["harmless"])
    for path, hostile in sites["hostile"].items():
        plain = sites["harmless"][path]
        assert [tag for tag, _ in hostile.elements] == [tag for tag, _ in plain.elements], path
        assert [{*names} for _, names in hostile.elements] == [{*names} for _, names in plain.elements], path
        if path.name != "bus-load-calculator.html":  # the data of its script is escaped
            shown = "".join(hostile.text).replace("\u200b", "")
            assert shown.count(text) == "".join(plain.text).count(HARMLESS), path
    assert sum("".join(shown_page.text).count(text) for shown_page in sites["hostile"].values()) > 100


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A folder with the pages of a small site, and the site that was made of them."""
    pages = tmp_path / "docs/en"
    pages.mkdir(parents=True)
    (tmp_path / "docs/site.json").write_text('{"synonyms": [], "stops": [], "questions": [], "editions": []}')
    (pages / "index.md").write_text("# Editions\n\n[more](new-edition.md)\n")
    (pages / "new-edition.md").write_text("# More\n")
    return tmp_path


def made(small: Path) -> str:
    """The first page of the site, built again."""
    build(small / "docs", small / "site")
    return (small / "site/en/index.html").read_text("utf-8")


@pytest.fixture
def without_sphinx(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages of the site are copies, for tests of which files are written."""

    def copy(docs: Path, folder: Path, languages: list[str], has_explorer: bool, downloads: list[str]) -> None:
        for file in (docs / "en").glob("*.md"):
            (folder / "en").mkdir(exist_ok=True)
            (folder / "en" / f"{file.stem}.html").write_bytes(file.read_bytes())

    monkeypatch.setattr(importlib.import_module("canwright.project.site.build"), "_run_sphinx", copy)


def files(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


def test_markdown_extensions_of_code_hosts_are_rendered(small: Path) -> None:
    """Alerts, anchors and links as code hosts show them; what only a text of a spec could look like remains text."""
    (small / "docs/en/index.md").write_text(
        "# A `b`: [c](new-edition.md) &amp; d\n\n> [!CAUTION]\n> The motor *moves*\n\n> [!NOTE]\n> - one\n> - two\n\n"
        "> \\[!TIP\\]\n> quoted\n\n"
        '## <a id="things.one"></a>One\n\n[to two](#things.two) [by heading](#two-1) [d](../../javascript/explorer/index.html#frame=1)\n\n'
        '## Two\n\n### <a id="things.two"></a>Two\n\n{math}`x` {{ y }} (z)=\n'
    )
    text = made(small)
    assert re.findall(r'<div class="admonition (\w+)">\s*<p class="admonition-title">(\w+)</p>\s*(<\w+)', text) == [
        ("caution", "Caution", "<p"),
        ("note", "Note", "<ul"),
    ]
    assert "The motor <em>moves</em>" in text
    assert "[!TIP]\nquoted" in text
    assert re.findall(r'<section id="([^"]+)"', text) == ["a-b-c--d", "one", "two", "two-1"]
    assert re.findall(r'href="#(\S+)">([a-z ]+)<', text) == [
        ("things.two", "to two"),
        ("two-1", "by heading"),
    ]
    assert "{math}<code" in text
    assert "{{ y }} (z)=" in text
    assert "explorer/index.html" not in text


def test_links_to_the_explorer_state_the_language(small: Path) -> None:
    """Also without a choice of the reader, whose browser may have another one."""
    (small / "docs/en/index.md").write_text("# Home\n\n[d](../../javascript/explorer/index.html#frame=1)\n")
    (small / "javascript/explorer").mkdir(parents=True)
    (small / "javascript/explorer/index.html").write_text("<title>Explorer</title>")
    text = made(small)
    assert sorted(re.findall(r'href="(\S*explorer\S*)"', text)) == [
        "../explorer/index.html?lang=en#frame=1",
        "./../explorer/index.html?lang=en",
    ]
    assert 'data-explorer="../explorer/index.html?lang=en"' in text


def test_anchors_are_those_of_code_hosts(tmp_path: Path) -> None:
    (tmp_path / "x.md").write_text(
        "# `0xA1` Torque control, v2.35\n\n```sh\n# none\n```\n\n## 请求：帧\n\n## A\n## A\n## a\\_b *c*\n"
    )
    assert list(heading_ids(tmp_path / "x.md")) == ["0xa1-torque-control-v235", "请求帧", "a", "a-1", "a_b-c"]


def test_site_with_a_dead_link_or_unknown_html_is_not_built(small: Path) -> None:
    """Links that lead nowhere, and HTML that pages do not contain."""
    links = ("nowhere.md", "new-edition.md#nowhere", "#nowhere", "nowhere.txt")
    tags = ("<b>", "<script>x</script>", '<img src="x">', '<a id="x" onclick="y">', "<br onclick=x>")
    write(small / "site", Content((), ("site",), {"en/index.html": b"earlier"}, alone=True))
    before = files(small / "site")
    lines = [*(f"[gone]({link})" for link in links), *(f"text {tag}" for tag in tags)]
    (small / "docs/en/index.md").write_text("# Editions\n\n" + "\n\n".join(lines) + "\n")
    with pytest.raises(SiteError) as error:
        build(small / "docs", small / "site")
    reported = re.findall(r"docs/en/index\.md:(\d+): WARNING: (the link|HTML)", str(error.value))
    assert {*reported} == {(str(3 + 2 * i), "the link" if i < len(links) else "HTML") for i in range(len(lines))}
    assert files(small / "site") == before


def test_new_site_replaces_the_earlier_site_only(small: Path, without_sphinx: None) -> None:
    made(small)
    (small / "site/mine.txt").write_text("mine\n")
    (small / "docs/en/index.md").write_text("# Only page\n")
    (small / "docs/en/new-edition.md").unlink()
    (small / "javascript/explorer").mkdir(parents=True)
    (small / "javascript/explorer/index.html").write_text("<title>Explorer</title>")
    assert "Only page" in made(small)
    assert not (small / "site/en/new-edition.html").exists()
    assert (small / "site/mine.txt").read_text() == "mine\n"
    assert (small / "site/explorer/index.html").is_file()


def test_edited_page_is_overwritten_only_with_force(small: Path, without_sphinx: None) -> None:
    made(small)
    edited = small / "site/en/index.html"
    edited.write_text("edited")
    with pytest.raises(OutputError, match=r"index\.html was edited by hand"):
        build(small / "docs", small / "site")
    assert edited.read_text() == "edited"
    build(small / "docs", small / "site", force=True)
    assert "Editions" in edited.read_text("utf-8")


@pytest.mark.parametrize("name", [".", "mine", "linked", "generated", "generated/docs/site"])
def test_a_folder_with_other_files_is_refused_and_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for file in (
        "mine/index.html",
        "generated/.canwright.json",
        "generated/docs/en/index.md",
        "generated/docs/site.json",
    ):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        Path(file).write_text('{"editions": {"docs": []}, "files": {}}')
    Path("generated/docs/site.json").write_text('{"synonyms": [], "stops": [], "questions": [], "editions": []}')
    Path("empty").mkdir()
    Path("linked").symlink_to("empty")
    before = files(tmp_path)
    result = CliRunner().invoke(main, ["site", "--out", name], catch_exceptions=False)
    assert result.exit_code == 2
    assert "--out" in result.stderr
    assert files(tmp_path) == before


def test_missing_package_has_the_name_that_pip_installs(small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(NEEDED, "no_such_module", "no-such-package")
    with pytest.raises(SiteError, match=r"run: pip install no-such-package$"):
        build(small / "docs", small / "site")
    (wanted,) = re.findall(r"(?m)^site = (.*)$", (ROOT / "pyproject.toml").read_text("utf-8"))
    named = [package for package in NEEDED.values() if package != "no-such-package"]
    assert named == [re.sub(r">=.*<", "<", requirement) for requirement in re.findall(r'"([^"]+)"', wanted)]


def test_no_pages_is_an_error(small: Path, tmp_path: Path) -> None:
    (small / "docs/site.json").write_text("{}")
    with pytest.raises(SiteError, match=r"site\.json .* another version .*canwright generate --target docs"):
        build(small / "docs", small / "site")
    (small / "docs/site.json").unlink()
    with pytest.raises(SiteError, match="canwright generate --target docs"):
        build(tmp_path / "docs", tmp_path / "site")
