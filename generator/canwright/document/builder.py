"""YAML events to plain data, in one pass; unsafe or ambiguous YAML becomes an issue with its mark."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn

import yaml

from ..diagnostics import unicode_safety
from ..diagnostics.diagnostic import DocumentPath
from . import ambiguous, yaml_errors
from .marks import Mark, Source
from .scalars import LOADER, MERGE, Scalar, name_of, plain

MAX_DEPTH = 24
MAX_VALUES = 150_000
"""The maximum number of values in a file: mappings, lists and scalars."""
MAX_ISSUES = 100
"""The number of issues after which reading stops."""

Data = Scalar | list[Any] | dict[str, Any]


class Issue(NamedTuple):
    """What is wrong with the YAML at a mark, by which rule, and what to write instead."""

    mark: Mark
    rule: str
    message: str
    hint: str
    related: tuple[Mark, str] | None = None
    """The mark of another item that the issue is about, and what it is."""


class _StopReadingError(Exception):
    """Reading stopped after the last issue."""


def build(source: Source, hidden: list[tuple[Mark, str]]) -> tuple[Data, list[Issue]]:
    """The data of the one YAML document in a text, and its issues; with issues, the data is incomplete.

    `hidden` are the invisible characters that `source` masks.
    """
    return _Builder(source, hidden).build()


class _Builder:
    """Builds the data of one text.

    A path is None within an ignored value, such as the second of two values for one key. The values of plain scalars
    are cached and looked up first, because most of them occur many times in a file.
    """

    def __init__(self, source: Source, hidden: list[tuple[Mark, str]]) -> None:
        self._source = source
        self._hidden = hidden
        self._issues: list[Issue] = []
        self._values = 0
        self._plain: dict[str, Scalar] = {}
        self._names: dict[str, str] = {}
        self._event: Any = None
        self._next: Callable[[], Any]

    def build(self) -> tuple[Data, list[Issue]]:
        try:
            return self._build(), self._issues
        except _StopReadingError:
            return {}, self._issues

    def _build(self) -> Data:
        for mark, character in self._hidden:
            self._report_hidden(mark, character)
        try:
            return self._document()
        except yaml.MarkedYAMLError as error:
            self._stop_at_syntax_error(error)
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            problem = next(iter(str(error).splitlines()), "")
            self._stop(Mark(1, 1, 1), "yaml", f"this is not YAML: {problem}")

    def _document(self) -> Data:
        self._next = LOADER(self._source.text).get_event
        self._next()  # stream start
        if isinstance(self._next(), yaml.StreamEndEvent):
            self._stop(Mark(1, 1, 1), "yaml", "the file is empty", "write one mapping")
        self._event = self._next()
        data = self._value((), 1)
        self._next()  # document end
        self._event = self._next()
        if not isinstance(self._event, yaml.StreamEndEvent):
            self._report("yaml", "a second document starts here", "a file contains one; remove the `---`")
        return data

    def _report(self, rule: str, message: str, hint: str = "") -> None:
        """Reports an issue at the current event."""
        self._add(Mark.of(self._event), rule, message, hint)

    def _add(self, mark: Mark, rule: str, message: str, hint: str, related: tuple[Mark, str] | None = None) -> None:
        if len(self._issues) == MAX_ISSUES:
            self._stop(mark, rule, message, f"{hint}; reading stops after {MAX_ISSUES} findings")
        self._issues.append(Issue(mark, rule, message, hint, related))

    def _stop(self, mark: Mark, rule: str, message: str, hint: str = "") -> NoReturn:
        """Stops reading with an issue, unless there is one at the same place already."""
        if all(issue.mark != mark for issue in self._issues):
            self._issues.append(Issue(mark, rule, message, hint))
        raise _StopReadingError

    def _stop_at_syntax_error(self, error: yaml.MarkedYAMLError) -> NoReturn:
        """Stops reading at a syntax error. Syntax issues after its cause may only follow from it and are removed."""
        line, column, problem, hint = yaml_errors.cause(error, self._source.lines, self._event)
        mark = Mark(line + 1, column + 1, 1)
        self._issues = [i for i in self._issues if i.rule != "yaml" or i.mark[:2] < mark[:2]]
        self._stop(mark, "yaml", f"this is not YAML: {problem}", hint)

    def _report_hidden(self, mark: Mark, character: str) -> None:
        name = unicode_safety.described(character)
        self._add(
            mark, "unsafe-character", f"the character {name} is invisible or changes how others appear", "remove it"
        )

    def _report_missing_value(self, path: DocumentPath | None) -> None:
        """Reports a key without a value, at the key."""
        mark = self._source.marks.keys.get(path) if path else None
        line = self._source.lines[mark.line - 1] if mark else ""
        message, hint = ambiguous.missing_value(str(path[-1]) if path else "", line)
        self._add(mark or Mark.of(self._event), "yaml", message, hint)

    def _value(self, path: DocumentPath | None, depth: int) -> Data:
        """The value that starts with the current event."""
        event = self._event
        is_scalar = isinstance(event, yaml.ScalarEvent)
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            hint = "name a type or a layout and refer to it"
            self._report("yaml-alias", "anchors and aliases are not supported", hint)
        if isinstance(event, yaml.AliasEvent):
            return ""
        if event.tag is not None:
            hint = "a spec is plain data; remove the tag"
            self._report("yaml-tag", f"the tag `{event.tag}` is not supported", hint)
        if depth > MAX_DEPTH:
            hint = "check brackets and indentation"
            self._stop(Mark.of(event), "yaml-depth", f"this is nested deeper than {MAX_DEPTH} levels", hint)
        if is_scalar:
            return str(event.value) if event.tag else self._scalar(path)
        if isinstance(event, yaml.SequenceStartEvent):
            return self._items(path, depth + 1)
        return self._entries(path, depth + 1)

    def _items(self, path: DocumentPath | None, depth: int) -> list[Data]:
        items: list[Data] = []
        while not isinstance(event := self._next(), yaml.SequenceEndEvent):
            self._event = event
            self._count_value()
            items.append(self._value(None if path is None else (*path, len(items)), depth))
        return items

    def _entries(self, path: DocumentPath | None, depth: int) -> dict[str, Data]:
        entries: dict[str, Data] = {}
        next_event, names, known = self._next, self._names, self._plain if depth <= MAX_DEPTH else {}
        while not isinstance(event := next_event(), yaml.MappingEndEvent):
            self._event = event
            self._count_value()
            is_plain = isinstance(event, yaml.ScalarEvent) and not (event.style or event.anchor or event.tag)
            name = names.get(event.value) if is_plain else None
            if name is None:
                name = self._name(depth)
            is_first = name is not None and name not in entries
            if name is not None and not is_first:
                self._report_duplicate(path, name, entries)
            event = self._event = next_event()
            is_plain = isinstance(event, yaml.ScalarEvent) and not (event.style or event.anchor or event.tag)
            value: Data | None = known.get(event.value) if is_plain else None
            if value is None:
                child = (*path, name) if path is not None and name is not None and is_first else None
                value = self._value(child, depth)
            if name is not None and is_first:
                entries[name] = value
        return entries

    def _count_value(self) -> None:
        """Counts an entry of a mapping or a list, and stops reading if there are too many in the file."""
        self._values += 1
        if self._values > MAX_VALUES:
            text = f"the file has more than {MAX_VALUES} values"
            self._stop(Mark.of(self._event), "file-size", text, "split the protocol, or list fewer values")

    def _name(self, depth: int) -> str | None:
        """A key; None after an issue if it is not a name."""
        event, issues_before = self._event, len(self._issues)
        self._check_name(depth)
        written = getattr(event, "value", "")
        name = name_of(event)
        if name is None or len(self._issues) > issues_before or self._is_masked(written):
            return None
        if not event.style:
            self._names[written] = name
        return name

    def _check_name(self, depth: int) -> None:
        event = self._event
        if not isinstance(event, yaml.ScalarEvent) or event.anchor or event.tag:
            self._report("yaml", "a key must be a plain name", "use letters, digits and underscores")
            if isinstance(event, yaml.CollectionStartEvent):
                self._value(None, depth)
        elif not event.style and event.value == MERGE:
            self._report("yaml-alias", "merge keys are not supported", "name a type or a layout and refer to it")
        elif isinstance(self._scalar(None), bool):
            self._report("ambiguous-scalar", f"the key `{event.value}` is not a name", "put it in quotes")

    def _report_duplicate(self, path: DocumentPath | None, name: str, entries: dict[str, Data]) -> None:
        """Reports a second `name`. After a mapping, the cause may be that the mapping is indented too far."""
        if path is None:
            return
        keys, values = self._source.marks.keys, self._source.marks.values
        duplicate: DocumentPath = (*path, name)
        first = keys[duplicate]
        mappings = ((key, (*path, key)) for key in reversed(entries) if isinstance(entries[key], dict) and key != name)
        blocks = ((key, keys[at].line) for key, at in mappings if first.line < keys[at].line < values[at].line)
        indented = next((f"; or is `{key}` on line {line} indented too far?" for key, line in blocks), "")
        message = f"the key `{name}` is already on line {first.line}"
        related = first, f"the first `{name}`"
        self._add(Mark.of(self._event), "duplicate-key", message, f"remove or rename one{indented}", related)

    def _is_masked(self, text: str) -> bool:
        """Whether a text contains the mask of an invisible character."""
        return bool(self._hidden) and unicode_safety.CANNOT_BE_SEEN in text

    def _scalar(self, path: DocumentPath | None) -> Scalar:
        event = self._event
        text: str = event.value
        hidden = unicode_safety.unseen(text)
        for character in hidden:
            self._report_hidden(Mark.of(event), character)
        if event.style:
            return text
        value = plain(text)
        if value is not None and not hidden and not self._is_masked(text):
            self._plain[text] = value
        elif text == "":
            self._report_missing_value(path)
        elif value is None and (ambiguity := ambiguous.ambiguity(text)):
            rule, message, hint = ambiguity
            is_name = path is None and len(text) <= 40
            self._report(rule, message, f'for a name write "{text}" in quotes' if is_name else hint)
        return text if value is None else value
