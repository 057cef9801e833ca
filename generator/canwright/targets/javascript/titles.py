"""Titles of an edition in all its languages, for tools that show messages to people."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Command
from ...model.metadata import Effect
from ...model.types import Member, Parameter, Text, Type
from ..nested_source import Value
from ..tables import Positions
from .tables import tables_of


@lru_cache(maxsize=64)
def titles(edition: Edition) -> Mapping[str, Value]:
    """Titles by the names and positions that the tables have; what has none is left out. Cached as `tables_of` is."""
    tables = tables_of(edition)
    return {
        "family": edition.family,
        "edition": edition.name,
        "date": edition.date or None,
        "languages": list(edition.languages),
        "title": _text(edition.title),
        "parameters": {p.name: _parameter(p) for p in edition.parameters},
        "effects": {e.name: {"level": e.level.value, "title": _text(e.title)} for e in edition.effects},
        "commands": {command.name: _command(command) for command in edition.commands},
        "layouts": [[_field(field, tables) for field in layout.fields] for layout in tables.layouts],
        "types": [_type(type_) for type_ in tables.types],
    }


def _text(text: Text) -> Value:
    return dict(text) or None


def _parameter(parameter: Parameter) -> Value:
    values: dict[str, Value] = {value.name: _text(value.title) for value in parameter.values if value.title}
    return {"title": _text(parameter.title), "values": values or None}


def _command(command: Command) -> Value:
    return {
        "code": command.code,
        "title": _text(command.title),
        "manual": command.manual or None,
        "only": {name: list(values) for name, values in command.only.items()} or None,
        "effects": {effect.name: _exemptions(command, effect) for effect in command.effects} or None,
        "implemented": None if command.implemented else False,
    }


def _exemptions(command: Command, effect: Effect) -> Value:
    """Fields of the request, each with its raw integers without the effect."""
    fields: dict[str, list[Value]] = {}
    for field, member in command.exemptions(effect):
        fields.setdefault(field.name, []).append(str(member.value))
    return dict(fields)


def _field(field: Field, tables: Positions) -> Value:
    return {"title": _text(field.title or field.type.title), "type": tables.types[field.type]}


def _type(type_: Type) -> Value:
    """Resolutions (None if unknown) and ranges, each with the parameter values under which they apply; titles of members."""
    linears = (linear for _, linear in type_.linear.distinct())
    resolutions: list[Value] = [
        [names, None if linear is None else what]
        for (names, what), linear in zip(formatting.scale(type_), linears, strict=True)
    ]
    ranges: list[Value] = [list(case) for case in formatting.ranges(type_)]
    has_resolution = type_.is_number and not type_.is_plain and not type_.is_bare_float
    return {
        "resolution": resolutions if has_resolution else None,
        "range": ranges or None,
        "members": _members(type_.members) or None,
    }


def _members(members: tuple[Member, ...]) -> dict[str, Value]:
    return {member.name: _text(member.title) for member in members if member.title}
