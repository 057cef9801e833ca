"""YAML text to plain data that knows file, line and column; rejects what is unsafe or ambiguous.

Only mappings, lists and scalars are read. Plain scalars are integers (`12`, `0x1F`), decimals (kept exact, as
`Decimal`), `true`, `false`, or text; whatever YAML 1.1 and 1.2 read differently is refused and has to be quoted.
"""

from __future__ import annotations

import codecs
import stat
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

import yaml

from ..diagnostics import unicode_safety
from ..diagnostics.diagnostic import Diagnostic, DocumentPath, Position, Severity, SpecError
from . import ambiguous, yaml_errors
from .builder import Builder
from .marks import Mark, Places
from .scalars import Scalar

MAX_BYTES = 1 << 23
MAX_FINDINGS = 100
"""How many findings about YAML are reported in one run."""
LONGEST = 400
"""Characters of a message; it may quote a text that is as long as the file."""

Data = Scalar | list[Any] | dict[str, Any]

_MARKS = {
    codecs.BOM_UTF8: "a byte order mark",
    codecs.BOM_UTF16_LE: "the byte order mark of UTF-16",
    codecs.BOM_UTF16_BE: "the byte order mark of UTF-16",
}


class Document:
    """One YAML file: its data, and where each key and value stands. `name` is the file as findings call it.

    `findings` are those of reading, `unreadable` the paths of what could not be read; the rest of the data is as written.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        written = text.replace("\r\n", "\n")
        self._text = unicode_safety.covered(written)
        self.unreadable: set[DocumentPath] = set()
        self.findings: list[Diagnostic] = []
        for line, column, found in unicode_safety.places(written) if self._text != written else ():
            self.report_unseen(Mark(line, column, 1), found)
        self.data = Builder(self, self._text).build()

    @cached_property
    def lines(self) -> list[str]:
        """What is written, line by line."""
        return self._text.split("\n")

    def __contains__(self, path: object) -> bool:
        return path in self.places.values

    def holds(self, dotted: str) -> bool:
        """Whether `commands.stop.reply` is a path of this file."""
        return dotted in self._dotted

    @cached_property
    def places(self) -> Places:
        """Where everything stands."""
        return Places(self._text)

    @cached_property
    def _dotted(self) -> frozenset[str]:
        return frozenset(".".join(map(str, path)) for path in _paths(self.data))

    def position(self, path: DocumentPath, *, key: bool = False) -> Position:
        """Where the value at `path` stands, or with `key` its key; for a path that is not there, what is nearest."""
        keys, values = self.places.keys, self.places.values
        while path and path not in values:
            path, key = path[:-1], True
        mark = (keys.get(path) if key else None) or values.get(path)
        return self.at(mark or Mark(1, 1, 1))

    def finding(
        self, path: DocumentPath, rule: str, message: str, hint: str = "", *, key: bool = False, warning: bool = False
    ) -> Diagnostic:
        """A diagnostic at `path`."""
        severity = Severity.WARNING if warning else Severity.ERROR
        return Diagnostic(severity, rule, _line(message), self.position(path, key=key), _line(hint))

    def at(self, mark: Mark) -> Position:
        """A mark as a position in this file."""
        text = self.lines[mark.line - 1] if mark.line <= len(self.lines) else ""
        return Position(self.name, mark.line, mark.column, mark.length, text)

    def report(self, mark: Mark, rule: str, message: str, hint: str = "") -> None:
        """Adds a finding of reading. Raises SpecError with all of them once there are too many."""
        if len(self.findings) == MAX_FINDINGS:
            self.refuse(mark, rule, message, f"{hint}; reading stops after so many findings")
        self.findings.append(Diagnostic(Severity.ERROR, rule, _line(message), self.at(mark), _line(hint)))

    def report_without_value(self, mark: Mark, path: DocumentPath | None) -> None:
        """Reports a value that is not there, at its key."""
        at = (self.places.keys.get(path) if path else None) or mark
        line = self.lines[at.line - 1] if at is not mark else ""
        self.report(
            at, "yaml", "there is no value here", ambiguous.missing_value_hint(str(path[-1]) if path else "", line)
        )
        if path is not None:
            self.unreadable.add(path)

    def refuse(self, mark: Mark, rule: str, message: str, hint: str = "") -> NoReturn:
        """Ends reading with a finding and all before it. Raises SpecError."""
        found = Diagnostic(Severity.ERROR, rule, _line(message), self.at(mark), _line(hint))
        is_told = any(other.position == found.position for other in self.findings)
        raise SpecError(self.findings if is_told else [*self.findings, found])

    def refuse_as_no_yaml(self, error: yaml.MarkedYAMLError, event: Any) -> NoReturn:
        """Refuses a text that is not YAML, as was found after an event. Raises SpecError.

        Findings behind that place may only follow from it, so they are left out.
        """
        line, column, what, hint = yaml_errors.cause(error, self.lines, event)
        place = (line + 1, column + 1)
        self.findings = [f for f in self.findings if f.rule != "yaml" or (f.position.line, f.position.column) < place]
        self.refuse(Mark(line + 1, column + 1, 1), "yaml", f"this is not YAML: {what}", hint)

    def report_unseen(self, mark: Mark, found: str) -> None:
        """Reports a character that cannot be seen."""
        message = f"the character {unicode_safety.described(found)} cannot be seen, or changes how others are shown"
        self.report(mark, "unsafe-character", message, "remove it")


def _paths(data: Data, path: DocumentPath = ()) -> Iterator[DocumentPath]:
    yield path
    inside = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for step, value in inside:
        yield from _paths(value, (*path, step))


def parse_document(name: str, text: str) -> Document:
    """Reads YAML text. Raises SpecError where reading cannot go on; other findings are the document's."""
    return Document(name, text)


def _line(text: str) -> str:
    """A message on one line of limited length, whatever it quotes."""
    line = unicode_safety.visible(text)
    return line if len(line) <= LONGEST else line[:LONGEST] + "…"


def read_document(file: Path, called: str | None = None) -> tuple[Document, bytes]:
    """Reads a YAML file; also returns its bytes. Raises as `parse`, and OSError when there is no reading it.

    `called` is what findings call it, when it is not the path.
    """
    name = unicode_safety.covered(called or file.as_posix()).replace("\n", unicode_safety.CANNOT_BE_SEEN)
    if not stat.S_ISREG(file.stat().st_mode):
        raise OSError(f"{name} is no file, but a folder, a pipe or a device; name the file of a spec")
    with file.open("rb") as stream:
        content = stream.read(MAX_BYTES + 1)

    def refuse(line: int, column: int, rule: str, message: str, hint: str) -> NoReturn:
        lines = content.decode("utf-8", "replace").split("\n") if rule == "encoding" else []
        text = unicode_safety.covered(lines[line - 1]) if lines else ""
        raise SpecError([Diagnostic(Severity.ERROR, rule, message, Position(name, line, column, 1, text), hint)])

    if len(content) > MAX_BYTES:
        refuse(1, 1, "file-size", f"the file has more than {MAX_BYTES} bytes", "split the protocol")
    for mark, what in _MARKS.items():
        if content.startswith(mark):
            hint = "save the file as UTF-8, without a byte order mark"
            refuse(1, 1, "encoding", f"the file starts with {what}", hint)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8").split("\n")
        message = f"byte {error.start}, 0x{content[error.start]:02X}, is not UTF-8"
        refuse(len(before), len(before[-1]) + 1, "encoding", message, "save the file as UTF-8")
    return Document(name, text), content
