"""The site: strict, in both languages, searchable, and without a request to another host."""

from __future__ import annotations

import html
import json
import os
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.output.paths import OutputError
from canwright.project import site as site_module
from canwright.project.loader import spec_files, specification
from canwright.project.site import SiteError, build
from canwright.targets import docs
from click.testing import CliRunner

from ..spec_texts import MINIMAL, ROOT


def pages_of(specs: Sequence[Path], folder: Path) -> Path:
    """A folder with the pages of some specs."""
    for page in docs.generate([specification(spec) for spec in specs], {}):
        file = folder / page.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(page.text, "utf-8")
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    build(pages_of(spec_files(ROOT / "spec"), folder / "docs"), folder / "site")
    return folder / "site"


def test_both_languages_are_there_with_a_switch(site: Path) -> None:
    english = (site / "v2.35/commands/set_torque/index.html").read_text("utf-8")
    chinese = (site / "zh/v2.35/commands/set_torque/index.html").read_text("utf-8")
    assert "Torque control" in english
    assert "转矩闭环控制" in chinese
    assert 'hreflang="zh"' in english
    assert 'hreflang="en"' in chinese


@pytest.mark.parametrize("language", ["", "zh/"])
@pytest.mark.parametrize("edition", ["v2.35", "v2.36-2025-03"])
def test_the_menu_has_every_command_once_in_the_order_of_the_spec(site: Path, language: str, edition: str) -> None:
    page = (site / f"{language}{edition}/index.html").read_text("utf-8")
    menu = re.findall(r'<a href="commands/(\w+)/" class="md-nav__link"', page)
    assert menu == [command.name for command in specification(ROOT / f"spec/mwd_motor/{edition}.yaml").edition.commands]


def test_nothing_on_a_page_has_the_same_anchor(site: Path) -> None:
    for page in site.rglob("v2.36-2025-03/**/*.html"):
        found = Counter(re.findall(r'<\w[^>]* id="([^"]+)"', page.read_text("utf-8")))
        assert not [name for name, count in found.items() if count > 1], page


def test_search_finds_both_languages(site: Path) -> None:
    index = json.loads((site / "search/search_index.json").read_text("utf-8"))
    titles = [entry["title"].replace("\u200b", "") for entry in index["docs"] if "#" not in entry["location"]]
    for edition in ("v2.35", "v2.35-2024-02", "v2.36-2024-11", "v2.36-2025-03"):
        assert {f"Torque control · {edition}", f"转矩闭环控制 · {edition}"} <= {*titles}
    assert len(titles) == len({*titles}), "two pages that a reader of the results cannot tell apart"


def test_search_finds_any_part_of_a_chinese_word(site: Path) -> None:
    index = json.loads((site / "search/search_index.json").read_text("utf-8"))
    found = re.split(index["config"]["separator"], "set_torque 转矩\u200b闭环, PID-参数")
    assert [word for word in found if word] == ["set_torque", *"转矩闭环", ",", "PID", *"参数"]


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    loading = re.compile(r"""<(?:script|img|link|iframe|source)\b[^>]*\b(?:src|href)=["']?(?:https?:)?//[^"'\s>]+""")
    for page in site.rglob("*.html"):
        found = [tag for tag in loading.findall(page.read_text("utf-8")) if 'rel="canonical"' not in tag]
        assert not found, f"{page.name}: {found}"
    for style in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(?:https?:)?//", style.read_text("utf-8")), style.name


def test_every_link_of_the_site_leads_somewhere(site: Path) -> None:
    there = {str(file) for file in site.rglob("*") if file.is_file()}
    for page in site.rglob("index.html"):
        for link in {*re.findall(r'<a [^>]*href="([^"#?:]+)[#"]', page.read_text("utf-8"))}:
            found = os.path.normpath(f"{page.parent}/{link}" if not link.startswith("/") else f"{site}{link}")
            assert {found, f"{found}/index.html"} & there, f"{page.relative_to(site)}: {link}"


HOSTILE = "A <b>| [x](y)</b> {{ 7*7 }}"


