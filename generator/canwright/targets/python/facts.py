"""Facts of a command for tools, as class attributes of its request."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.message import Command
from ...model.types import Parameter
from . import text, types


def of_class(command: Command, parameters: Mapping[str, Parameter]) -> tuple[tuple[str, str], ...]:
    """Names and expressions; a fact that says nothing is left to the base class."""
    only = (
        f"{text.literal(name)}: {text.tuple_of(types.parameter_key(parameters[name], value) for value in values)}"
        for name, values in command.only.items()
    )
    found = [
        ("TITLE", text.literal(command.title.get("en") or next(iter(command.title.values())))),
        ("MANUAL", text.literal(command.manual)),
        ("EFFECTS", text.tuple_of(text.literal(effect.name) for effect in command.effects)),
        ("LIMITED_BY", text.tuple_of(text.literal(setting.name) for setting in command.limited_by)),
        ("ONLY", f"{{{', '.join(only)}}}"),
    ]
    return tuple((name, value) for name, value in found if value not in ("()", '""', "{}"))
