"""Nested tables as source of a language: on one line if they fit, else with one entry on each line."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Union

WIDTH = 100
"""The characters of a table on one line with its indentation."""


Table = Mapping[str, "Value"] | Mapping[int, "Value"]
Value = Union[str, int, float, Table, Sequence["Value"], None]  # noqa: UP007 - a forward reference
"""What can be printed. An entry of a mapping that is None is left out."""


class Code(str):
    """A text that is source of the language already."""

    __slots__ = ()


class NestedSource(NamedTuple):
    """How a language writes tables: the `scalar` values, the `name` that starts an entry, and its brackets.

    Sequences are lists and tuples.
    """

    scalar: Callable[[str | float | None], str]
    name: Callable[[str | int], str]
    mapping: tuple[str, str]
    sequence: tuple[str, str]
    padding: str
    """Between the brackets of a mapping and its entries on one line."""
    step: int
    """The spaces by which entries are indented."""

    def printed(self, value: Value, indent: int = 0) -> str:
        """A value on one line if it fits, else with one entry on each line."""
        if value is None or isinstance(value, (str, int, float)):
            return self.scalar(value)
        margin = " " * (indent + self.step)
        if isinstance(value, Mapping):
            (opening, closing), padding = self.mapping, self.padding
            items = ((name, item) for name, item in value.items() if item is not None)
            entries = [self.name(name) + self.printed(item, len(margin)) for name, item in items]
        else:
            (opening, closing), padding = self.sequence, ""
            entries = [self.printed(item, len(margin)) for item in value]
        if not entries:
            return opening + closing
        line = ", ".join(entries)
        if len(line) + 2 * len(opening + padding) <= WIDTH - indent and "\n" not in line:
            return f"{opening}{padding}{line}{padding}{closing}"
        lines = f",\n{margin}".join(entries)
        return f"{opening}\n{margin}{lines},\n{' ' * indent}{closing}"
