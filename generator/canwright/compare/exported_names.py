"""What the users of the bindings have to rename, from the names that each target exports."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition

MAX_DISAPPEARED = 3
"""So many names that disappear are shown for each target; the others are counted."""

Names = Mapping[DocumentPath, Sequence[str]]


class Exporter(Protocol):
    """What exports names for the items of a spec: a target."""

    @property
    def title(self) -> str: ...
    def exported_names(self, edition: Edition) -> Iterable[tuple[DocumentPath, str]]: ...


class _Exported(NamedTuple):
    """The names of a target in both editions."""

    title: str
    old: Names
    new: Names

    def missing(self) -> Iterator[tuple[DocumentPath, str]]:
        """The names that the new edition does not export for any item."""
        known = {name for names in self.new.values() for name in names}
        return ((path, name) for path, names in self.old.items() for name in names if name not in known)


class ExportedNames:
    """The names of the items of two editions in every target."""

    def __init__(self, exporters: Sequence[Exporter], old: Edition, new: Edition) -> None:
        self._exporters = exporters
        self._editions = old, new

    @functools.cached_property
    def _names(self) -> list[_Exported]:
        old, new = self._editions
        return [
            _Exported(e.title, _by_path(e.exported_names(old)), _by_path(e.exported_names(new)))
            for e in self._exporters
        ]

    def renamed(self, old: DocumentPath, new: DocumentPath) -> str:
        """``C `a_t` → `b_t`, Python `A` → `B` `` for the item at a path of each edition; empty where no name differs.

        The first name of each target is shown, the others are counted.
        """
        parts = []
        for title, before, after in self._names:
            pairs = zip(before.get(old, ()), after.get(new, ()), strict=False)
            parts.append(_listed(title, [f"`{a}` → `{b}`" for a, b in pairs if a != b], 1))
        return ", ".join(filter(None, parts))

    def missing(self) -> set[DocumentPath]:
        """The paths of items in the old edition with a name that the new edition does not export."""
        return {path for exported in self._names for path, _ in exported.missing()}

    def disappeared(self, paths: Iterable[DocumentPath]) -> str:
        """As `renamed`, of the items at these paths of the old edition; without `→` where there is no other name."""
        wanted, parts = set(paths), []
        for exported in self._names:
            names = {name: path for path, name in exported.missing() if path in wanted}
            parts.append(
                _listed(exported.title, [_with_successor(exported, *item) for item in names.items()], MAX_DISAPPEARED)
            )
        return ", ".join(filter(None, parts))


def _with_successor(exported: _Exported, name: str, path: DocumentPath) -> str:
    """A name and, if the item still has as many names, the one in its place."""
    old, new = exported.old[path], exported.new.get(path, ())
    return f"`{name}` → `{new[old.index(name)]}`" if len(old) == len(new) else f"`{name}`"


def _by_path(names: Iterable[tuple[DocumentPath, str]]) -> Names:
    by_path: dict[DocumentPath, dict[str, None]] = {}
    for path, name in names:
        by_path.setdefault(path, {})[name] = None
    return {path: tuple(of_path) for path, of_path in by_path.items()}


def _listed(title: str, names: Sequence[str], most: int) -> str:
    more = f" (+{len(names) - most})" if len(names) > most else ""
    return f"{title} {', '.join(names[:most])}{more}" if names else ""
