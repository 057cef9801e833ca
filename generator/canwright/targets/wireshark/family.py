"""The view of a family: its fields in filters, its preferences, its editions, and the examples of the README."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...diagnostics.unicode_safety import visible
from ...model import formatting
from ...model.edition import Edition
from ...model.joined import JoinedText
from ...model.layout import Field
from ...model.types import Encoding, Parameter, Type
from ..base import header
from ..nested_source import Table, Value
from . import text
from .tables import LuaTables

OWN_PREFERENCES = frozenset(("edition", "nodes", "marks", "sent", "window"))
"""Preferences of every dissector."""


def family_view(editions: Sequence[Edition]) -> Mapping[str, object]:
    """Variables of the dissector and of the README: the editions of one family."""
    first, last = editions[0], editions[-1]
    by_name: dict[str, list[tuple[Edition, Parameter]]] = {}
    for edition in editions:
        for parameter in edition.parameters:
            by_name.setdefault(parameter.name, []).append((edition, parameter))
    settings = [("edition", first.name), *((preference(p.name), _typical(p)) for p in first.parameters)]
    filters = Filters(editions)
    return {
        "editions": editions,
        "name": first.family,
        "title": text.english(first.title),
        "headers": [visible(header(edition)) for edition in editions],
        "tables": [LuaTables(edition).view() for edition in editions],
        "fields": filters.fields,
        "parameters": [_parameter(same) for same in by_name.values()],
        # settings of a node in the preference `nodes`: the last edition with a value of each of its parameters
        "nodes": " ".join([last.name, *(f"{p.name}={_typical(p)}" for p in last.parameters)]),
        "command": next((command.name for command in first.commands if command.request), ""),
        "field": next(iter(filters.names.values()), ""),
        "options": " ".join(f"-o {first.family}.{option}:{value}" for option, value in settings),
    }


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
        "whole": True if any(p.whole for _, p in same) else None,
        "positive": True if any(e.is_factor(p) for e, p in same) else None,
    }


OWN_NAMES = frozenset(
    ("edition", "command", "direction", "rule", "node", "request_in", "reply_in", "latency", "rejected", "expert")
)
"""Names that the dissector uses itself."""


class Filters:
    """The fields of the editions of one family."""

    def __init__(self, editions: Iterable[Edition]) -> None:
        by_name: dict[str, list[Field]] = {}
        for edition in editions:
            for layout in dict.fromkeys(message.layout for message in edition.all_messages()):
                for field in layout.fields:
                    if field.is_given or field.checksum:
                        by_name.setdefault(field.name, []).append(field)
        self.names = {name: f"{name}_" if name in OWN_NAMES else name for name in by_name}
        """The names in filters, by the names in the spec."""
        self.fields = [_field(self.names[name], same) for name, same in by_name.items()]


def flag_filter(name: str) -> str:
    """The last part of the filter of a flag; `raw` is that of raw integers."""
    return f"{name}_" if name == "raw" else name


def _field(name: str, same: Sequence[Field]) -> Table:
    types = list(dict.fromkeys(field.type for field in same))
    is_text = any(isinstance(type_.joined, JoinedText) for type_ in types)
    is_raw = all((type_.is_plain and not type_.no_values) or type_.enum or type_.flags for type_ in types)
    are_alike = len({bool(type_.is_number) for type_ in types}) == 1
    kind = _integer(types) if is_raw and are_alike else None
    labels = dict.fromkeys(text.english(field.title) for field in same if field.title)
    flags = {m.name: m for type_ in types for m in type_.flags}
    return {
        "name": name,
        "field": same[0].name,
        "label": next(iter(labels), "") or formatting.spoken(same[0].name),
        "kind": "string" if is_text else kind or "double",
        "raw": None if kind or is_text else _integer(types) or "uint64",
        "members": _members(types) if kind and not is_text else None,
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
