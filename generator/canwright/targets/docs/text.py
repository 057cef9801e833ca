"""Text that is only text in Markdown, in its tables, and in SVG."""

from __future__ import annotations

import html
import re

from ...characters import visible

_ESCAPED = re.compile(r"([\\`*\[\]|])|(?<![A-Za-z0-9])(_)|(_)(?![A-Za-z0-9])")
_STARTS = re.compile(r"^([#>+=:-]|\d+(?=[.)]\s))")


def markdown(text: str) -> str:
    """A text as Markdown that shows it as it is, within a paragraph or a table cell."""
    line = html.escape(visible(text), quote=False)
    line = line.replace("{", "&#123;").replace("}", "&#125;").replace("~", "&#126;")
    line = line.replace("$", "&#36;").replace("://", ":&#8203;//")
    line = _ESCAPED.sub(lambda match: "\\" + match.group(), line)
    return _STARTS.sub(_escaped_start, line)


def _escaped_start(match: re.Match[str]) -> str:
    """What would start a heading, a list or a quotation, and does not."""
    start = match.group()
    return f"{start}\\" if start.isdigit() else f"\\{start}"


def code(text: str) -> str:
    """A text in code style; nothing for nothing."""
    line = visible(text).replace("`", "'").replace("|", "\N{BROKEN BAR}")
    return f"`{line}`" if line else ""


def xml(text: str) -> str:
    """A text within SVG."""
    return html.escape(visible(text))
