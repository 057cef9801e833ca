"""The fields of a family in the filters of Wireshark: one for each name, in all messages of all editions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field
from ...model.types import Encoding, Type
from ..nested_source import Table, Value
from . import text

OWN_NAMES = frozenset(
    ("edition", "command", "direction", "rule", "node", "request_in", "reply_in", "latency", "rejected", "expert")
)
"""Names that the dissector uses itself."""


@dataclass(frozen=True, kw_only=True)
class Filters:
    """The names of fields in filters, by their names in the spec, and the fields as Lua tables."""

    names: dict[str, str]
    fields: tuple[Table, ...]


def filters(editions: Iterable[Edition]) -> Filters:
    """The fields of the editions of one family."""
    by_name: dict[str, list[Field]] = {}
    for edition in editions:
        for layout in dict.fromkeys(message.layout for message in edition.all_messages()):
            for field in layout.fields:
                if field.role.is_value:
                    by_name.setdefault(field.name, []).append(field)
    names = {name: f"{name}_" if name in OWN_NAMES else name for name in by_name}
    return Filters(names=names, fields=tuple(_field(names[name], same) for name, same in by_name.items()))


def flag_filter(name: str) -> str:
    """The last part of the filter of a flag; `raw` is that of raw integers."""
    return f"{name}_" if name == "raw" else name


def _field(name: str, same: Sequence[Field]) -> Table:
    types = list(dict.fromkeys(field.type for field in same))
    is_raw = all(type_.is_plain or type_.enum or type_.flags for type_ in types)
    are_alike = len({bool(type_.is_number) for type_ in types}) == 1
    kind = _integer(types) if is_raw and are_alike else None
    labels = dict.fromkeys(text.english(field.title) for field in same if field.title)
    flags = {m.name: m for type_ in types for m in type_.flags}
    return {
        "name": name,
        "field": same[0].name,
        "label": next(iter(labels), "") or formatting.spoken(same[0].name),
        "kind": kind or "double",
        "raw": None if kind else _integer(types) or "uint64",
        "members": _members(types) if kind else None,
        "flags": [{"name": n, "filter": flag_filter(n), "label": text.english(m.title) or n} for n, m in flags.items()],
    }


def _integer(types: Sequence[Type]) -> str | None:
    """The smallest integer type of Wireshark for the raw integers of some types; None if none has all of them."""
    signed = any(type_.encoding is Encoding.SIGNED for type_ in types)
    width = max(type_.width + (signed and type_.encoding is not Encoding.SIGNED) for type_ in types)
    if width > 64:
        return None
    return ("int" if signed else "uint") + ("32" if width <= 32 else "64")


def _members(types: Sequence[Type]) -> Value:
    """The names of the values, if they are the same in all types and a number of Lua has each of them."""
    first = {member.value: member.name for member in types[0].enum}
    same = all({member.value: member.name for member in type_.enum} == first for type_ in types)
    return first if first and same and max(map(abs, first)) < text.EXACT else None
