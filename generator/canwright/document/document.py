"""A YAML file as plain data with file, line and column.

Only mappings, lists and scalars are supported. Plain scalars are integers (`12`, `0x1F`), decimals (exact, as
`Decimal`), `true`, `false`, or text. A scalar that YAML 1.1 and 1.2 read differently is rejected and needs quotes.
"""

from __future__ import annotations

import codecs
import os
import re
import stat
from pathlib import Path
from typing import NoReturn

from ..diagnostics import unicode_safety
from ..diagnostics.diagnostic import Diagnostic, DocumentPath, Position, Related, Severity, SpecError
from .builder import Data, Issue, build
from .marks import Mark, Source

MAX_BYTES = 1 << 22
MAX_MESSAGE = 400
"""The maximum number of characters in a message, which may quote a text as long as the file."""

_BYTE_ORDER_MARKS = {
    codecs.BOM_UTF16_LE: "the byte order mark of UTF-16",
    codecs.BOM_UTF16_BE: "the byte order mark of UTF-16",
}


class Document:
    """One YAML file: its data, and the position of each key and value. `name` is the name of the file in findings.

    Raises SpecError with all findings if the text is not YAML, or YAML that is unsafe or ambiguous.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        written = text.replace("\r\n", "\n")
        masked = unicode_safety.covered(written)
        self._source = Source(masked)
        places = unicode_safety.places(written) if masked != written else ()
        hidden = [(Mark(line, column, 1), character) for line, column, character in places]
        self.data: Data
        self.data, issues = build(self._source, hidden)
        if issues:
            raise SpecError(map(self._finding, issues))

    def __contains__(self, path: object) -> bool:
        return path in self._source.marks.values

    def contains(self, dotted: str) -> bool:
        """Whether `commands.stop.reply` is a path of this file."""
        item: object = self.data
        for step in dotted.split(".") if dotted else ():
            item = _child(item, step)
        return item is not _NOWHERE

    def position(self, path: DocumentPath, *, key: bool = False) -> Position:
        """The position of the value at `path`, or with `key` of its key; for an unknown path, of the nearest key."""
        marks = self._source.marks
        while path and path not in marks.values:
            path, key = path[:-1], True
        mark = (marks.keys.get(path) if key else None) or marks.values.get(path)
        return self._position(mark or Mark(1, 1, 1))

    def finding(
        self, path: DocumentPath, rule: str, message: str, hint: str = "", *, key: bool = False, warning: bool = False
    ) -> Diagnostic:
        """A diagnostic at `path`."""
        severity = Severity.WARNING if warning else Severity.ERROR
        return Diagnostic(severity, rule, _line(message), self.position(path, key=key), _line(hint))

    def _finding(self, issue: Issue) -> Diagnostic:
        related = [Related(self._position(mark), _line(item)) for mark, item in filter(None, [issue.related])]
        hint = _line(issue.hint)
        position = self._position(issue.mark)
        return Diagnostic(Severity.ERROR, issue.rule, _line(issue.message), position, hint, tuple(related))

    def _position(self, mark: Mark) -> Position:
        lines = self._source.lines
        text = lines[mark.line - 1] if mark.line <= len(lines) else ""
        return Position(self.name, mark.line, mark.column, mark.length, text)


_NOWHERE = object()


def _child(data: object, step: str) -> object:
    """The item of a mapping or a list at one step of a dotted path."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return next((item for key, item in items if str(key) == step), _NOWHERE)


def parse_document(name: str, text: str) -> Document:
    """A YAML text as a document. Raises SpecError if the text is not YAML."""
    return Document(name, text)


def _line(text: str) -> str:
    """A message on one line of limited length."""
    line = unicode_safety.visible(text)
    return line if len(line) <= MAX_MESSAGE else line[:MAX_MESSAGE] + "…"


_SPEC_KEY = re.compile(rb"\bcanwright\W{0,3}:")


def _leads_outside(file: Path) -> bool:
    """Whether a path in the current folder leads through a symbolic link to a file outside of it."""
    folder = Path.cwd()
    named, actual = Path(os.path.normpath(folder / file)), Path(os.path.realpath(file))
    return named.is_relative_to(folder) and not actual.is_relative_to(folder)


def read_document(file: Path, name: str | None = None) -> tuple[Document, bytes]:
    """A YAML file as a document, and its bytes. Raises SpecError if it is not YAML, and OSError.

    `name` is the name of the file in findings; by default its path.
    """
    name = unicode_safety.covered(name or file.as_posix()).replace("\n", unicode_safety.CANNOT_BE_SEEN)
    if not stat.S_ISREG(file.stat().st_mode):
        raise OSError(f"{name} is not a file but a folder, a pipe or a device; name a spec file")
    with file.open("rb") as stream:
        content = stream.read(MAX_BYTES + 1).removeprefix(codecs.BOM_UTF8)

    if _leads_outside(file) and not _SPEC_KEY.search(content):  # findings show lines, for example in a public CI log
        text = f"{name} is a link to a file outside the current folder that is not a spec: it has no key `canwright`"
        raise OSError(f"{text}; remove the link")

    def reject(line: int, column: int, rule: str, message: str, hint: str) -> NoReturn:
        lines = content.decode("utf-8", "replace").split("\n") if rule == "encoding" else []
        text = unicode_safety.covered(lines[line - 1]) if lines else ""
        raise SpecError([Diagnostic(Severity.ERROR, rule, message, Position(name, line, column, 1, text), hint)])

    if len(content) > MAX_BYTES:
        reject(1, 1, "file-size", f"the file has more than {MAX_BYTES} bytes", "split the protocol")
    for mark, description in _BYTE_ORDER_MARKS.items():
        if content.startswith(mark):
            hint = "save the file as UTF-8"
            reject(1, 1, "encoding", f"the file starts with {description}", hint)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8").split("\n")
        message = f"byte {error.start}, 0x{content[error.start]:02X}, is not UTF-8"
        reject(len(before), len(before[-1]) + 1, "encoding", message, "save the file as UTF-8")
    return Document(name, text), content