def test_the_menu_of_a_language_has_its_own_editions_and_texts_as_texts(tmp_path: Path) -> None:
    index = "    index: {at: 1, raw: u8}\n    entries:\n      gain: {index: 1, layout: {gain: {at: 2, raw: u8}}, title: T}\n"
    table = (
        MINIMAL + "  read: {code: 0x20, manual: '2', table: gains, reply: entry, title: T}\ntables:\n  gains:\n" + index
    )
    both = table.replace("edition: v1", "edition: v2\nlanguages: [en, zh]")
    specs = {
        "v1": table.replace("title: T", f"title: '{HOSTILE}'"),
        "v2": both.replace("title: T", f"title: {{en: '{HOSTILE}', zh: '{HOSTILE} 二'}}"),
    }
    for name, text in specs.items():
        (tmp_path / f"{name}.yaml").write_text(text, "utf-8")
    build(pages_of([tmp_path / f"{name}.yaml" for name in specs], tmp_path / "docs"), tmp_path / "site")
    shown = html.escape(HOSTILE, quote=False)
    for page, wanted in (("v2/index.html", ["v1", shown, "v2"]), ("zh/v2/index.html", ["v2", f"{shown} 二"])):
        found = re.findall(
            r'<span class="md-ellipsis">\s*(.*?)\s*</span>', (tmp_path / "site" / page).read_text("utf-8")
        )
        menu = [text for text in found if text in {"v1", "v2"} or "<b>" in text or "&lt;" in text]
        assert list(dict.fromkeys(menu)) == wanted
    assert not (tmp_path / "site/zh/v1").exists()


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A folder with the pages of a small site, and the site that was made of them."""
    pages = tmp_path / "docs/en"
    pages.mkdir(parents=True)
    (pages / "index.md").write_text("# Editions\n\n[more](new-edition.md)\n")
    (pages / "new-edition.md").write_text("# More\n")
    build(tmp_path / "docs", tmp_path / "site")
    return tmp_path


def files(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


def test_a_new_site_replaces_the_earlier_one_and_no_file_of_the_user(small: Path) -> None:
    mine = small / "site/mine.txt"
    mine.write_text("mine\n")
    (small / "docs/en/index.md").write_text("# Only page\n")
    (small / "docs/en/new-edition.md").unlink()
    build(small / "docs", small / "site")
    assert "Only page" in (small / "site/index.html").read_text("utf-8")
    assert not (small / "site/new-edition").exists()
    assert mine.read_text() == "mine\n"


def test_a_page_that_was_edited_stays_until_forced(small: Path) -> None:
    page = small / "site/index.html"
    page.write_text("edited")
    with pytest.raises(OutputError, match=r"index\.html was edited by hand"):
        build(small / "docs", small / "site")
    assert page.read_text() == "edited"
    build(small / "docs", small / "site", force=True)
    assert "Editions" in page.read_text("utf-8")


def test_a_broken_link_stops_it_and_the_earlier_site_stays(small: Path) -> None:
    before = files(small / "site")
    (small / "docs/en/index.md").write_text("# Editions\n\n[gone](nowhere.md)\n")
    with pytest.raises(SiteError, match=r"nowhere\.md"):
        build(small / "docs", small / "site")
    assert files(small / "site") == before


@pytest.mark.parametrize("name", [".", "mine", "linked", "generated", "generated/docs/site"])
def test_a_folder_with_other_files_is_refused_and_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for file in ("mine/index.html", "generated/.canwright.json", "generated/docs/en/index.md"):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        Path(file).write_text('{"editions": {"docs": []}, "files": {}}')
    Path("empty").mkdir()
    Path("linked").symlink_to("empty")
    before = files(tmp_path)
    result = CliRunner().invoke(main, ["site", "--out", name], catch_exceptions=False)
    assert result.exit_code == 2
    assert "--out" in result.stderr
    assert files(tmp_path) == before


def test_what_is_not_installed_is_named_as_pip_knows_it(small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(site_module._NEEDED, "no_such_module", "no-such-package")
    with pytest.raises(SiteError, match=r"run: pip install no-such-package$"):
        build(small / "docs", small / "site")
    (wanted,) = re.findall(r"(?m)^site = (.*)$", (ROOT / "pyproject.toml").read_text("utf-8"))
    named = [package for package in site_module._NEEDED.values() if package != "no-such-package"]
    assert named == [re.sub(r">=.*<", "<", one) for one in re.findall(r'"([^"]+)"', wanted)]


def test_no_pages_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match="canwright generate --target docs"):
        build(tmp_path / "docs", tmp_path / "site")
