"""YAML text to plain data that knows file, line and column; refuses what is unsafe or reads in two ways.

Only mappings, lists and scalars are read. Plain scalars are integers (`12`, `0x1F`), decimals (kept exact, as
`Decimal`), `true`, `false`, or text; whatever YAML 1.1 and 1.2 read differently is refused and has to be quoted.
"""

from __future__ import annotations

import codecs
import re
import stat
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, NoReturn

import yaml

from . import characters
from .diagnostics import Diagnostic, Position, Severity, SpecError
from .model import Path

MAX_BYTES = 1 << 20
MAX_DEPTH = 24
LONGEST = 400
"""How much a finding says; texts of a file that are in it may be as long as the file."""

Scalar = str | int | Decimal | bool
Data = Scalar | list[Any] | dict[str, Any]

_INTEGER = re.compile(r"-?(?:0|[1-9]\d{0,30})|0x[0-9A-Fa-f]{1,16}")
_DECIMAL = re.compile(r"-?(?:0|[1-9]\d{0,30})\.\d{1,30}")
_AMBIGUOUS = re.compile(
    r"""(?ix) (?: yes|no|on|off | true|false | ~|null | [-+]?\.(?:inf|nan)
    | [-+]?[\d][\d_]*_[\d_]* | [-+]?0\d+ | [-+]?0[ob]\w+ | \d+(?::[0-5]?\d)+ | [-+]?\d*\.?\d+e[-+]?\d+
    | [-+]?\d+\. | \+\d+(?:\.\d*)? | [-+]?\.\d+ | [-+]0x\w+ )"""
)
_MARKS = {
    codecs.BOM_UTF8: "a byte order mark",
    codecs.BOM_UTF16_LE: "the byte order mark of UTF-16",
    codecs.BOM_UTF16_BE: "the byte order mark of UTF-16",
}
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True)
class Mark:
    """Line and column from 1, and how many characters to underline."""

    line: int
    column: int
    length: int


