"""The view of a family: its fields in filters, its preferences, and its editions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...model import formatting
from ...model.edition import Edition
from ...model.types import Parameter
from ..nested_source import Table
from . import text
from .filters import Filters, filters
from .tables import LuaTables

OWN_PREFERENCES = frozenset(("edition", "nodes", "marks", "sent", "window"))
"""Preferences of every dissector."""


@dataclass(frozen=True, kw_only=True)
class FamilyView:
    """A dissector."""

    name: str
    title: str
    example: str
    """The settings of a node in the preference `nodes`."""
    filters: Filters
    parameters: tuple[Table, ...]
    editions: tuple[Table, ...]


def family_view(editions: Sequence[Edition]) -> FamilyView:
    """The view of the editions of one family."""
    parameters: dict[str, list[tuple[Edition, Parameter]]] = {}
    for edition in editions:
        for parameter in edition.parameters:
            parameters.setdefault(parameter.name, []).append((edition, parameter))
    return FamilyView(
        name=editions[0].family,
        title=text.english(editions[0].title),
        example=example(editions),
        filters=filters(editions),
        parameters=tuple(map(_parameter, parameters.values())),
        editions=tuple(LuaTables(edition).view() for edition in editions),
    )


def example(editions: Sequence[Edition]) -> str:
    """The last edition with a value of each of its parameters, as in the preference `nodes`."""
    edition = editions[-1]
    settings = (
        f" {p.name}={p.values[-1].name if p.values else formatting.exact(p.minimum or p.maximum or 1)}"  # type: ignore[arg-type]
        for p in edition.parameters
    )
    return edition.name + "".join(settings)


def preference(name: str) -> str:
    """The name of the preference of a parameter."""
    return f"{name}_" if name in OWN_PREFERENCES else name


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
