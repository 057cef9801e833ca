"""The documentation site: MkDocs with Material, strict, in all languages, without external requests."""

from __future__ import annotations

import html
import importlib.util
import json
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import yaml

from ..output.writer import Content, refuse_occupied, write

LANGUAGES = {"en": "English", "zh": "中文"}
_TARGET = "site"
_PAGES = ("bus", "types", "parameters", "errata", "changes")
_ACROSS = ("support.md", "new-edition.md", "assurance.md")
_COMMANDS = {"en": "Commands", "zh": "命令"}
EXTENSIONS = ["tables", "toc", "attr_list", "md_in_html"]
_NEEDED = {"mkdocs": "mkdocs<2", "material": "mkdocs-material<10", "mkdocs_static_i18n": "mkdocs-static-i18n<2"}
"""Modules and the packages that contain them, with the limits of `pyproject.toml`."""


_THEME = """{% extends "base.html" %}
{% block extrahead %}<style>
.md-grid { max-width: 80rem }
.md-typeset table:not([class]) :is(td, th) { padding: .5em .7em; min-width: 3.6em }
.md-typeset table:not([class]) code { white-space: nowrap }
@media (max-width: 99.9em) { .md-main__inner:has(th:nth-child(5)) .md-sidebar--secondary { display: none } }
@media (max-width: 44.9em) {
  .md-typeset table:has(th:nth-child(5)) :is(td, th):first-child {
    position: sticky; left: 0; z-index: 1; background: var(--md-default-bg-color) }
  {% if page and "/commands/" in page.file.src_uri %}
  .md-typeset table:not([class]) :is(td, th) { min-width: 5em }
  .md-typeset table:not([class]):has(th:nth-child(3)) td:last-child:not(:empty) { min-width: 12em }
  {% endif %}
  {% if page and page.file.name in ("changes", "support", "new-edition", "assurance") %}
  .md-typeset table:not([class]) td:first-child { min-width: 9em }
  .md-typeset table:not([class]) td code { white-space: normal; overflow-wrap: anywhere }
  {% endif %}
}
</style>{% endblock %}
"""
"""Styles for wide tables: a wider page, a table of contents only on wide screens, no line breaks in numbers.

On a phone, the first column stays visible while the others scroll.
"""


_WORDS = r"[\s\-\u200b]+|(?<=[\u3400-\u9fff])|(?=[\u3400-\u9fff])"
"""Word separators of the search. Chinese has no spaces, so each Chinese character is a word."""


_ROW = re.compile(r"^\|[^|]*\| (\[(?:[^|\\]|\\.)*\]\([^)|]+\))<br>((?:[^|\\]|\\.)*) \|", re.MULTILINE)
"""A command in the table of the overview: code; name with link, title, and links to entries."""

_LINK = re.compile(r"\[((?:[^\]\\]|\\.)*)\]\(([^)]+\.md)\)")


class SiteError(Exception):
    """An error that prevents building the site."""


def build(docs: Path, site: Path, *, force: bool = False) -> None:
    """Builds the pages below `docs` into `site`, an empty folder or an earlier site, which is replaced at the end.

    Raises SiteError, also for broken links, and OutputError for other files in `site`. `force` overwrites only pages
    that were edited by hand.
    """
    refuse_occupied(site, (_TARGET,))
    if docs.resolve() in (site.resolve(), *site.resolve().parents):
        raise SiteError(f"{site.as_posix()} contains the pages; write another folder with --out")
    languages = [name for name in LANGUAGES if (docs / name / "index.md").is_file()]
    if not languages:
        raise SiteError(f"there are no pages in {docs.as_posix()}; run `canwright generate --target docs` first")
    missing = [package for module, package in _NEEDED.items() if importlib.util.find_spec(module) is None]
    if missing:
        raise SiteError(f"required packages are not installed; run: pip install {shlex.join(missing)}")
    with tempfile.TemporaryDirectory() as folder:
        config, theme, built = (Path(folder) / name for name in ("mkdocs.yml", "theme", "site"))
        theme.mkdir()
        (theme / "main.html").write_text(_THEME, "utf-8")
        settings = _config(docs, built, theme, languages)
        config.write_text(yaml.safe_dump(settings, allow_unicode=True, sort_keys=False), "utf-8")
        command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", str(config)]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise SiteError(f"mkdocs failed:\n{result.stdout}{result.stderr}")
        _name_editions(built / "search/search_index.json", docs, languages)
        files = {f.relative_to(built).as_posix(): f.read_bytes() for f in sorted(built.rglob("*")) if f.is_file()}
    write(site, Content((), (_TARGET,), files, alone=True), force=force)


