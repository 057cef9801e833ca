"""The files of the site beside its pages: the outputs of other targets, and pages that are no Markdown."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest
from canwright.output.writer import Content, write
from canwright.project.site import build

GENERATED = {
    "docs/site.json": '{"synonyms": [], "stops": [], "questions": [], "editions": []}',
    "docs/en/index.md": "# Home\n\n| [packed](../../dbc/) | [gone](../../c/) |\n| --- | --- |\n\n- [single](../../dbc/)\n\n"
    "[tool](tool.html) [explorer](../../javascript/explorer/index.html)\n\n"
    "<!-- Not on the site, which has a switch. -->\nfor code hosts\n\nfor all\n\n"
    "<!-- On the site: the documents to hand over. -->\n",
    "docs/en/tool.html": "<title>Tool</title>",
    "dbc/a & b.dbc": "VERSION",
    "dbc/README.md": "# Read",
    "javascript/explorer/index.html": "<title>Explorer</title>",
}


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """The site of a generated folder to which a user added a file."""
    files = {path: text.encode() for path, text in GENERATED.items()}
    write(tmp_path / "generated", Content((), ("docs", "dbc", "javascript"), files))
    (tmp_path / "generated/dbc/mine.dbc").write_text("mine")
    documents = {f"lamp-v1-{language}.{suffix}": b"one" for language in ("en", "zh") for suffix in ("csv", "html")}
    write(tmp_path / "handover", Content((), ("handover",), documents, alone=True))
    (tmp_path / "handover/mine.html").write_text("mine")
    build(tmp_path / "generated/docs", tmp_path / "site", tmp_path / "handover")
    return tmp_path / "site"


def test_generated_folders_are_packed_and_no_file_of_the_user(site: Path) -> None:
    with zipfile.ZipFile(site / "downloads/dbc.zip") as archive:
        assert archive.namelist() == ["dbc/README.md", "dbc/a & b.dbc"]
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    files = sorted(file.relative_to(site).as_posix() for file in (site / "downloads").rglob("*.*"))
    documents = [f"downloads/handover/lamp-v1-{name}" for name in ("en.csv", "en.html", "zh.csv", "zh.html")]
    assert files == ["downloads/dbc.zip", "downloads/dbc/a & b.dbc", *documents, "downloads/javascript.zip"]


def test_links_lead_to_the_files_of_the_site(site: Path) -> None:
    text = (site / "en/index.html").read_text("utf-8")
    for link in (
        "../downloads/dbc.zip",
        "../downloads/dbc/a%20%26%20b.dbc",
        "tool.html",
        "../explorer/index.html?lang=en",
    ):
        assert f'href="{link}"' in text, link
    assert (site / "en/tool.html").read_text() == "<title>Tool</title>"
    assert "gone" in text
    assert "/c.zip" not in text


def test_the_documents_in_the_language_of_a_page_are_listed(site: Path, tmp_path: Path) -> None:
    links = re.findall(
        r'<a [^>]*href="../downloads/handover/([^"]+)">(\w+)</a>', (site / "en/index.html").read_text("utf-8")
    )
    assert links == [("lamp-v1-en.csv", "CSV"), ("lamp-v1-en.html", "HTML")]
    build(tmp_path / "generated/docs", tmp_path / "without", tmp_path / "none")
    assert not (tmp_path / "without/downloads/handover").exists()
    assert "handover" not in (tmp_path / "without/en/index.html").read_text("utf-8")


def test_lines_for_code_hosts_are_not_in_the_site(site: Path) -> None:
    text = (site / "en/index.html").read_text("utf-8")
    assert "for code hosts" not in text
    assert "for all" in text
