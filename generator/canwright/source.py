"""YAML text to plain data that knows file, line and column; refuses what is unsafe or reads in two ways.

Only mappings, lists and scalars are read. Plain scalars are integers (`12`, `0x1F`), decimals (kept exact, as
`Decimal`), `true`, `false`, or text; whatever YAML 1.1 and 1.2 read differently is refused and has to be quoted.
"""

from __future__ import annotations

import codecs
import re
import stat
from collections.abc import Callable
from decimal import Decimal
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, NamedTuple, NoReturn

import yaml

from . import characters, hints, unreadable
from .diagnostics import Diagnostic, Position, Severity, SpecError
from .model import Path

MAX_BYTES = 1 << 23
MAX_DEPTH = 24
MAX_FINDINGS = 100
"""How many findings of reading are told in one run."""
MERGE = "<<"
"""The key that would merge another mapping into this one."""
LONGEST = 400
"""How much a finding says; texts of a file that are in it may be as long as the file."""

Scalar = str | int | Decimal | bool
Data = Scalar | list[Any] | dict[str, Any]

_INTEGER = re.compile(r"-?(?:0|[1-9][0-9]{0,30})|0x[0-9A-Fa-f]{1,16}")
_DECIMAL = re.compile(r"-?(?:0|[1-9][0-9]{0,30})\.[0-9]{1,30}")
_MARKS = {
    codecs.BOM_UTF8: "a byte order mark",
    codecs.BOM_UTF16_LE: "the byte order mark of UTF-16",
    codecs.BOM_UTF16_BE: "the byte order mark of UTF-16",
}
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Mark(NamedTuple):
    """Line and column from 1, and how many characters to underline."""

    line: int
    column: int
    length: int

    @classmethod
    def of(cls, span: Span) -> Mark:
        start, end = span
        one_line = end is not None and start.line == end.line
        return cls(start.line + 1, start.column + 1, end.column - start.column if one_line else 1)


Span = tuple[Any, Any]
"""The start of something, and its end where it is a scalar, as the YAML parser has them: few are ever asked for."""


