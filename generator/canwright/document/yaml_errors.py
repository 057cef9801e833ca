"""Probable causes of YAML syntax errors."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from yaml import MarkedYAMLError


class Cause(NamedTuple):
    """The probable cause of a syntax error: line and column from 0, often before the error, and what to write."""

    line: int
    column: int
    problem: str
    hint: str


class _Correction(NamedTuple):
    """A line and column from 0, and what to write there."""

    line: int
    column: int
    hint: str


class _SyntaxError(NamedTuple):
    """The line and column of a syntax error, and the start of the construct that contains it."""

    problem: str
    lines: Sequence[str]
    line: int
    column: int
    start: tuple[int, int] | None
    quoted: tuple[int, int, int, int] | None
    """Line and column of the start and of the end of the quoted text before the error."""

    @property
    def content(self) -> str:
        return self.lines[self.line] if self.line < len(self.lines) else ""

    @property
    def before(self) -> int:
        """The last line before this one that is neither empty nor a comment."""
        above = (n for n in range(min(self.line, len(self.lines)) - 1, -1, -1))
        return next((n for n in above if self.lines[n].strip() and not self.lines[n].lstrip().startswith("#")), 0)


def cause(error: MarkedYAMLError, lines: Sequence[str], event: Any) -> Cause:
    """The probable cause of a syntax error in some lines; `event` is the last one before the error."""
    problem = " ".join(part for part in (error.context, error.problem) if part)
    at, start = error.problem_mark or error.context_mark, error.context_mark
    if at is None:
        return Cause(0, 0, problem, "")
    quoted = None
    if getattr(event, "style", None) in ("'", '"'):
        quoted = (event.start_mark.line, event.start_mark.column, event.end_mark.line, event.end_mark.column)
    began = (start.line, start.column) if start else None
    syntax_error = _SyntaxError(problem, lines, at.line, at.column, began, quoted)
    corrections = (find(syntax_error) for find in (_space, _wide, _quote, _colon, _bracket, _indent))
    general = next((hint for words, hint in _HINTS.items() if words in problem), "")
    line, column, hint = next(filter(None, corrections), (at.line, at.column, general))
    return Cause(line, column, problem, hint)


def _space(error: _SyntaxError) -> _Correction | None:
    """A tab or a wide space in the indentation."""
    for number in (error.line, error.before):
        line = error.lines[number] if number < len(error.lines) else ""
        lead = line[: len(line) - len(line.lstrip())]
        if "\t" in lead and number == error.line:
            return _Correction(number, lead.index("\t"), "indent with spaces, not with tabs")
        odd = next((i for i, c in enumerate(lead) if c not in " \t"), None)
        if odd is not None:
            return _Correction(number, odd, f"indent with plain spaces; this is U+{ord(lead[odd]):04X}")
    return None


def _wide(error: _SyntaxError) -> _Correction | None:
    """A full-width colon, comma or bracket instead of the ASCII one."""
    wide = re.search("[：，｛｝［］]", error.content[: error.column])
    if wide is None:
        return None
    plain = dict(zip("：，｛｝［］", ":,{}[]", strict=True))[wide[0]]
    return _Correction(error.line, wide.start(), f"did you mean `{plain}`? otherwise put the text in quotes")


def _quote(error: _SyntaxError) -> _Correction | None:
    if "quoted scalar" in error.problem and error.start:
        return _Correction(*error.start, "is the closing quote missing?")
    if error.quoted and error.quoted[0] < error.line == error.quoted[2]:
        return _Correction(
            error.quoted[0],
            error.quoted[1],
            f"is the closing quote missing? this text would end on line {error.line + 1}",
        )
    if (
        error.quoted
        and (error.line, error.column) == error.quoted[2:]
        and error.content[error.column : error.column + 1].strip()
    ):
        hint = "the text ends at the quote before this; put a text that contains quotes in quotes of the other kind"
        return _Correction(error.line, error.column, hint)
    return None


def _colon(error: _SyntaxError) -> _Correction | None:
    if "could not find expected ':'" in error.problem and error.start:
        return _Correction(*error.start, _missing_colon(error.lines[error.start[0]]))
    if "found unexpected ':'" in error.problem and error.content[error.column + 1 : error.column + 2] in (
        ",",
        "}",
        "]",
    ):
        return _Correction(error.line, error.column, "there is no value after this colon; write one, or remove the key")
    if "mapping values are not allowed" not in error.problem:
        return None
    head = error.content[: error.column]
    if ": " in head:
        return _Correction(error.line, error.column, "put a text that contains a colon in quotes")
    above = error.lines[error.before]
    if re.search(r":(?: |$)", above):
        return _Correction(error.line, _lead(error.content), _indented(error))
    return _Correction(error.before, _lead(above), _missing_colon(above))


def _missing_colon(line: str) -> str:
    if line.lstrip().startswith(("//", "/*", "--", ";")):
        return "a comment starts with `#`"
    parts = re.fullmatch(r"\s*(?:- )?([A-Za-z_][A-Za-z0-9_]*)(?:\s*[:=]\s*|\s+|$)([^:{]*)", line)
    if parts is None:
        return "is the colon after the key missing, or the space after the colon?"
    return f"write a colon and a space after a key: `{f'{parts[1]}: {parts[2]}'.strip()}`"


def _bracket(error: _SyntaxError) -> _Correction | None:
    if error.content[error.column : error.column + 1] in ("}", "]") and "expected key" in error.problem:
        return _Correction(error.line, error.column, f"this `{error.content[error.column]}` closes nothing; remove it")
    above = error.lines[error.before].rstrip() if error.lines else ""
    if (
        "node content" in error.problem
        and error.content[error.column :].startswith("- ")
        and above.endswith(("[", "{"))
    ):
        hint = f"this `{above[-1]}` is not closed; a list with dashes needs no brackets"
        return _Correction(error.before, len(above) - 1, hint)
    if "did not find expected ','" not in error.problem or error.start is None:
        return None
    line, column = error.start
    bracket = error.lines[line][column : column + 1]
    if line < error.line and _lead(error.content) <= _lead(error.lines[line]):
        return _Correction(line, column, f"this `{bracket}` is not closed")
    return _Correction(
        error.line, error.column, f"is a comma missing, or is the `{bracket}` on line {line + 1} not closed?"
    )


def _indent(error: _SyntaxError) -> _Correction | None:
    if error.content[error.column :].startswith(("//", "/*", "--", ";")) and error.column > 0:
        return _Correction(error.line, error.column, "a comment starts with `#`")
    if "did not find expected key" in error.problem and error.content.lstrip().startswith("- "):
        hint = "a list item cannot stand between keys; write a name or a dash for all of them"
        return _Correction(error.line, error.column, hint)
    if "did not find expected key" in error.problem:
        return _Correction(error.line, error.column, _indented(error))
    return None


def _indented(error: _SyntaxError) -> str:
    here, above = _lead(error.content), _lead(error.lines[error.before])
    return f"this line is indented by {here}, line {error.before + 1} by {above}; indent lines of one mapping equally"


def _lead(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


_HINTS = {
    "cannot start any token": "put a text that starts with this character in quotes; is a closing quote missing before it?",
    "expected alphabetic or numeric": "put a text that starts with `*` or `&` in quotes",
    "unexpected end of stream": "is a quote or a bracket not closed?",
    "did not find expected node content": "is a value missing here?",
    "expected '-' indicator": "write a mapping without dashes, or a list with a dash before each item",
    "while scanning a tag": "put a text that starts with `!` in quotes",
    "found unexpected ':'": "a space is missing after the colon",
}
