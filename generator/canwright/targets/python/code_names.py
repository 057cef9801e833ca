"""What Python programs write to use an edition."""

from __future__ import annotations

from collections.abc import Iterable

from ...model.edition import Edition
from ...model.types import Member, Parameter, ParameterValue
from ..base import CodeNames, ItemNames
from .class_bodies import depends_on_parameters
from .text import attribute, class_name, member_name


def code_names(edition: Edition) -> CodeNames:
    messages = edition.all_messages()
    types = {field.type: None for message in messages for field in message.layout.fields if not field.type.is_number}
    return CodeNames(
        language="python",
        source=f"{edition.family}.{edition.identifier}",
        parameters_type="Parameters",
        messages={message: class_name(message.name) for message in messages},
        needs_parameters=frozenset(m for m in messages if depends_on_parameters(m.layout)),
        fields={field.name: attribute(field.name) for m in messages for field in m.layout.fields},
        parameters={p: _parameter(p) for p in edition.parameters},
        types={t: _enum(class_name(t.name), t.name, (*t.enum, *t.flags)) for t in types},
    )


def _parameter(parameter: Parameter) -> ItemNames:
    name = attribute(parameter.name)
    if parameter.is_numeric:
        return ItemNames(name, "", {value.name: value.name for value in parameter.values})
    return _enum(name, parameter.name, parameter.values)


def _enum(name: str, item: str, members: Iterable[Member | ParameterValue]) -> ItemNames:
    class_ = class_name(item)
    return ItemNames(name, class_, {member.name: f"{class_}.{member_name(member.name)}" for member in members})
