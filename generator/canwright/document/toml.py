"""A TOML file as a document: plain data with the line and column of each key that is on a line of its own."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from ..diagnostics import unicode_safety
from ..diagnostics.diagnostic import Diagnostic, DocumentPath, Position, Severity, SpecError
from .document import Document
from .marks import Mark, Marks, Source

_HEADER = re.compile(r"\s*\[([^\[\]]+)\]\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=\s*""")
_STEP = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")
_PLACE = re.compile(r" \(at line (\d+), column (\d+)\)$")


class TomlDocument(Document):
    """One TOML file. Raises SpecError if the text is not TOML."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self._source = _TomlSource(unicode_safety.covered(text.removeprefix("\ufeff").replace("\r\n", "\n")))
        try:
            self.data = tomllib.loads(self._source.text, parse_float=Decimal)
        except tomllib.TOMLDecodeError as error:
            raise SpecError([self._syntax_error(str(error))]) from None
        except RecursionError:
            raise SpecError([self._syntax_error("it is nested too deeply (at line 1, column 1)")]) from None

    def _syntax_error(self, message: str) -> Diagnostic:
        place = _PLACE.search(message)
        line, column = (int(place[1]), int(place[2])) if place else (max(1, len(self._source.lines)), 1)
        text = self._source.lines[line - 1] if line <= len(self._source.lines) else ""
        reason = unicode_safety.visible(_PLACE.sub("", message).removesuffix(" (at end of document)"))
        at = Position(self.name, line, column, 1, text)
        return Diagnostic(Severity.ERROR, "syntax", f"this is not TOML: {reason}", at)


class _TomlSource(Source):
    """A TOML text with its lines and marks."""

    @property
    def marks(self) -> Marks:
        marks = Marks("{}")
        table: DocumentPath = ()
        for number, line in enumerate(self.lines, 1):
            if header := _HEADER.match(line):
                table = tuple(_steps(header[1]))
                marks.keys[table] = marks.values[table] = Mark(number, header.start(1) + 1, len(header[1]))
            elif key := _KEY.match(line):
                path = (*table, *_steps(key[1]))
                marks.keys[path] = Mark(number, key.start(1) + 1, len(key[1]))
                value = line[key.end() :].rstrip()
                marks.values[path] = Mark(number, key.end() + 1, len(value))
        return marks


def _steps(dotted: str) -> Iterator[str]:
    """`a."b"` as its parts."""
    yield from (step.strip("\"'") for step in _STEP.findall(dotted))


def read_toml(file: Path) -> TomlDocument:
    """A TOML file as a document. Raises SpecError if it is not TOML, and OSError."""
    name = unicode_safety.covered(file.as_posix()).replace("\n", unicode_safety.CANNOT_BE_SEEN)
    return TomlDocument(name, file.read_bytes().decode("utf-8", "replace"))
