"""What `compare` does; imported by the first comparison, because most runs compare nothing."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.edition import Edition
from . import commands, edition_changes, missing_names, renames
from .change import Change
from .collector import Collector
from .exported_names import ExportedNames, Exporter
from .verdicts import judged
from .witnesses.behaviour import Behaviour


def changes(old: Edition, new: Edition, exporters: Sequence[Exporter]) -> tuple[Change, ...]:
    """Every change, with its verdict and witnesses."""
    names = ExportedNames(exporters, old, new)
    found = Collector(names, new)
    renamed = renames.compare(found, old, new)
    edition_changes.compare(found, renamed, new)
    commands.compare(found, renamed, new)
    missing_names.compare(found, names, old)
    return judged(tuple(found), tuple(Behaviour(renamed, new).observations()))
