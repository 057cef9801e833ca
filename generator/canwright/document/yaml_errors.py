"""Where a text stops being YAML, and what is usually behind it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from yaml import MarkedYAMLError


class Cause(NamedTuple):
    """The place of the mistake, from 0, and what to do: often it stands before the place where reading stopped."""

    line: int
    column: int
    what: str
    hint: str


class _Place(NamedTuple):
    line: int
    column: int
    hint: str


class _Stop(NamedTuple):
    """Where reading stopped, and why; what was being read began at `start`, after a text that ended there or before."""

    what: str
    lines: Sequence[str]
    line: int
    column: int
    start: tuple[int, int] | None
    text: tuple[int, int, int, int] | None
    """Lines and columns of the start and of the end of the last quoted text."""

    @property
    def content(self) -> str:
        return self.lines[self.line] if self.line < len(self.lines) else ""

    @property
    def before(self) -> int:
        """The last line with content before this one."""
        above = (n for n in range(min(self.line, len(self.lines)) - 1, -1, -1))
        return next((n for n in above if self.lines[n].strip() and not self.lines[n].lstrip().startswith("#")), 0)


def cause(error: MarkedYAMLError, lines: Sequence[str], event: Any) -> Cause:
    """What is behind a complaint of the YAML reader about some lines, after an event."""
    what = " ".join(part for part in (error.context, error.problem) if part)
    at, start = error.problem_mark or error.context_mark, error.context_mark
    if at is None:
        return Cause(0, 0, what, "")
    text = None
    if getattr(event, "style", None) in ("'", '"'):
        text = (event.start_mark.line, event.start_mark.column, event.end_mark.line, event.end_mark.column)
    stop = _Stop(what, lines, at.line, at.column, (start.line, start.column) if start else None, text)
    found = next((found for find in (_space, _wide, _quote, _colon, _bracket, _indent) if (found := find(stop))), None)
    line, column, hint = found or (at.line, at.column, next((h for words, h in _YAML.items() if words in what), ""))
    return Cause(line, column, what, hint)


def _space(stop: _Stop) -> _Place | None:
    """Tabs and wide spaces where lines are indented."""
    for number in (stop.line, stop.before):
        line = stop.lines[number] if number < len(stop.lines) else ""
        lead = line[: len(line) - len(line.lstrip())]
        if "\t" in lead and number == stop.line:
            return _Place(number, lead.index("\t"), "indent with spaces; YAML takes no tabs there")
        odd = next((i for i, c in enumerate(lead) if c not in " \t"), None)
        if odd is not None:
            return _Place(number, odd, f"indent with plain spaces; this is U+{ord(lead[odd]):04X}")
    return None


def _wide(stop: _Stop) -> _Place | None:
    """A full-width colon, comma or bracket in place of that of YAML."""
    found = re.search("[：，｛｝［］]", stop.content[: stop.column])
    if found is None:
        return None
    plain = dict(zip("：，｛｝［］", ":,{}[]", strict=True))[found[0]]
    return _Place(stop.line, found.start(), f"is `{found[0]}` meant as `{plain}`? otherwise put the text in quotes")


def _quote(stop: _Stop) -> _Place | None:
    if "quoted scalar" in stop.what and stop.start:
        return _Place(*stop.start, "is the closing quote missing?")
    if stop.text and stop.text[0] < stop.line == stop.text[2]:
        return _Place(
            stop.text[0], stop.text[1], f"is the closing quote missing? this text would end on line {stop.line + 1}"
        )
    if stop.text and (stop.line, stop.column) == stop.text[2:] and stop.content[stop.column : stop.column + 1].strip():
        hint = "the text ends at the quote before this; one with quotes in it stands in the other quotes"
        return _Place(stop.line, stop.column, hint)
    return None


def _colon(stop: _Stop) -> _Place | None:
    if "could not find expected ':'" in stop.what and stop.start:
        return _Place(*stop.start, _missing_colon(stop.lines[stop.start[0]]))
    if "found unexpected ':'" in stop.what and stop.content[stop.column + 1 : stop.column + 2] in (",", "}", "]"):
        return _Place(stop.line, stop.column, "there is no value behind this colon: write one, or remove the key")
    if "mapping values are not allowed" not in stop.what:
        return None
    head = stop.content[: stop.column]
    if ": " in head:
        return _Place(stop.line, stop.column, "a text with a colon in it needs quotes")
    above = stop.lines[stop.before]
    if re.search(r":(?: |$)", above):
        return _Place(stop.line, _lead(stop.content), _indented(stop))
    return _Place(stop.before, _lead(above), _missing_colon(above))


def _missing_colon(line: str) -> str:
    if line.lstrip().startswith(("//", "/*", "--", ";")):
        return "a comment starts with `#`"
    found = re.fullmatch(r"\s*(?:- )?([A-Za-z_][A-Za-z0-9_]*)(?:\s*[:=]\s*|\s+|$)([^:{]*)", line)
    if found is None:
        return "is the colon behind the key missing, or the space after it?"
    return f"a key has a colon and a space behind it: `{f'{found[1]}: {found[2]}'.strip()}`"


def _bracket(stop: _Stop) -> _Place | None:
    if stop.content[stop.column : stop.column + 1] in ("}", "]") and "expected key" in stop.what:
        return _Place(stop.line, stop.column, f"this `{stop.content[stop.column]}` closes nothing: take it out")
    above = stop.lines[stop.before].rstrip() if stop.lines else ""
    if "node content" in stop.what and stop.content[stop.column :].startswith("- ") and above.endswith(("[", "{")):
        hint = f"this `{above[-1]}` is left open; a list with dashes has no brackets"
        return _Place(stop.before, len(above) - 1, hint)
    if "did not find expected ','" not in stop.what or stop.start is None:
        return None
    line, column = stop.start
    bracket = stop.lines[line][column : column + 1]
    if line < stop.line and _lead(stop.content) <= _lead(stop.lines[line]):
        return _Place(line, column, f"this `{bracket}` is left open")
    return _Place(stop.line, stop.column, f"is a comma missing, or the `{bracket}` on line {line + 1} left open?")


def _indent(stop: _Stop) -> _Place | None:
    if stop.content[stop.column :].startswith(("//", "/*", "--", ";")) and stop.column > 0:
        return _Place(stop.line, stop.column, "a comment starts with `#`")
    if "did not find expected key" in stop.what and stop.content.lstrip().startswith("- "):
        hint = "an item of a list cannot stand among keys: give each a name, or each of them a dash"
        return _Place(stop.line, stop.column, hint)
    if "did not find expected key" in stop.what:
        return _Place(stop.line, stop.column, _indented(stop))
    return None


def _indented(stop: _Stop) -> str:
    here, above = _lead(stop.content), _lead(stop.lines[stop.before])
    return f"this line is indented by {here}, line {stop.before + 1} by {above}; lines that belong together are indented alike"


def _lead(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


_YAML = {
    "cannot start any token": "put a text with such a character in quotes; is a quote before this left open?",
    "expected alphabetic or numeric": "put a text that starts with `*` or `&` in quotes",
    "unexpected end of stream": "is a quote or a bracket left open?",
    "did not find expected node content": "is a value missing here?",
    "expected '-' indicator": "a mapping has no dashes, a list has one before each item: this is neither",
    "while scanning a tag": "put a text that starts with `!` in quotes",
    "found unexpected ':'": "a space is missing after the colon",
}
