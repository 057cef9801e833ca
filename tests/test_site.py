"""The site: strict, in both languages, searchable, and without a request to another host."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from canwright.load import described
from canwright.site import SiteError, build

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


def test_a_broken_link_stops_it(tmp_path: Path) -> None:
    docs = tmp_path / "docs"
    shutil.copytree(ROOT / "generated/docs", docs)
    page = docs / "en/v2.35/bus.md"
    page.write_text(page.read_text("utf-8") + "\n[gone](nowhere.md)\n", "utf-8")
    with pytest.raises(SiteError, match=r"nowhere\.md"):
        build(docs, tmp_path / "site")


def test_no_pages_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match="canwright generate --target docs"):
        build(tmp_path, tmp_path / "site")
