"""The pages of an edition as one HTML file, without programs."""

from __future__ import annotations

import base64
import posixpath
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ...templating.data_files import template_texts
from ...templating.environment import environment
from ...templating.markup import xml

_FIRST, _LAST = ("index", "states"), ("types", "parameters", "bus", "errata", "changes")
_SWITCH = re.compile(r"<!-- Not on the site, which has a switch. -->\n.*\n")
"""The line of a page with links to other editions, which are not in the document; as the last line, after a rule."""


class Section(NamedTuple):
    """A page as a part of the document; `html` is its content."""

    anchor: str
    title: str
    html: str


def document(pages: Mapping[str, str], folder: str, language: str, title: str, labels: Mapping[str, str]) -> str:
    """The pages in a folder as one HTML file."""
    program = re.compile(
        rf"^## {re.escape(template_texts('docs/labels.yaml')[language]['program'])}\n.*?(?=^## |^---\n|\Z)", re.M | re.S
    )
    pages = {path: program.sub("", text) if path.endswith(".md") else text for path, text in pages.items()}
    template = environment("handover", {"xml": xml}).get_template("document.html.j2")
    return template.render(lang=language, title=title, labels=labels, sections=_sections(pages, folder, labels))


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
