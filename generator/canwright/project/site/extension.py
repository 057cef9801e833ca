"""The Sphinx extension of the site: pages as a code host shows them, and the variables of the theme."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

from .build import DATA
from .markdown import Alerts, Anchors, Documents, Links, SectionIds, TrustedHtml, explorer_page, resolve_links
from .menu import Menu

_SETTINGS = ("docs", "language", "languages", "has_explorer", "downloads", "texts", "theme")


def setup(app: Sphinx) -> Mapping[str, bool]:
    """Called by Sphinx."""
    for name in _SETTINGS:
        app.add_config_value(f"canwright_{name}", None, "")
    for transform in (TrustedHtml, Anchors, Alerts, Links, Documents, SectionIds):
        app.add_transform(transform)
    app.connect("builder-inited", _without_search_of_sphinx)
    app.connect("doctree-read", _collect)
    app.connect("doctree-resolved", _resolve)
    app.connect("env-updated", _read_menu)
    app.connect("html-page-context", _add_variables)
    app.connect("build-finished", _write_index)
    return {"parallel_read_safe": False, "parallel_write_safe": False}


def _without_search_of_sphinx(app: Sphinx) -> None:
    app.builder.search = False  # type: ignore[attr-defined]


def _collect(app: Sphinx, doctree: nodes.document) -> None:
    """Notes the links of a page, whose order is that of menus, and what the search finds: headings, texts of guides and of buses."""
    env = app.env
    page = env.metadata[env.docname]
    links = (link["page"] for link in doctree.findall(nodes.reference) if "page" in link)
    page["orphan"] = True  # menus are not made of toctrees
    page["links"] = list(dict.fromkeys(links))
    sections = list(doctree.findall(nodes.section))
    page["text"] = doctree.astext() if "/" not in env.docname or env.docname.endswith("/bus") else ""
    page["headings"] = [(section[0].astext(), section["ids"][0]) for section in sections[1:]]


def _resolve(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    assert app.builder is not None
    resolve_links(app.env, app.builder, doctree, docname)


def _read_menu(app: Sphinx, env: BuildEnvironment) -> None:
    data = json.loads((Path(app.config.canwright_docs) / DATA).read_text("utf-8"))
    titles = {name: title.astext() for name, title in env.titles.items()}
    app.canwright_menu = Menu(data, titles, env.metadata, app.config.canwright_language)  # type: ignore[attr-defined]


def _add_variables(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: nodes.document | None
) -> None:
    if doctree is None:
        return
    config = app.config
    menu: Menu = app.canwright_menu  # type: ignore[attr-defined]
    languages = [name for name in config.canwright_languages if name != config.canwright_language]
    has = {name: (Path(config.canwright_docs) / name / f"{pagename}.md").is_file() for name in languages}
    context["site"] = {
        "texts": config.canwright_texts,
        "theme": config.canwright_theme,
        "page": menu.page(pagename),
        "menu": menu,
        "languages": {name: f"../{name}/{pagename if there else 'index'}.html" for name, there in has.items()},
        "language": config.canwright_language,
        "explorer": f"../{explorer_page(config)}" if config.canwright_has_explorer else "",
    }
    before, after = menu.neighbours(pagename)
    context["prev"], context["next"] = None, None
    context["neighbours"] = {"prev": before, "next": after}


def _write_index(app: Sphinx, exception: Exception | None) -> None:
    """The search index, as a script, since a page opened from a folder cannot fetch a file."""
    if exception is None:
        menu: Menu = app.canwright_menu  # type: ignore[attr-defined]
        text = json.dumps(menu.index(), ensure_ascii=False, separators=(",", ":"))
        (Path(app.outdir) / "_static" / "search-index.js").write_text(f"searchIndex = {text};\n", "utf-8")
