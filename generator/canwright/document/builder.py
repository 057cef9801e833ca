"""YAML events to plain data, in one pass; whatever is unsafe or ambiguous becomes a finding of the document."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import yaml

from ..diagnostics import unicode_safety
from ..diagnostics.diagnostic import DocumentPath
from . import ambiguous
from .marks import Mark
from .scalars import LOADER, MERGE, Scalar, name_of, plain

if TYPE_CHECKING:
    from .document import Data, Document

MAX_DEPTH = 24


class Builder:
    """Reads the one document of a text.

    A path is None within what is left out, such as the second of two values for one key. Most plain scalars stand in a
    file again and again, so what they are read as is kept, and looked up before anything else is asked of them.
    """

    def __init__(self, document: Document, text: str) -> None:
        self._document = document
        self._text = text
        self._is_covered = bool(document.findings)
        self._plain: dict[str, Scalar] = {}
        self._names: dict[str, str] = {}
        self._event: Any = None
        self._next: Callable[[], Any]

    def build(self) -> Data:
        """The data. Raises SpecError where reading cannot go on."""
        try:
            return self._build()
        except yaml.MarkedYAMLError as error:
            self._document.refuse_as_no_yaml(error, self._event)
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            what = next(iter(str(error).splitlines()), "")
            self._document.refuse(Mark(1, 1, 1), "yaml", f"this is not YAML: {what}")

    def _build(self) -> Data:
        self._next = LOADER(self._text).get_event
        self._next()  # stream start
        if isinstance(self._next(), yaml.StreamEndEvent):
            self._document.refuse(Mark(1, 1, 1), "yaml", "the file is empty", "it should hold one mapping")
        self._event = self._next()
        data = self._value((), 1)
        self._next()  # document end
        self._event = self._next()
        if not isinstance(self._event, yaml.StreamEndEvent):
            self._report("yaml", "a second document starts here", "a file holds one; remove the `---`")
        return data

    def _report(self, rule: str, message: str, hint: str = "", spoils: DocumentPath | None = None) -> None:
        self._document.report(Mark.of(self._event), rule, message, hint)
        if spoils is not None:
            self._document.unreadable.add(spoils)

    def _value(self, path: DocumentPath | None, depth: int) -> Data:
        """What starts with the current event."""
        event = self._event
        is_scalar = isinstance(event, yaml.ScalarEvent)
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            spoils = path if isinstance(event, yaml.AliasEvent) else None
            hint = "name a type or a layout and refer to it"
            self._report("yaml-alias", "anchors and aliases are not read", hint, spoils)
        if isinstance(event, yaml.AliasEvent):
            return ""
        if event.tag is not None:
            hint = "a spec is plain data; remove the tag"
            self._report("yaml-tag", f"the tag `{event.tag}` is not read", hint, path if is_scalar else None)
        if depth > MAX_DEPTH:
            hint = "no spec needs that; check brackets and indents"
            self._document.refuse(Mark.of(event), "yaml-depth", f"nested deeper than {MAX_DEPTH} levels", hint)
        if is_scalar:
            return str(event.value) if event.tag else self._scalar(path)
        if isinstance(event, yaml.SequenceStartEvent):
            return self._items(path, depth + 1)
        return self._entries(path, depth + 1)

    def _items(self, path: DocumentPath | None, depth: int) -> list[Data]:
        items: list[Data] = []
        while not isinstance(event := self._next(), yaml.SequenceEndEvent):
            self._event = event
            items.append(self._value(None if path is None else (*path, len(items)), depth))
        return items

    def _entries(self, path: DocumentPath | None, depth: int) -> dict[str, Data]:
        entries: dict[str, Data] = {}
        next_event, names, known = self._next, self._names, self._plain if depth <= MAX_DEPTH else {}
        while not isinstance(event := next_event(), yaml.MappingEndEvent):
            self._event = event
            is_plain = isinstance(event, yaml.ScalarEvent) and not (event.style or event.anchor or event.tag)
            name = names.get(event.value) if is_plain else None
            if name is None:
                name = self._name(path, depth)
            is_first = name is not None and name not in entries
            if name is not None and not is_first:
                self._report_twice(path, name)
            event = self._event = next_event()
            is_plain = isinstance(event, yaml.ScalarEvent) and not (event.style or event.anchor or event.tag)
            value: Data | None = known.get(event.value) if is_plain else None
            if value is None:
                child = (*path, name) if path is not None and name is not None and is_first else None
                value = self._value(child, depth)
            if name is not None and is_first:
                entries[name] = value
        return entries

    def _name(self, path: DocumentPath | None, depth: int) -> str | None:
        """A key; None for what is none, once that is reported."""
        event, found = self._event, len(self._document.findings)
        self._check_name(depth)
        written = getattr(event, "value", "")
        name = name_of(event)
        if name is None or len(self._document.findings) > found or self._is_marked(written):
            if path is not None:
                self._document.unreadable.add((*path, written))
            return None
        if not event.style:
            self._names[written] = name
        return name

    def _check_name(self, depth: int) -> None:
        event = self._event
        if not isinstance(event, yaml.ScalarEvent) or event.anchor or event.tag:
            self._report("yaml", "a key must be a plain name", "name it by letters, digits and underscores")
            if isinstance(event, yaml.CollectionStartEvent):
                self._value(None, depth)
        elif not event.style and event.value == MERGE:
            self._report("yaml-alias", "merge keys are not read", "name a type or a layout and refer to it")
        elif isinstance(self._scalar(None), bool):
            self._report("ambiguous-scalar", f"the key `{event.value}` is no name", "put it in quotes")

    def _report_twice(self, path: DocumentPath | None, name: str) -> None:
        if path is not None:
            twice: DocumentPath = (*path, name)
            first = self._document.places.keys[twice].line
            self._report("duplicate-key", f"`{name}` is there twice, first on line {first}", "remove or rename one")
            self._document.unreadable.add(twice)

    def _is_marked(self, text: str) -> bool:
        """Whether there was a character in a text that cannot be seen."""
        return self._is_covered and unicode_safety.CANNOT_BE_SEEN in text

    def _scalar(self, path: DocumentPath | None) -> Scalar:
        event = self._event
        text: str = event.value
        unseen = unicode_safety.unseen(text)
        for found in unseen:
            self._document.report_unseen(Mark.of(event), found)
        is_marked = unseen or self._is_marked(text)
        if is_marked and path is not None:
            self._document.unreadable.add(path)
        if event.style:
            return text
        value = plain(text)
        if value is not None and not is_marked:
            self._plain[text] = value
        elif text == "":
            self._document.report_without_value(Mark.of(event), path)
        elif value is None and (doubt := ambiguous.ambiguity(text)):
            rule, message, hint = doubt
            self._report(
                rule,
                message,
                hint if path is not None or len(text) > 40 else f'for a name write "{text}" in quotes',
                path,
            )
        return text if value is None else value
