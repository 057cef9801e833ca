"""Documents to hand over: each edition as one HTML file in each language, and its command matrix."""

from __future__ import annotations

import base64
import importlib.util
import posixpath
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..output.writer import Content, refuse_occupied, write
from ..targets.base import EditionInput
from ..targets.docs import folders, generate
from ..templating.environment import environment
from ..templating.markup import xml
from . import matrix, spreadsheets
from .words import LABELS

_TARGET = "handover"
_NEEDED = {"markdown_it": "markdown-it-py", "xlsxwriter": "XlsxWriter"}
"""Modules and the packages that contain them."""
_FIRST, _LAST = ("index", "states"), ("types", "parameters", "bus", "errata", "changes")
_SWITCH = re.compile(r"<!-- Not on the site, which has a switch. -->\n.*\n")
"""The line of a page with links to other editions, which are not in the document; as the last line, after a rule."""


class HandoverError(Exception):
    """An error that prevents making the documents."""


class Section(NamedTuple):
    """A page as a part of the document; `html` is its content."""

    anchor: str
    title: str
    html: str


def build(specifications: Sequence[EditionInput], out: Path, *, force: bool = False) -> Sequence[str]:
    """Writes the documents into `out`, a new or empty folder or that of an earlier run; returns their names.

    Raises HandoverError, and OutputError for other files in `out`.
    """
    refuse_occupied(out, (_TARGET,))
    missing = [package for module, package in _NEEDED.items() if importlib.util.find_spec(module) is None]
    if missing:
        raise HandoverError(f"required packages are not installed; run: pip install {shlex.join(missing)}")
    pages = {output.path: output.text for output in generate(specifications, {})}
    files = dict(_files(specifications, pages))
    write(out, Content((), (_TARGET,), files, alone=True), force=force)
    return sorted(files)


def _files(specifications: Sequence[EditionInput], pages: Mapping[str, str]) -> Iterator[tuple[str, bytes]]:
    template = environment("handover", {"xml": xml}).get_template("document.html.j2")
    for edition, folder in folders([one.edition for one in specifications]).items():
        for language in edition.languages:
            labels = LABELS.get(language)
            if labels is None or f"{language}/{folder}/index.md" not in pages:
                continue
            name = f"{edition.family}-{edition.name}-{language}"
            sections = _sections(pages, f"{language}/{folder}", labels)
            dated = f" ({edition.date})" if edition.date else ""
            title = f"{edition.family} {edition.name}{dated}: {edition.title[language]}"
            document = template.render(lang=language, title=title, labels=labels, sections=sections)
            yield f"{name}.html", document.encode()
            found = list(matrix.rows(edition, language))
            yield f"{name}.csv", spreadsheets.csv_text(found, labels)
            yield f"{name}.xlsx", spreadsheets.excel(found, labels, title, edition.name)


def _sections(pages: Mapping[str, str], folder: str, labels: Mapping[str, str]) -> Sequence[Section]:
    """The pages of an edition: the overview, the commands in its order, and the rest."""
    overview = pages[f"{folder}/index.md"]
    commands = dict.fromkeys(re.findall(r"\]\((commands/\w+)\.md", overview))
    names = [name for name in (*_FIRST, *commands, *_LAST) if f"{folder}/{name}.md" in pages]
    paths = {f"{folder}/{name}.md": name.replace("/", "-") for name in names}
    return [_section(path, anchor, pages, paths, labels) for path, anchor in paths.items()]


def _section(
    path: str, anchor: str, pages: Mapping[str, str], anchors: Mapping[str, str], labels: Mapping[str, str]
) -> Section:
    from markdown_it import MarkdownIt

    text = _SWITCH.sub("", pages[path]).partition("\n---\n")[0]
    html = str(MarkdownIt("commonmark", {"html": True}).enable("table").render(text))
    here = posixpath.dirname(path)

    def link(match: re.Match[str]) -> str:
        file, _, place = match[1].partition("#")
        target = posixpath.normpath(posixpath.join(here, file)) if file else path
        if target not in anchors:
            return "<a"
        return f'<a href="#{anchors[target]}{f"--{place}" if place else ""}"'

    def picture(match: re.Match[str]) -> str:
        image = pages[posixpath.normpath(posixpath.join(here, match[1]))]
        return f'<img src="data:image/svg+xml;base64,{base64.b64encode(image.encode()).decode()}"'

    html = re.sub(r'<a id="([^"]+)"', lambda match: f'<a id="{anchor}--{match[1]}"', html)
    html = re.sub(r'<a href="([^"]+)"', link, html)
    html = re.sub(r'<img src="([^"]+)"', picture, html)
    html = re.sub(
        r"<blockquote>\n<p>\[!(\w+)\]\s*(</p>)?",
        lambda match: (
            f'<blockquote class="{match[1].lower()}">\n<p><b>{labels[match[1].lower()]}</b></p>\n'
            + ("" if match[2] else "<p>")
        ),
        html,
    )
    html = html.replace("<table>", '<div class="table"><table>').replace("</table>", "</table></div>")
    title = re.search(r"<h1>(.*?)</h1>", html, re.DOTALL)
    return Section(anchor, title[1] if title else xml(anchor), html)
