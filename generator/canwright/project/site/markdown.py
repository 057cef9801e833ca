"""What Markdown of a code host means beyond CommonMark and tables: alerts, anchors, and links that are checked."""

from __future__ import annotations

import html
import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote as quoted, unquote

from docutils import nodes
from sphinx import addnodes
from sphinx.builders import Builder
from sphinx.config import Config
from sphinx.environment import BuildEnvironment
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

from .build import DOWNLOADS, EXPLORER, HANDOVER

_ALERTS: dict[str, type[nodes.Element]] = {
    "NOTE": nodes.note,
    "TIP": nodes.tip,
    "IMPORTANT": nodes.important,
    "WARNING": nodes.warning,
    "CAUTION": nodes.caution,
}
_ALERT = re.compile(r"\s*>\s*\[!([A-Z]+)\]\s*")
_ANCHOR = re.compile(r'<a id="([\w.\-]+)">')
_TRUSTED = re.compile(r"<(?:br|/?(?:details|summary|sub|sup|kbd))>")
"""The HTML that pages may contain besides anchors and comments. Texts of a spec are escaped and contain none."""

_CODE_HOST_ONLY = "<!-- Not on the site, which has a switch. -->"
"""The line before a paragraph that the site replaces by its own navigation."""

_DOCUMENTS = "<!-- On the site: the documents to hand over. -->"
"""The line that the site replaces by links to the documents in the language of the page."""

_FENCE = re.compile(r"\s*(```|~~~)")
_FOLDER = re.compile(r"\.\./\.\./\w+")
"""A folder beside that of the pages, from the folder of a language: the output of another target."""
_HEADING = re.compile(r"#{1,6}\s+(.*)")
_LOGGER = logging.getLogger(__name__)


class TrustedHtml(SphinxTransform):
    """Removes comments, and paragraphs that are for code hosts only; reports HTML that pages do not contain.

    So no text can become part of the site as HTML.
    """

    default_priority = 200

    def apply(self, **kwargs: object) -> None:
        for raw in list(self.document.findall(nodes.raw)):
            text = raw.astext().strip()
            if text == _CODE_HOST_ONLY:
                following = raw.next_node(descend=False, siblings=True)
                if isinstance(following, nodes.paragraph):
                    following.parent.remove(following)
            if text == _DOCUMENTS:
                continue
            if text.startswith("<!--") and text.find("-->") == len(text) - 3:
                raw.parent.remove(raw)
            elif not (_TRUSTED.fullmatch(text) or _ANCHOR.fullmatch(text) or text == "</a>"):
                _LOGGER.warning("HTML is not allowed in a page: %s", text, location=raw)
                raw.replace_self(nodes.Text(text))


class Anchors(SphinxTransform):
    """Makes `<a id="NAME"></a>` a target of links."""

    default_priority = 210

    def apply(self, **kwargs: object) -> None:
        anchors = self.env.metadata[self.env.docname].setdefault("anchors", {})
        for raw in list(self.document.findall(nodes.raw)):
            match = _ANCHOR.fullmatch(raw.astext())
            if match:
                target = nodes.target("", "", ids=[match[1]], names=[match[1]])
                self.document.note_explicit_target(target)
                anchors[match[1]] = match[1]
                raw.replace_self(target)
            elif raw.astext() == "</a>":
                raw.parent.remove(raw)


class Alerts(SphinxTransform):
    """Makes quotations that start with a line `> [!WARNING]` admonitions.

    The line of the source decides: a text of a spec is escaped there, and looks like an alert only afterwards.
    """

    default_priority = 220

    def apply(self, **kwargs: object) -> None:
        quotes = list(self.document.findall(nodes.block_quote))
        lines = Path(self.document["source"]).read_text("utf-8").split("\n") if quotes else []
        for quote in quotes:
            match = _ALERT.fullmatch(lines[quote.line - 1]) if quote.line else None
            first = quote.children[0] if quote.children else None
            if match and match[1] in _ALERTS and isinstance(first, nodes.paragraph):
                del first.children[: 2 if len(first.children) > 1 else 1]
                alert = _ALERTS[match[1]]()
                alert.extend(quote.children if first.children else quote.children[1:])
                quote.replace_self(alert)


class Links(SphinxTransform):
    """Finds out where relative links lead: to a page, to a file or folder beside the pages, or to the frame explorer.

    The site has a copy of those files, and of each generated folder as a ZIP file. Only the text remains of a link to a
    folder that the site does not have.
    """

    default_priority = 230

    def apply(self, **kwargs: object) -> None:
        docname = self.env.docname
        for link in list(self.document.findall(nodes.reference)):
            path, _, anchor = unquote(link.get("refuri", ":")).partition("#")
            target = posixpath.normpath(posixpath.join(posixpath.dirname(docname), path))
            if ":" in path or path.startswith("/"):
                continue
            if target == f"../../javascript/{EXPLORER}/index.html":
                self._link_or_text(link, explorer_page(self.config) if self.config.canwright_has_explorer else "")
            elif _FOLDER.fullmatch(target):
                self._link_folder(link, target.rpartition("/")[2])
            elif not path or path.endswith(".md"):
                link["page"], link["anchor"] = (target.removesuffix(".md") if path else docname), anchor
            elif not (Path(self.env.srcdir) / target).is_file():
                _LOGGER.warning("the link leads to a file that does not exist: %s", path, location=link)
            elif not path.endswith(".html"):
                link.replace_self(addnodes.download_reference("", "", *link.children, reftarget=f"/{target}"))

    def _link_or_text(self, link: nodes.reference, file: str) -> None:
        """Makes a link lead to a file of the site, by its path from the root; without one, only the text remains."""
        if file:
            _, mark, anchor = link["refuri"].partition("#")
            link["refuri"] = posixpath.relpath(f"../{file}", posixpath.dirname(self.env.docname) or ".") + mark + anchor
        else:
            link.replace_self(link.children)

    def _link_folder(self, link: nodes.reference, folder: str) -> None:
        """A ZIP file; an item of a list becomes the list of the single files of the folder."""
        files = self.config.canwright_downloads
        item = link.parent.parent
        if isinstance(item, nodes.list_item):
            single = [file for file in files if file.startswith(f"{DOWNLOADS}/{folder}/")]
            links = [nodes.reference("", posixpath.basename(file), refuri=quoted(f"../{file}")) for file in single]
            item.append(
                nodes.bullet_list("", *(nodes.list_item("", nodes.paragraph("", "", reference)) for reference in links))
            )
            link.replace_self(link.children)
        else:
            packed = f"{DOWNLOADS}/{folder}.zip"
            self._link_or_text(link, packed if packed in files else "")


