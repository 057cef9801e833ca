"""Which fields exist where a command does, by the parameters that decide on both."""

from __future__ import annotations

from ..model.layout import Field, Layout
from ..model.message import Command


def is_available(layout: Layout, field: Field, command: Command) -> bool:
    """Whether the field exists for a parameter value that has the command."""
    return not field.only or bool(values_of(layout.parameter or "", layout, field, command))


def values_of(parameter: str, layout: Layout, field: Field, command: Command) -> tuple[str, ...]:
    """The values of a parameter under which a command has a field, if it is limited to some; empty for all and for none."""
    of_field = field.only if layout.parameter == parameter else ()
    of_command = command.only.get(parameter, ())
    return (
        tuple(value for value in of_field if value in of_command) if of_field and of_command else of_field or of_command
    )
