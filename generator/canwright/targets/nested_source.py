"""Nested tables as source of a language: on one line if they fit, else with one entry on each line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

WIDTH = 120


class Code(str):
    """A text that is source of the language already."""

    __slots__ = ()


@dataclass(frozen=True, kw_only=True)
class NestedSource:
    """How a language writes tables: the `scalar` values, the `name` that starts an entry, and its brackets.

    An entry of a mapping that is None is left out.
    """

    scalar: Callable[[Any], str]
    name: Callable[[Any], str]
    mapping: tuple[str, str]
    sequence: tuple[str, str]
    padding: str
    """Between the brackets of a mapping and its entries on one line."""
    step: int
    """The spaces by which entries are indented."""

    def printed(self, value: Any, indent: int = 0) -> str:
        """A value on one line if it fits, else with one entry on each line."""
        if _is_scalar(value):
            return self.scalar(value)
        line = self._flat(value, WIDTH - 20 - indent)
        if line is not None:
            return line
        within = indent + self.step
        opening, closing = self._brackets(value)
        lines = (f"{' ' * within}{name}{self.printed(item, within)},\n" for name, item in self._entries(value))
        return f"{opening}\n{''.join(lines)}{' ' * indent}{closing}"

    def _flat(self, value: Any, room: int) -> str | None:
        """A table on one line; None if it has more than `room` characters."""
        parts: list[str] = []
        left = room
        for name, item in self._entries(value):
            part = self.scalar(item) if _is_scalar(item) else self._flat(item, left)
            left -= len(name) + len(part or "")
            if part is None or left < 0:
                return None
            parts.append(name + part)
        padding = self.padding if parts and isinstance(value, Mapping) else ""
        line = padding.join((self._brackets(value)[0], ", ".join(parts), self._brackets(value)[1]))
        return line if len(line) <= room else None

    def _brackets(self, value: Any) -> tuple[str, str]:
        return self.mapping if isinstance(value, Mapping) else self.sequence

    def _entries(self, value: Mapping[Any, Any] | Sequence[Any]) -> Iterator[tuple[str, Any]]:
        if isinstance(value, Mapping):
            return ((self.name(name), item) for name, item in value.items() if item is not None)
        return (("", item) for item in value)


def _is_scalar(value: object) -> bool:
    return value is None or isinstance(value, (str, int, float, Fraction))
