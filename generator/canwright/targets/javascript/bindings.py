"""The names of messages in the C and Python targets, for the code that the frame explorer shows."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.edition import Edition
from ...model.layout import Layout
from ...model.message import Direction, Message
from ...model.types import Parameter, Type
from ..c.names import Names, member
from ..python import text as python
from ..python.class_bodies import depends_on_parameters
from .tables import EditionTables
from .text import Value


def bindings(edition: Edition) -> Mapping[str, Value]:
    """Names by those of the spec; a field is listed where its name differs."""
    names, tables = Names(edition), EditionTables(edition)
    messages = {f"{m.direction.value} {m.command}": _message(names, edition, m) for m in edition.all_messages()}
    fields = {field.name for layout in tables.layouts for field in layout.fields}
    return {
        "header": f"{edition.family}/{edition.identifier}.h",
        "prefix": f"{edition.family}_{edition.identifier}".lower(),
        "module": f"{edition.family}.{edition.identifier}",
        "messages": messages,
        "members": {name: member(name) for name in sorted(fields) if member(name) != name},
        "attributes": {name: python.attribute(name) for name in sorted(fields) if python.attribute(name) != name},
        "parameters": {p.name: _parameter(names, p) for p in edition.parameters},
        "enums": {str(n): _enum(t) for t, n in tables.types.items() if not t.is_number},
        "fieldTypes": [[tables.types[field.type] for field in layout.fields] for layout in tables.layouts],
    }


def _message(names: Names, edition: Edition, message: Message) -> Value:
    return {
        "c": names.lower(message.name),
        "python": python.class_name(message.name),
        "takesParameters": _takes_parameters(message.layout) or _is_checked(edition, message),
        "dependsOnParameters": depends_on_parameters(message.layout),
    }


def _takes_parameters(layout: Layout) -> bool:
    """Whether the functions of C that check and pack a layout need parameters: for its fields, or for ranges."""
    ranges = [field.type.raw_range for field in layout.fields if field.role.is_value]
    bounds = [b for r in ranges for _, span in r.distinct() if span is not None for b in (span.low, span.high)]
    return layout.parameter is not None or any(r.parameter for r in ranges) or any(b.parameter for b in bounds)


def _is_checked(edition: Edition, message: Message) -> bool:
    """Whether C checks that a node has the command of a message: of a request that some nodes do not have."""
    only = edition.command(message.command).only if message.direction is Direction.REQUEST else {}
    return any(value.name not in values for name, values in only.items() for value in edition.parameter(name).values)


def _parameter(names: Names, parameter: Parameter) -> Value:
    values: dict[str, Value] = {
        value.name: {
            "c": names.upper(parameter.name, value.name),
            "python": value.name if parameter.is_numeric else _python_member(parameter.name, value.name),
        }
        for value in parameter.values
    }
    return {
        "c": member(parameter.name),
        "python": python.attribute(parameter.name),
        "class": None if parameter.is_numeric else python.class_name(parameter.name),
        "values": values or None,
    }


def _enum(type_: Type) -> Value:
    members = {one.name: _python_member(type_.name, one.name) for one in type_.enum or type_.flags}
    return {"class": python.class_name(type_.name), "isFlags": bool(type_.flags), "members": members}


def _python_member(name: str, value: str) -> str:
    return f"{python.class_name(name)}.{python.member_name(value)}"
