"""The site: strict, in both languages, searchable, and without a request to another host."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.folder import OutputError
from canwright.load import described
from canwright.site import SiteError, build
from click.testing import CliRunner

from .spec_texts import ROOT


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    build(ROOT / "generated/docs", folder)
    return folder


def test_both_languages_are_there_with_a_switch(site: Path) -> None:
    english = (site / "v2.35/commands/set_torque/index.html").read_text("utf-8")
    chinese = (site / "zh/v2.35/commands/set_torque/index.html").read_text("utf-8")
    assert "Torque control" in english
    assert "转矩闭环控制" in chinese
    assert 'hreflang="zh"' in english
    assert 'hreflang="en"' in chinese


def test_the_menu_has_every_command_once_in_the_order_of_the_spec(site: Path) -> None:
    page = (site / "v2.35/index.html").read_text("utf-8")
    menu = re.findall(r'<a href="commands/(\w+)/" class="md-nav__link"', page)
    assert menu == [command.name for command in described(ROOT / "spec/mwd_motor/v2.35.yaml").edition.commands]


def test_search_finds_both_languages(site: Path) -> None:
    index = json.loads((site / "search/search_index.json").read_text("utf-8"))
    titles = {entry["title"].replace("\u200b", "") for entry in index["docs"]}
    assert {"Torque control", "转矩闭环控制"} <= titles


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
    for page in site.rglob("index.html"):
        for link in re.findall(r'<a [^>]*href="([^"#?:]+)[#"]', page.read_text("utf-8")):
            found = (page.parent / link).resolve() if not link.startswith("/") else site / link.lstrip("/")
            assert found.is_file() or (found / "index.html").is_file(), f"{page.relative_to(site)}: {link}"


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


def test_no_pages_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match="canwright generate --target docs"):
        build(tmp_path / "docs", tmp_path / "site")
