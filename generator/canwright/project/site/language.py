"""Runs Sphinx for one language, in a process of its own: `python -m canwright.project.site.language SETTINGS`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from sphinx.application import Sphinx
from sphinx.util.console import nocolor

from ...templating.data_files import read_data
from .build import FRAMES, THEME

_LOCALES = {"en": "en", "zh": "zh_CN"}


def run(settings: dict[str, Any]) -> int:
    """Builds the pages of a language; prints warnings, which make the result 1 instead of 0."""
    nocolor()
    docs, folder, language = Path(settings["docs"]), Path(settings["folder"]), settings["language"]
    texts = read_data(THEME / "texts.yaml")[language]
    locales = folder / f"locale-{language}"
    theme = texts.pop("theme", {})
    _write_catalog(locales, _LOCALES[language], theme)
    app = Sphinx(
        srcdir=docs / language,
        confdir=None,
        outdir=folder / language,
        doctreedir=folder / f"doctrees-{language}",
        buildername="html",
        confoverrides={
            "project": "canwright",
            "language": _LOCALES[language],
            "locale_dirs": [str(locales)],
            "extensions": ["myst_parser", f"{__package__}.extension"],
            "source_suffix": {".md": "markdown"},
            "myst_gfm_only": True,
            "nitpicky": True,
            "smartquotes": False,
            "html_theme": "furo",
            "html_title": "canwright",
            "html_favicon": str(THEME / "static" / "favicon.svg"),
            "html_static_path": [str(THEME / "static"), str(FRAMES)],
            "html_css_files": ["site.css"],
            "html_js_files": [("site.js", {"defer": "defer"})],
            "html_sidebars": {"**": ["menu.html"]},
            "html_show_sourcelink": False,
            "html_copy_source": False,
            "html_use_index": False,
            "templates_path": [str(THEME)],
            "canwright_docs": str(docs),
            "canwright_language": language,
            "canwright_languages": settings["languages"],
            "canwright_has_explorer": settings["has_explorer"],
            "canwright_downloads": settings["downloads"],
            "canwright_texts": texts,
            "canwright_theme": theme,
        },
        status=None,
        warningiserror=True,
    )
    app.build(force_all=True)
    return app.statuscode


def _write_catalog(folder: Path, locale: str, texts: dict[str, str]) -> None:
    """The texts of the theme that Sphinx does not translate."""
    catalog = Catalog(locale=locale)
    for text, translated in texts.items():
        catalog.add(text, translated)
    file = folder / locale / "LC_MESSAGES" / "sphinx.mo"
    file.parent.mkdir(parents=True)
    with file.open("wb") as stream:
        write_mo(stream, catalog)


if __name__ == "__main__":
    sys.exit(run(json.loads(sys.argv[1])))
