"""Metadata of a command for tools, as class attributes of its request."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model.message import Command
from ...model.types import Parameter
from . import code, text, types


def class_attributes(command: Command, parameters: Mapping[str, Parameter]) -> Iterator[code.Code]:
    """Assignments; what a command does not have is left to the base class."""
    yield f"TITLE = {text.literal(command.title.get('en') or next(iter(command.title.values())))}"
    if command.manual:
        yield f"MANUAL = {text.literal(command.manual)}"
    if command.effects:
        yield code.tuple_of((text.literal(effect.name) for effect in command.effects), "EFFECTS = ")
    if command.limited_by:
        yield code.tuple_of((text.literal(setting.name) for setting in command.limited_by), "LIMITED_BY = ")
    if command.only:
        only = (
            code.tuple_of(
                (types.parameter_key(parameters[name], v) for v in values), f"{text.literal(text.attribute(name))}: "
            )
            for name, values in command.only.items()
        )
        yield code.dict_of(only, "ONLY = ")
