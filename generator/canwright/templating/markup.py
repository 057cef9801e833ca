"""Escaping of text for Markdown, its tables, SVG, and scripts of pages."""

from __future__ import annotations

import functools
import html
import re

from ..diagnostics.unicode_safety import visible

_ESCAPED = re.compile(r"([\\`*\[\]|])|(?<![A-Za-z0-9])(_)|(_)(?![A-Za-z0-9])")
_MARKS = re.compile(r"[{}~$]|\^(?=\S*\^)|=(?==)|\+(?=\+)")
"""Marks of templates, formulas and extensions of Markdown."""
_LINKED = re.compile(
    r":(?=//|[A-Za-z0-9_+-]+:)|\bwww\.|@(?=[A-Za-z0-9-]+\.[A-Za-z])|(?<![A-Za-z0-9])@(?=[A-Za-z0-9])", re.IGNORECASE
)
"""Where Markdown would link an address or a person, or insert an emoji; a zero-width space prevents it."""
_BETWEEN_CHINESE = re.compile(r"(?<=[\u3001-\u9fff\uff00-\uff60]) (?=[\u3001-\u9fff\uff00-\uff60])")
_STARTS = re.compile(r"^([#>+=:-]|[!?](?=[!?]{2})|[0-9]+(?=[.)]\s))")


@functools.lru_cache(maxsize=1 << 14)
def markdown(text: str) -> str:
    """Markdown that shows the text unchanged in a paragraph or a table cell."""
    line = html.escape(visible(text), quote=False)
    line = _MARKS.sub(lambda match: f"&#{ord(match.group())};", line)
    line = _LINKED.sub(lambda match: match.group() + "&#8203;", line)
    line = _ESCAPED.sub(lambda match: "\\" + match.group(), line)
    return _STARTS.sub(_escaped_start, line)


def _escaped_start(match: re.Match[str]) -> str:
    """An escaped start of a heading, a list or a quotation."""
    start = match.group()
    if start.isdigit():
        return f"{start}\\"
    return f"\\{start}" if start in "#>+-" else f"&#{ord(start)};"


def spaced(sentence: str) -> str:
    """A sentence without spaces between Chinese characters, which remain where lines are joined, or a word replaces a name."""
    return _BETWEEN_CHINESE.sub("", sentence)


@functools.lru_cache(maxsize=1 << 14)
def code(text: str) -> str:
    """A text in code style; empty for an empty text."""
    line = visible(text).replace("`", "'").replace("|", "\N{BROKEN BAR}")
    return f"`{line}`" if line else ""


def block(text: str, language: str) -> str:
    """A text as a block of code, with a fence that is longer than any in the text."""
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"


@functools.lru_cache(maxsize=1 << 14)
def xml(text: str) -> str:
    """A text escaped for SVG."""
    return html.escape(visible(text))


def script_text(json: str) -> str:
    """JSON that a script of an HTML page may contain: without tags and character references."""
    return json.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
