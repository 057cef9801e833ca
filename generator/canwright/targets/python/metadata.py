"""Metadata of a command for tools, as class attributes of its request."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model.message import Command
from ...model.types import Parameter
from . import text, types


def class_attributes(command: Command, parameters: Mapping[str, Parameter]) -> Iterator[tuple[str, str]]:
    """Names and expressions; what a command does not have is left to the base class."""
    yield "TITLE", text.literal(command.title.get("en") or next(iter(command.title.values())))
    if command.manual:
        yield "MANUAL", text.literal(command.manual)
    if command.effects:
        yield "EFFECTS", text.tuple_of(text.literal(effect.name) for effect in command.effects)
    if command.limited_by:
        yield "LIMITED_BY", text.tuple_of(text.literal(setting.name) for setting in command.limited_by)
    if command.only:
        only = (
            f"{text.literal(name)}: {text.tuple_of(types.parameter_key(parameters[name], value) for value in values)}"
            for name, values in command.only.items()
        )
        yield "ONLY", f"{{{', '.join(only)}}}"
