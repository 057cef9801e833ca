"""What the users of the bindings have to rename, from the names that each target exports."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Protocol

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition


class Exporter(Protocol):
    """What exports names for the items of a spec: a target."""

    @property
    def title(self) -> str: ...
    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]: ...


class ExportedNames:
    """The names of the items of two editions in every target."""

    def __init__(self, exporters: Sequence[Exporter], old: Edition, new: Edition) -> None:
        self._exporters = exporters
        self._editions = old, new

    @functools.cached_property
    def _names(self) -> list[tuple[str, Mapping[DocumentPath, str], Mapping[DocumentPath, str]]]:
        old, new = self._editions
        return [(e.title, e.exported_names(old), e.exported_names(new)) for e in self._exporters]

    def renamed(self, old: DocumentPath, new: DocumentPath) -> str:
        """``C `a_t` → `b_t`, Python `A` → `B` `` for the item at a path of each edition; empty where no name differs."""
        pairs = ((title, before.get(old), after.get(new)) for title, before, after in self._names)
        return ", ".join(f"{title} `{a}` → `{b}`" for title, a, b in pairs if a and b and a != b)
