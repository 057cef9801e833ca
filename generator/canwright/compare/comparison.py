"""What `compare` does; imported by the first comparison, because most runs compare nothing."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from ..model.edition import Edition
from ..semantics.configured import configured
from . import commands, edition_changes, match, missing_names, renames
from .change import Change
from .collector import Collector
from .exported_names import ExportedNames, Exporter
from .match import Named
from .verdicts import with_verdicts
from .witnesses.exchange_simulation import ExchangeSimulation


def changes(old: Edition, new: Edition, exporters: Sequence[Exporter]) -> tuple[Change, ...]:
    """Every change, with its verdict and witnesses."""
    names = ExportedNames(exporters, old, new)
    new = _in_order_of(old, new)
    collector = Collector(names, old, new)
    renamed = renames.compare(collector, old, new)
    edition_changes.compare(collector, renamed, new)
    matched = match.commands(renamed, new)
    commands.compare(collector, renamed, new, matched)
    missing_names.compare(collector, names, old)
    before, after = _with_ids(renamed, new)
    if (before, after) != (renamed, new):
        matched = match.commands(before, after)
    return with_verdicts(tuple(collector), ExchangeSimulation(before, after, matched).witnesses())


def _with_ids(old: Edition, new: Edition) -> tuple[Edition, Edition]:
    """The editions with a value in place of each parameter in ids and constants: the lowest that both allow."""
    lowest: dict[str, Fraction] = {}
    for parameter in (*old.parameters, *new.parameters):
        if parameter.whole and parameter.minimum is not None:
            lowest[parameter.name] = max(parameter.minimum, lowest.get(parameter.name, parameter.minimum))
    return configured(old, lowest), configured(new, lowest)


def _in_order_of(old: Edition, new: Edition) -> Edition:
    """The new edition with its items in the order of the old one, and others by name: its keys may have any order."""
    sections = ("parameters", "settings", "effects", "types", "layouts", "tables", "commands")
    return dataclasses.replace(new, **{name: _sorted_as(getattr(old, name), getattr(new, name)) for name in sections})


def _sorted_as(old: Sequence[Named], new: Sequence[Named]) -> Any:
    places = {item.name: place for place, item in enumerate(old)}
    return tuple(sorted(new, key=lambda item: (places.get(item.name, len(places)), item.name)))
