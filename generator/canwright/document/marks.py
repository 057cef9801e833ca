"""The marks of the keys and values of a YAML text. Only findings need them, so they are computed on demand."""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import yaml

from ..diagnostics.diagnostic import DocumentPath
from .scalars import LOADER, name_of


class Mark(NamedTuple):
    """Line and column from 1, and the number of characters to underline."""

    line: int
    column: int
    length: int

    @classmethod
    def of(cls, event: Any) -> Mark:
        """The start of an event; a scalar on one line is underlined completely."""
        start, end = event.start_mark, event.end_mark
        whole = isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)) and start.line == end.line
        return cls(start.line + 1, start.column + 1, end.column - start.column if whole else 1)


class Source:
    """A YAML text with its lines and marks."""

    def __init__(self, text: str) -> None:
        self.text = text

    @cached_property
    def lines(self) -> list[str]:
        return self.text.split("\n")

    @cached_property
    def marks(self) -> Marks:
        return Marks(self.text)


class Marks:
    """The marks of all keys and values up to a syntax error; of two values for one key, the mark of the first."""

    def __init__(self, text: str) -> None:
        self.keys: dict[DocumentPath, Mark] = {}
        self.values: dict[DocumentPath, Mark] = {}
        try:
            self._next = LOADER(text).get_event
            while not isinstance(self._next(), yaml.DocumentStartEvent):
                pass
            self._value(self._next(), ())
        except (yaml.YAMLError, ValueError, OverflowError):
            return

    def _value(self, event: Any, path: DocumentPath | None) -> None:
        if path is not None:
            self.values[path] = Mark.of(event)
        if isinstance(event, yaml.SequenceStartEvent):
            self._items(path)
        elif isinstance(event, yaml.MappingStartEvent):
            self._entries(path)

    def _items(self, path: DocumentPath | None) -> None:
        index = 0
        while not isinstance(event := self._next(), yaml.SequenceEndEvent):
            self._value(event, None if path is None else (*path, index))
            index += 1

    def _entries(self, path: DocumentPath | None) -> None:
        while not isinstance(event := self._next(), yaml.MappingEndEvent):
            name = name_of(event)
            child = None if path is None or name is None or (*path, name) in self.keys else (*path, name)
            if child is not None:
                self.keys[child] = Mark.of(event)
            elif not isinstance(event, yaml.ScalarEvent):
                self._value(event, None)
            self._value(self._next(), child)
