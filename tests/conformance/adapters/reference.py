"""The reference decoder and encoder, which converts doubles as targets do."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from canwright.conformance import reference
from canwright.conformance.adapter import CanFrame, ExactValue, Parameters, Refused, assignment
from canwright.model.message import Direction
from canwright.model.types import Assignment, Type, product_of

from ...float_rule import effective


class ReferenceAdapter(reference.ReferenceAdapter):
    """Answers from the model alone; fractions that are doubles are converted as targets convert doubles."""

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        known = assignment(parameters)
        types = {field.name: field.type for field in self.message_of(direction, command).layout.fields}
        given = {
            name: _as_double(value, types[name], known) if name in types else value for name, value in values.items()
        }
        return super().encode_values(direction, command, node, given, parameters, code)


def _as_double(value: ExactValue, type_: Type, known: Assignment) -> ExactValue:
    if isinstance(value, list):
        return [as_double(element, type_, known) for element in value]
    return as_double(value, type_, known)


def as_double(value: Fraction | str, type_: Type, known: Assignment) -> Fraction | str:
    """The exact value of the raw integer that a double is converted to; any other value itself."""
    linear = type_.linear.at(known)
    if not isinstance(value, Fraction) or linear is None:
        return value
    times = product_of(known, linear.times or "")
    return value if times is None else effective(value, type_, linear, times)
