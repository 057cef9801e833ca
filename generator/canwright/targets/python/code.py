"""Code that is laid out on several lines where one line would be too long, as formatters do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Union

WIDTH = 120
"""The most characters of a line of code."""


class Items(NamedTuple):
    """A call or a collection: code with items between, each on its own line where one line would be too long."""

    opening: str
    items: tuple[Code, ...]
    closing: str
    is_tuple: bool = False
    """Whether one item alone has a comma behind it."""

    def __str__(self) -> str:
        comma = "," if self.is_tuple and len(self.items) == 1 else ""
        return f"{self.opening}{', '.join(map(str, self.items))}{comma}{self.closing}"


class Parts(NamedTuple):
    """An expression in parentheses: its parts are on their own lines where one line would be too long.

    `optional` are the parentheses that are left out on one line.
    """

    opening: str
    parts: tuple[Code, ...]
    closing: str = ""
    optional: bool = False

    def __str__(self) -> str:
        whole = " ".join(map(str, self.parts))
        return f"{self.opening}{whole}{self.closing}" if self.optional else f"{self.opening}({whole}){self.closing}"


Code = Union[str, Items, Parts]  # noqa: UP007 - `Code` in `Items` is a forward reference


def call(function: str, arguments: Iterable[Code], before: str = "") -> Items:
    """A call; `before` precedes it on its line."""
    return Items(f"{before}{function}(", tuple(arguments), ")")


def tuple_of(items: Iterable[Code], before: str = "") -> Items:
    """A tuple; `before` precedes it on its line."""
    return Items(f"{before}(", tuple(items), ")", is_tuple=True)


def dict_of(items: Iterable[Code], before: str = "") -> Items:
    """A dictionary of items such as `key: value`; `before` precedes it on its line."""
    return Items(f"{before}{{", tuple(items), "}")


def any_of(target: str, terms: Sequence[str]) -> Parts:
    """An assignment of terms that are combined with `|`."""
    return Parts(f"{target} = ", (terms[0], *(f"| {term}" for term in terms[1:])), optional=True)


def laid_out(code: Code, indent: int = 0, after: int = 0) -> str:
    """Code whose first line starts at an indent; `after` characters follow its last line."""
    text, margin, inner = str(code), " " * indent, " " * (indent + 4)
    if isinstance(code, str) or indent + len(text) + after <= WIDTH:
        return text
    if isinstance(code, Items):
        lines = [f"{inner}{laid_out(item, indent + 4, 1)}," for item in code.items]
        return "\n".join([code.opening, *lines, margin + code.closing])
    whole = inner + " ".join(map(str, code.parts))
    lines = [whole] if len(whole) <= WIDTH else [inner + laid_out(part, indent + 4) for part in code.parts]
    return "\n".join([f"{code.opening}(", *lines, f"{margin}){code.closing}"])
