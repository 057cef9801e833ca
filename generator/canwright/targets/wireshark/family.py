"""The view of a family: its fields in filters, its preferences, its editions, and the examples of the README."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from ...diagnostics.unicode_safety import visible
from ...model import formatting
from ...model.edition import Edition
from ...model.types import Parameter
from ..base import header
from ..nested_source import Table
from . import text
from .filters import Filters, filters
from .tables import LuaTables

OWN_PREFERENCES = frozenset(("edition", "nodes", "marks", "sent", "window"))
"""Preferences of every dissector."""


@dataclass(frozen=True)
class FamilyView:
    """A dissector, of the editions of one family."""

    editions: Sequence[Edition]

    @property
    def name(self) -> str:
        return self.editions[0].family

    @property
    def title(self) -> str:
        return text.english(self.editions[0].title)

    @property
    def headers(self) -> Sequence[str]:
        return [visible(header(edition)) for edition in self.editions]

    @property
    def tables(self) -> Sequence[Table]:
        """The tables of each edition."""
        return [LuaTables(edition).view() for edition in self.editions]

    @cached_property
    def filters(self) -> Filters:
        return filters(self.editions)

    @property
    def parameters(self) -> Sequence[Table]:
        """The preferences of parameters."""
        by_name: dict[str, list[tuple[Edition, Parameter]]] = {}
        for edition in self.editions:
            for parameter in edition.parameters:
                by_name.setdefault(parameter.name, []).append((edition, parameter))
        return tuple(map(_parameter, by_name.values()))

    @property
    def nodes(self) -> str:
        """The settings of a node in the preference `nodes`: the last edition with a value of each of its parameters."""
        edition = self.editions[-1]
        return " ".join([edition.name, *(f"{p.name}={_typical(p)}" for p in edition.parameters)])

    @property
    def command(self) -> str:
        """A command with a request."""
        return next((command.name for command in self.editions[0].commands if command.request), "")

    @property
    def field(self) -> str:
        """The filter of a field; empty without fields."""
        return next(iter(self.filters.names.values()), "")

    @property
    def options(self) -> str:
        """The options of tshark that set an edition and all parameters."""
        edition = self.editions[0]
        settings = [("edition", edition.name), *((preference(p.name), _typical(p)) for p in edition.parameters)]
        return " ".join(f"-o {self.name}.{option}:{value}" for option, value in settings)


def preference(name: str) -> str:
    """The name of the preference of a parameter."""
    return f"{name}_" if name in OWN_PREFERENCES else name


def _typical(parameter: Parameter) -> str:
    """A value of a parameter for an example."""
    if parameter.values:
        return parameter.values[-1].name
    return formatting.exact(parameter.minimum or parameter.maximum or 1)  # type: ignore[arg-type]


def _parameter(same: Sequence[tuple[Edition, Parameter]]) -> Table:
    """A parameter of several editions: all values of a choice, and the limits of a number that all editions allow."""
    first = same[0][1]
    values = dict.fromkeys(value.name for _, parameter in same for value in parameter.values)
    minimum = [p.minimum for _, p in same if p.minimum is not None]
    maximum = [p.maximum for _, p in same if p.maximum is not None]
    return {
        "name": first.name,
        "preference": preference(first.name),
        "label": text.english(first.title) or formatting.spoken(first.name),
        "about": text.english(first.about),
        "values": list(values) or None,
        "minimum": text.number(max(minimum)) if minimum and not values else None,
        "maximum": text.number(min(maximum)) if maximum and not values else None,
        "positive": True if any(e.is_factor(p) for e, p in same) else None,
    }