class Document:
    """One YAML file: its data, and where each key and value stands. `name` is the file as findings call it.

    `findings` are those of reading, `spoilt` the paths of what could not be read; the rest of the data is as written.
    `renamed` leads from the path that a misspelt key should have to the one it has.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        written = text.replace("\r\n", "\n")
        read = characters.covered(written)
        self.lines = read.split("\n")
        self._keys: dict[Path, Span] = {}
        self._values: dict[Path, Span] = {}
        self.renamed: dict[Path, Path] = {}
        self.spoilt: set[Path] = set()
        self.findings: list[Diagnostic] = []
        for line, column, found in characters.places(written):
            self._unseen(Mark(line, column, 1), found)
        self.data: Data = _Builder(self, read).build()

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
        span = (self._keys.get(path) if key else None) or self._values.get(path)
        return self._at(Mark.of(span) if span else Mark(1, 1, 1))

    def finding(
        self, path: Path, rule: str, message: str, hint: str = "", *, key: bool = False, warning: bool = False
    ) -> Diagnostic:
        """A diagnostic at `path`."""
        severity = Severity.WARNING if warning else Severity.ERROR
        return Diagnostic(severity, rule, _line(message), self.position(path, key=key), _line(hint))

    def _at(self, mark: Mark) -> Position:
        text = self.lines[mark.line - 1] if mark.line <= len(self.lines) else ""
        return Position(self.name, mark.line, mark.column, mark.length, text)

    def _report(self, mark: Mark, rule: str, message: str, hint: str = "") -> None:
        if len(self.findings) == MAX_FINDINGS:
            self._refuse(mark, rule, message, f"{hint}; reading stops after so many findings")
        self.findings.append(Diagnostic(Severity.ERROR, rule, _line(message), self._at(mark), _line(hint)))

    def _without_value(self, mark: Mark, path: Path | None) -> None:
        span = self._keys.get(path) if path else None
        at, line = (Mark.of(span), self.lines[span[0].line]) if span else (mark, "")
        self._report(at, "yaml", "there is no value here", hints.empty(str(path[-1]) if path else "", line))
        if path is not None:
            self.spoilt.add(path)

    def _refuse(self, mark: Mark, rule: str, message: str, hint: str = "") -> NoReturn:
        found = Diagnostic(Severity.ERROR, rule, _line(message), self._at(mark), _line(hint))
        is_told = any(other.position == found.position for other in self.findings)
        raise SpecError(self.findings if is_told else [*self.findings, found])

    def _not_yaml(self, error: yaml.MarkedYAMLError, event: Any) -> NoReturn:
        """Refuses a text that is not YAML, as was found after an event."""
        line, column, what, hint = unreadable.cause(error, self.lines, event)
        self._refuse(Mark(line + 1, column + 1, 1), "yaml", f"this is not YAML: {what}", hint)

    def _unseen(self, mark: Mark, found: str) -> None:
        message = f"the character {characters.described(found)} cannot be seen, or changes how others are shown"
        self._report(mark, "unsafe-character", message, "remove it")


class _Builder:
    """Turns YAML events into data, one pass, noting positions on the way.

    A path is None within what is left out, such as the second of two values for one key.
    """

    def __init__(self, document: Document, text: str) -> None:
        self._document = document
        self._text = text
        self._is_covered = bool(document.findings)
        self._plain: dict[str, Scalar] = {}
        """What plain texts read as, of those without a finding: most stand in a file again and again."""
        self._event: Any = None
        self._next_event: Callable[[], Any] = self._first_event

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
            self._report("yaml", "a second document starts here", "a file holds one; remove the `---`")
        return data

    def _first_event(self) -> Any:
        self._next_event = _LOADER(self._text).get_event
        return self._next_event()

    def _next(self) -> None:
        try:
            self._event = self._next_event()
        except yaml.MarkedYAMLError as error:
            self._document._not_yaml(error, self._event)
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            what = next(iter(str(error).splitlines()), "")
            self._document._refuse(Mark(1, 1, 1), "yaml", f"this is not YAML: {what}")

    def _span(self) -> Span:
        event = self._event
        return event.start_mark, event.end_mark if isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)) else None

    def _mark(self) -> Mark:
        return Mark.of(self._span())

    def _report(self, rule: str, message: str, hint: str = "", spoils: Path | None = None) -> None:
        self._document._report(self._mark(), rule, message, hint)
        if spoils is not None:
            self._document.spoilt.add(spoils)

    def _value(self, path: Path | None, depth: int) -> Data:
        event = self._event
        if path is not None:
            self._document._values[path] = self._span()
        if isinstance(event, yaml.ScalarEvent) and event.anchor is None and event.tag is None and depth <= MAX_DEPTH:
            return self._scalar(path)
        return self._collection(path, depth)

    def _collection(self, path: Path | None, depth: int) -> Data:
        """A mapping or a list, or what is refused."""
        event = self._event
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            spoils = path if isinstance(event, yaml.AliasEvent) else None
            hint = "name a type or a layout and refer to it"
            self._report("yaml-alias", "anchors and aliases are not read", hint, spoils)
        if isinstance(event, yaml.AliasEvent):
            return ""
        if event.tag is not None:
            spoils = path if isinstance(event, yaml.ScalarEvent) else None
            self._report(
                "yaml-tag", f"the tag `{event.tag}` is not read", "a spec is plain data; remove the tag", spoils
            )
        if depth > MAX_DEPTH:
            hint = "no spec needs that; check brackets and indents"
            self._document._refuse(self._mark(), "yaml-depth", f"nested deeper than {MAX_DEPTH} levels", hint)
        if isinstance(event, yaml.ScalarEvent):
            return event.value if event.tag else self._scalar(path)
        self._next()
        if isinstance(event, yaml.SequenceStartEvent):
            return self._items(path, depth + 1)
        return self._entries(path, depth + 1)

    def _items(self, path: Path | None, depth: int) -> list[Data]:
        items: list[Data] = []
        while not isinstance(self._event, yaml.SequenceEndEvent):
            items.append(self._value(None if path is None else (*path, len(items)), depth))
            self._next()
        return items

    def _entries(self, path: Path | None, depth: int) -> dict[str, Data]:
        entries: dict[str, Data] = {}
        while not isinstance(self._event, yaml.MappingEndEvent):
            span = self._span()
            key, written = self._key(depth), getattr(self._event, "value", "")
            child = None if path is None or key is None else (*path, key)
            is_first = key not in entries
            if path is not None and key is None:
                self._document.spoilt.add((*path, written))
            elif child is not None and is_first:
                self._document._keys[child] = span
            elif child is not None:
                before = Mark.of(self._document._keys[child]).line
                self._report("duplicate-key", f"`{key}` is there twice, first on line {before}", "remove or rename one")
            self._next()
            value = self._value(child if is_first else None, depth)
            if key is not None and is_first:
                entries[key] = value
            self._next()
        return entries

    def _key(self, depth: int) -> str | None:
        """A key; None for what is none, once that is reported."""
        event = self._event
        if not isinstance(event, yaml.ScalarEvent) or event.anchor or event.tag:
            self._report("yaml", "a key must be a plain name", "name it by letters, digits and underscores")
            if isinstance(event, yaml.CollectionStartEvent):
                self._value(None, depth)
            return None
        if not event.style and event.value == MERGE:
            self._report("yaml-alias", "merge keys are not read", "name a type or a layout and refer to it")
            return None
        found = len(self._document.findings)
        key = self._scalar(None)
        if isinstance(key, bool):
            self._report("ambiguous-scalar", f"the key `{event.value}` is no name", "put it in quotes")
        is_read = len(self._document.findings) == found and not self._is_marked(event.value)
        return str(key) if is_read else None

    def _is_marked(self, text: str) -> bool:
        """Whether there was a character in a text that cannot be seen."""
        return self._is_covered and characters.CANNOT_BE_SEEN in text

    def _scalar(self, path: Path | None) -> Scalar:
        text: str = self._event.value
        if not self._event.style and text in self._plain:
            return self._plain[text]
        found = len(self._document.findings)
        value = self._checked(text, path)
        if not self._event.style and len(self._document.findings) == found and not self._is_marked(text):
            self._plain[text] = value
        return value

    def _checked(self, text: str, path: Path | None) -> Scalar:
        unseen = characters.unseen(text)
        for found in unseen:
            self._document._unseen(self._mark(), found)
        if path is not None and (unseen or self._is_marked(text)):
            self._document.spoilt.add(path)
        if self._event.style:
            return text
        if text == "":
            self._document._without_value(self._mark(), path)
        elif _INTEGER.fullmatch(text):
            return int(text, 0)
        elif _DECIMAL.fullmatch(text):
            return Decimal(text)
        elif text in ("true", "false"):
            return text == "true"
        elif doubt := hints.doubt(text):
            self._report(*doubt, path)
        return text


def parse(name: str, text: str) -> Document:
    """Reads YAML text. Raises SpecError where reading cannot go on; other findings are the document's."""
    return Document(name, text)


def _line(text: str) -> str:
    """What a finding says, on one line that is not too long, whatever of a file is in it."""
    line = characters.visible(text)
    return line if len(line) <= LONGEST else line[:LONGEST] + "…"


def read(file: FilePath, called: str | None = None) -> tuple[Document, bytes]:
    """Reads a YAML file; also returns its bytes. Raises as `parse`, and OSError when there is no reading it.

    `called` is what findings call it, when it is not the path.
    """
    name = characters.covered(called or file.as_posix()).replace("\n", characters.CANNOT_BE_SEEN)
    if not stat.S_ISREG(file.stat().st_mode):
        raise OSError(f"{name} is no file, but a folder, a pipe or a device; name the file of a spec")
    with file.open("rb") as stream:
        content = stream.read(MAX_BYTES + 1)

    def refuse(line: int, column: int, rule: str, message: str, hint: str) -> NoReturn:
        lines = content.decode("utf-8", "replace").split("\n") if rule == "encoding" else []
        text = characters.covered(lines[line - 1]) if lines else ""
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