def explorer_page(config: Config) -> str:
    """The frame explorer in the language of the pages, by its path from the root."""
    return f"{EXPLORER}/index.html?lang={config.canwright_language}"


class Documents(SphinxTransform):
    """Lists the documents to hand over, where a page has the line for them."""

    default_priority = 235

    def apply(self, **kwargs: object) -> None:
        for raw in [raw for raw in self.document.findall(nodes.raw) if raw.astext().strip() == _DOCUMENTS]:
            raw.replace_self(self._documents())

    def _documents(self) -> list[nodes.Element]:
        """A list with an item for each edition; empty without documents."""
        end = f"-{self.config.canwright_language}"
        of_edition: dict[str, list[str]] = {}
        for file in self.config.canwright_downloads:
            stem, _, suffix = file.removeprefix(HANDOVER).rpartition(".")
            if file.startswith(HANDOVER) and stem.endswith(end):
                of_edition.setdefault(stem.removesuffix(end), []).append(suffix)
        items = [nodes.list_item("", self._links(name, end, suffixes)) for name, suffixes in of_edition.items()]
        return [nodes.bullet_list("", *items)] if items else []

    @staticmethod
    def _links(name: str, end: str, suffixes: list[str]) -> nodes.paragraph:
        line = nodes.paragraph("", "", nodes.Text(f"{name}: "))
        for i, suffix in enumerate(suffixes):
            file = quoted(f"../{HANDOVER}{name}{end}.{suffix}")
            line += [*([nodes.Text(" · ")] if i else []), nodes.reference("", suffix.upper(), refuri=file)]
        return line


def resolve_links(env: BuildEnvironment, builder: Builder, document: nodes.document, docname: str) -> None:
    """Makes links between pages those of the site; reports those that lead to no page or no section."""
    for link in document.findall(nodes.reference):
        page, anchor = link.get("page"), link.get("anchor", "")
        if page is None:
            continue
        anchors = env.metadata[page].get("anchors", {})
        if page not in env.all_docs:
            _LOGGER.warning("the link leads to a page that does not exist: %s.md", page, location=link)
        elif anchor and anchor not in anchors:
            _LOGGER.warning("the link leads to a section that does not exist: %s.md#%s", page, anchor, location=link)
        else:
            link["refuri"] = builder.get_relative_uri(docname, page) if page != docname else ""
            link["refuri"] += f"#{anchors[anchor]}" if anchor else ""
            link["internal"] = True


class SectionIds(SphinxTransform):
    """Gives sections the anchors that a code host gives the same page in the first language.

    All languages have the same anchors, so a link to another language stays at the section.
    """

    default_priority = 240

    def apply(self, **kwargs: object) -> None:
        sections = list(self.document.findall(nodes.section))
        own = list(heading_ids(Path(self.document["source"])))
        first = Path(self.config.canwright_docs) / self.config.canwright_languages[0] / f"{self.env.docname}.md"
        common = list(heading_ids(first))
        ids = common if len(common) == len(own) else own
        anchors = self.env.metadata[self.env.docname].setdefault("anchors", {})
        for section, host, new in zip(sections, own, ids, strict=True):
            section["ids"] = [new]
            section.attributes.pop("slug", None)
            self.document.ids[new] = section
            anchors[host] = new


def heading_ids(page: Path) -> Iterator[str]:
    """The anchors of the headings of a page, as code hosts compute them; nothing if there is no page."""
    used: set[str] = set()
    fence = ""
    for line in page.read_text("utf-8").split("\n") if page.is_file() else ():
        mark = _FENCE.match(line)
        if mark and fence in ("", mark[1]):
            fence = "" if fence else mark[1]
        heading = None if fence else _HEADING.fullmatch(line)
        if heading:
            slug = _slug(heading[1])
            new = next(name for name in (slug, *(f"{slug}-{n}" for n in range(1, len(used) + 2))) if name not in used)
            used.add(new)
            yield new


def _slug(heading: str) -> str:
    text = re.sub(r"<[^>]*>|[`*]", "", heading)
    text = re.sub(r"\[((?:[^\]\\]|\\.)*)\]\([^)]*\)", r"\1", text)
    text = html.unescape(re.sub(r"\\(.)", r"\1", text)).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-") or "section"