def _name_editions(index: Path, docs: Path, languages: list[str]) -> None:
    """Adds the edition to the page titles of the search, because a command has a page for each edition."""
    search = json.loads(index.read_text("utf-8"))
    for page in search["docs"]:
        folders = Path(page["location"]).parts
        edition = next(iter(folders[1:] if folders[:1] in {(name,) for name in languages} else folders), "")
        if (docs / languages[0] / edition).is_dir() and edition not in page["title"] and "#" not in page["location"]:
            page["title"] += f" · {edition}"
    index.write_text(json.dumps(search, ensure_ascii=False, separators=(",", ":")), "utf-8")


def _config(docs: Path, site: Path, theme: Path, languages: list[str]) -> dict[str, Any]:
    return {
        "site_name": "canwright",
        "docs_dir": str(docs.resolve()),
        "site_dir": str(site),
        "theme": {
            "name": "material",
            "custom_dir": str(theme),
            "font": False,
            "features": ["navigation.indexes", "navigation.top", "navigation.footer", "content.code.copy"],
            "palette": [
                {"media": "(prefers-color-scheme: light)", "scheme": "default", "toggle": _toggle("night")},
                {"media": "(prefers-color-scheme: dark)", "scheme": "slate", "toggle": _toggle("sunny")},
            ],
        },
        "plugins": [
            {"search": {"lang": languages, "separator": _WORDS}},
            {
                "i18n": {
                    "docs_structure": "folder",
                    "reconfigure_material": True,
                    "fallback_to_default": False,
                    "languages": [
                        {
                            "locale": name,
                            "name": LANGUAGES[name],
                            "build": True,
                            "default": name == languages[0],
                            "nav": _nav(docs / name, _COMMANDS[name]),
                        }
                        for name in languages
                    ],
                }
            },
        ],
        "markdown_extensions": EXTENSIONS,
        "validation": {"links": {"anchors": "warn", "unrecognized_links": "warn"}},
        "extra": {"generator": False},
    }


def _toggle(icon: str) -> dict[str, str]:
    return {"icon": f"material/weather-{icon}", "name": "light / dark"}


def _nav(folder: Path, commands: str) -> list[Any]:
    """Editions with their pages, in the order of the first page; commands in the order of the overview."""
    front = _LINK.findall((folder / "index.md").read_text("utf-8"))
    nav: list[Any] = ["index.md", *(name for name in _ACROSS if (folder / name).is_file())]
    for edition in (link.removesuffix("/index.md") for _, link in front if link.endswith("/index.md")):
        pages = [f"{edition}/{name}.md" for name in _PAGES if (folder / edition / f"{name}.md").is_file()]
        rows = _ROW.findall((folder / edition / "index.md").read_text("utf-8"))
        nav.append({edition: [f"{edition}/index.md", {commands: [_item(edition, *row) for row in rows]}, *pages]})
    return nav


def _item(edition: str, link: str, description: str) -> Any:
    """A command in the menu: its page, or its title with the pages of its entries."""
    title, _, entries = description.partition("<br>")
    if entries:
        return {_shown(title): [{_shown(text): f"{edition}/{page}"} for text, page in _LINK.findall(entries)]}
    return f"{edition}/{_LINK.findall(link)[0][1]}"


def _shown(text: str) -> str:
    """A Markdown text as HTML, the format of menu titles."""
    return html.escape(html.unescape(re.sub(r"\\(.)", r"\1", text)))
