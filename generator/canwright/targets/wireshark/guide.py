"""Examples of the README: the file of each family, its preferences, and filters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...model.edition import Edition
from ..base import EditionInput
from .family import example, preference
from .filters import filters


@dataclass(frozen=True, kw_only=True)
class FamilyGuide:
    """A dissector as its README describes it."""

    name: str
    preferences: str
    """The page of its preferences."""
    editions: tuple[str, ...]
    parameters: tuple[str, ...]
    nodes: str
    command: str
    value: str
    """The filter of a field; empty without fields."""
    options: str
    """The options of tshark that set an edition and all parameters."""


def guide(specifications: Sequence[EditionInput]) -> tuple[FamilyGuide, ...]:
    """The families in their order."""
    families: dict[str, list[Edition]] = {}
    for one in specifications:
        families.setdefault(one.edition.family, []).append(one.edition)
    return tuple(_family(name, editions) for name, editions in families.items())


def _family(name: str, editions: Sequence[Edition]) -> FamilyGuide:
    edition = editions[0]
    fields = filters(editions)
    settings = [("edition", edition.name)]
    settings += [
        (preference(p.name), p.values[-1].name if p.values else str(p.minimum or p.maximum or 1))
        for p in edition.parameters
    ]
    return FamilyGuide(
        name=name,
        preferences=name.upper(),
        editions=tuple(one.name for one in editions),
        parameters=tuple(dict.fromkeys(preference(p.name) for one in editions for p in one.parameters)),
        nodes=f"1-4: {example(editions)}",
        command=next((command.name for command in edition.commands if command.request), ""),
        value=next(iter(fields.names.values()), ""),
        options=" ".join(f"-o {name}.{option}:{value}" for option, value in settings),
    )