class Document:
    """One YAML file: its data, and where each key and value stands. `name` is the file as findings call it.

    `renamed` leads from the path that a misspelt key should have to the one it has.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.lines = characters.covered(text.replace("\r\n", "\n")).split("\n")
        self._keys: dict[Path, Mark] = {}
        self._values: dict[Path, Mark] = {}
        self.renamed: dict[Path, Path] = {}
        self._refuse_unseen(text.replace("\r\n", "\n"))
        self.data: Data = _Builder(self, text).build()

    def __contains__(self, path: object) -> bool:
        return path in self._values

    def holds(self, dotted: str) -> bool:
        """Whether `commands.stop.reply` is a path of this file."""
        return dotted in self._dotted

    @cached_property
    def _dotted(self) -> frozenset[str]:
        return frozenset(".".join(map(str, path)) for path in self._values)

    def position(self, path: Path, *, key: bool = False) -> Position:
        """Where the value at `path` stands, or with `key` its key; for a path that is not there, what is nearest."""
        for meant, written in self.renamed.items():
            if path[: len(meant)] == meant:
                path = (*written, *path[len(meant) :])
        while path and path not in self._values:
            path, key = path[:-1], True
        mark = (self._keys.get(path) if key else None) or self._values.get(path) or Mark(1, 1, 1)
        return self._at(mark)

    def finding(
        self, path: Path, rule: str, message: str, hint: str = "", *, key: bool = False, warning: bool = False
    ) -> Diagnostic:
        """A diagnostic at `path`."""
        severity = Severity.WARNING if warning else Severity.ERROR
        return Diagnostic(severity, rule, _line(message), self.position(path, key=key), _line(hint))

    def _at(self, mark: Mark) -> Position:
        text = self.lines[mark.line - 1] if mark.line <= len(self.lines) else ""
        return Position(self.name, mark.line, mark.column, mark.length, text)

    def _refuse(self, mark: Mark, rule: str, message: str, hint: str = "") -> NoReturn:
        raise SpecError([Diagnostic(Severity.ERROR, rule, _line(message), self._at(mark), hint)])

    def _refuse_unseen(self, text: str, mark: Mark | None = None) -> None:
        """Refuses a text with a character that cannot be seen; `mark` is where the text stands, if not at the top."""
        for found in characters.unseen(text)[:1]:
            before = text[: text.index(found)].split("\n")
            message = f"the character {characters.described(found)} cannot be seen, or changes how others are shown"
            self._refuse(mark or Mark(len(before), len(before[-1]) + 1, 1), "unsafe-character", message, "remove it")


class _Builder:
    """Turns YAML events into data, one pass, noting positions on the way."""

    def __init__(self, document: Document, text: str) -> None:
        self._document = document
        self._events = self._parse(text)
        self._event: Any = None

    def build(self) -> Data:
        self._next()  # stream start
        self._next()
        if isinstance(self._event, yaml.StreamEndEvent):
            self._document._refuse(Mark(1, 1, 1), "yaml", "the file is empty", "it should hold one mapping")
        self._next()  # document start
        data = self._value((), 1)
        self._next()  # document end
        self._next()
        if not isinstance(self._event, yaml.StreamEndEvent):
            self._refuse("yaml", "a second document starts here", "a file holds one; remove the `---`")
        return data

    def _parse(self, text: str) -> Any:
        try:
            yield from yaml.parse(text, Loader=_LOADER)
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            where = Mark(mark.line + 1, mark.column + 1, 1) if mark else Mark(1, 1, 1)
            what = " ".join(part for part in (error.context, error.problem) if part)
            self._document._refuse(where, "yaml", f"this is not YAML: {what}")
        except yaml.YAMLError as error:
            self._document._refuse(Mark(1, 1, 1), "yaml", f"this is not YAML: {str(error).splitlines()[0]}")

    def _next(self) -> None:
        self._event = next(self._events)

    def _mark(self) -> Mark:
        start, end = self._event.start_mark, self._event.end_mark
        one_line = start.line == end.line and isinstance(self._event, yaml.ScalarEvent)
        return Mark(start.line + 1, start.column + 1, end.column - start.column if one_line else 1)

    def _refuse(self, rule: str, message: str, hint: str = "") -> NoReturn:
        self._document._refuse(self._mark(), rule, message, hint)

    def _value(self, path: Path, depth: int) -> Data:
        event = self._event
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            self._refuse("yaml-alias", "anchors and aliases are not read", "name a type or a layout and refer to it")
        if event.tag is not None:
            self._refuse("yaml-tag", f"the tag `{event.tag}` is not read", "a spec is plain data; remove the tag")
        if depth > MAX_DEPTH:
            self._refuse(
                "yaml-depth", f"nested deeper than {MAX_DEPTH} levels", "no spec needs that; check brackets and indents"
            )
        self._document._values[path] = self._mark()
        if isinstance(event, yaml.ScalarEvent):
            return self._scalar()
        self._next()
        if isinstance(event, yaml.SequenceStartEvent):
            items: list[Data] = []
            while not isinstance(self._event, yaml.SequenceEndEvent):
                items.append(self._value((*path, len(items)), depth + 1))
                self._next()
            return items
        mapping: dict[str, Data] = {}
        while not isinstance(self._event, yaml.MappingEndEvent):
            key, mark = self._key(), self._mark()
            child = (*path, key)
            if key in mapping:
                before = self._document._keys[child].line
                self._refuse("duplicate-key", f"`{key}` is there twice, first on line {before}", "remove or rename one")
            self._document._keys[child] = mark
            self._next()
            mapping[key] = self._value(child, depth + 1)
            self._next()
        return mapping

    def _key(self) -> str:
        if not isinstance(self._event, yaml.ScalarEvent) or self._event.anchor or self._event.tag:
            self._refuse("yaml", "a key must be a plain name")
        if not self._event.style and self._event.value == "<<":
            self._refuse("yaml-alias", "merge keys are not read", "name a type or a layout and refer to it")
        key = self._scalar()
        if isinstance(key, bool):
            self._refuse("ambiguous-scalar", f"the key `{self._event.value}` is no name", "put it in quotes")
        return str(key)

    def _scalar(self) -> Scalar:
        text: str = self._event.value
        if self._event.style:
            self._document._refuse_unseen(text, self._mark())
            return text
        if text == "":
            self._refuse("yaml", "there is no value here", "write one, or remove the key")
        if _INTEGER.fullmatch(text):
            return int(text, 0)
        if _DECIMAL.fullmatch(text):
            return Decimal(text)
        if text in ("true", "false"):
            return text == "true"
        if _AMBIGUOUS.fullmatch(text):
            self._refuse(
                "ambiguous-scalar",
                f"`{text}` reads differently from one YAML reader to the next",
                f'for a text write "{text}" in quotes; a number is written like 12, 0x1F or 0.01',
            )
        return text


def parse(name: str, text: str) -> Document:
    """Reads YAML text. Raises SpecError."""
    return Document(name, text)


def _line(text: str) -> str:
    """What a finding says, on one line that is not too long, whatever of a file is in it."""
    line = characters.visible(text)
    return line if len(line) <= LONGEST else line[:LONGEST] + "…"


def read(file: FilePath) -> tuple[Document, bytes]:
    """Reads a YAML file; also returns its bytes. Raises SpecError, and OSError when there is no reading it."""
    name = characters.visible(file.as_posix())
    if not stat.S_ISREG(file.stat().st_mode):
        raise OSError(f"{name} is no file, but a folder, a pipe or a device; name the file of a spec")
    with file.open("rb") as stream:
        content = stream.read(MAX_BYTES + 1)

    def refuse(line: int, rule: str, message: str, hint: str) -> NoReturn:
        raise SpecError([Diagnostic(Severity.ERROR, rule, message, Position(name, line, 1, 1, ""), hint)])

    if len(content) > MAX_BYTES:
        refuse(1, "file-size", f"the file has more than {MAX_BYTES} bytes", "split the protocol")
    for mark, what in _MARKS.items():
        if content.startswith(mark):
            refuse(1, "encoding", f"the file starts with {what}", "save the file as UTF-8, without a byte order mark")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        refuse(line, "encoding", f"byte {error.start} is not UTF-8", "save the file as UTF-8")
    return Document(name, text), content
