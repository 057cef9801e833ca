"""The names of the files of tables."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence

from .frames import Part
from .selectors import joined_span

TableKey = tuple[str, tuple[int, ...]]
"""The table of a part, and the bits of its selectors; without a table, the names of the selectors after the first."""


def table_key(part: Part) -> TableKey:
    """The table and the selector bits of a part whose selectors can be read as one number."""
    entry = part.command.entry
    table = entry.table if entry else "-".join(key.name for key, _ in part.selectors[1:])
    return table, tuple(joined_span(part) or ())


def table_names(parts: Iterable[Part]) -> Mapping[TableKey, str]:
    """A unique name for each table, as in `stored-settings`.

    Entries of a table with longer selectors than others need a file of their own. The file with most entries, or with
    the shorter selectors, has the name of the table; another one adds the last word that its entries have in common, or a number.
    """
    by_table: dict[str, dict[TableKey, list[str]]] = {}
    for part in parts:
        if joined_span(part):
            key = table_key(part)
            name = part.command.entry.name if part.command.entry else part.command.name
            by_table.setdefault(key[0], {}).setdefault(key, []).append(name)
    names: dict[TableKey, str] = {}
    for table, found in by_table.items():
        for i, (key, entries) in enumerate(sorted(found.items(), key=lambda item: (-len(item[1]), len(item[0][1])))):
            ending = [_common_ending(entries) or str(i + 1)] if i else []
            name = "-".join([table, *ending]).replace("_", "-")
            taken = (name if n == 1 else f"{name}-{n}" for n in itertools.count(1))
            names[key] = next(one for one in taken if one not in names.values())
    return names


def _common_ending(names: Sequence[str]) -> str:
    last, *others = {name.rpartition("_")[2] for name in names}
    return "" if others else last
