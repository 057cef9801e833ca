"""The selectors of a message as bits and numbers, separate or joined, and the names of the files with joined ones.

Few readers support nested multiplexors. If all selectors of a message are adjacent, they can be read as one number,
which is a plain multiplexor.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model.layout import ConstantRole, Space, bits_of
from ...model.message import Key
from .frames import Part


@functools.lru_cache(maxsize=1 << 10)
def bits(key: Key) -> tuple[int, ...]:
    """Frame bits of a key from the least significant up."""
    return bits_of(key.segments)


def selector_bits(part: Part) -> set[int]:
    return {bit for key, _ in part.selectors for bit in bits(key)}


def joined_span(part: Part) -> range | None:
    """The bits from the first selector to the last; None if there is only one, or if bits between them can vary."""
    if len(part.selectors) < 2:
        return None
    span = range(min(selector_bits(part)), max(selector_bits(part)) + 1)
    fixed = {bit for places, _ in _fixed(part) for bit in places}
    return span if fixed.issuperset(span) else None


def joined_value(part: Part, span: range) -> int:
    """The number in `span`, lowest bit first, in every frame of this part."""
    ones = {bit for places, value in _fixed(part) for i, bit in enumerate(places) if value >> i & 1}
    return sum(1 << i for i, bit in enumerate(span) if bit in ones)


def runs(numbers: Iterable[int], split: Iterable[int] = ()) -> list[tuple[int, ...]]:
    """Runs of adjacent numbers; each number in `split` is a run of its own."""
    adjacent: list[list[int]] = []
    for n in sorted(numbers):
        if adjacent and adjacent[-1][-1] == n - 1 and n not in split and n - 1 not in split:
            adjacent[-1].append(n)
        else:
            adjacent.append([n])
    return list(map(tuple, adjacent))


def _fixed(part: Part) -> Iterator[tuple[tuple[int, ...], int]]:
    """Bits with the same value in every frame of the part, and that value: selectors and constants."""
    yield from ((bits(key), value) for key, value in part.selectors)
    for field in part.message.layout.fields:
        if isinstance(field.role, ConstantRole) and field.space is Space.DATA and not field.only:
            yield from ((element.bits, field.role.raw) for element in field.elements)


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
    for table, keys in by_table.items():
        for i, (key, entries) in enumerate(sorted(keys.items(), key=lambda item: (-len(item[1]), len(item[0][1])))):
            ending = [_common_ending(entries) or str(i + 1)] if i else []
            name = "-".join([table, *ending]).replace("_", "-")
            numbered = (name if n == 1 else f"{name}-{n}" for n in itertools.count(1))
            names[key] = next(name for name in numbered if name not in names.values())
    return names


def _common_ending(names: Sequence[str]) -> str:
    last, *further = {name.rpartition("_")[2] for name in names}
    return "" if further else last
