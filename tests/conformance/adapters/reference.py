"""The reference decoder and encoder of `semantics`, replayed as any target."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS, Assignment, Type, product_of
from canwright.semantics.decoder import Decoder, Rejection, Value as ModelValue
from canwright.semantics.encoder import Encoders
from canwright.semantics.exchange import check_reply
from canwright.semantics.frame import node_of
from canwright.targets.base import EditionInput

from ...float_rule import effective
from ..adapter import (
    Adapter,
    CanFrame,
    Decoded,
    Encoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    Value,
    assignment,
)


class ReferenceAdapter(Adapter):
    """Answers from the model alone."""

    name = "reference"
    reports_code = True

    def __init__(self, edition: Edition) -> None:
        super().__init__(edition)
        self._decoder = Decoder(edition)
        self._encoders = Encoders()

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> ReferenceAdapter:
        """Needs no files."""
        return cls(specification.edition)

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        known = assignment(parameters)
        if expected is None:
            result = self._decoder.decode(direction, frame, known)
        else:
            result = self._decoder.decode_as(self.message_of(direction, expected), frame, known)
        if isinstance(result, Rejection):
            return _refused(result)
        missing = {
            f.name
            for f in result.variant.fields
            if f.name in result.values and self._is_missing(f, result.raws[f.name], parameters)
        }
        values = {name: _value(value) for name, value in result.values.items() if name not in missing}
        return Decoded(result.message.command, node_of(result.message, frame, known), result.raws, values, result.code)

    def _is_missing(self, field: Field, raw: Raw, parameters: Parameters) -> bool:
        """Whether the value of a field, or of an element of it, depends on a missing parameter."""
        if all(field.type.no_value(each) for each in (raw if isinstance(raw, list) else [raw])):
            return False
        if not field.type.is_number or not (field.type.linear.parameter or field.type.times):
            return False
        nearest = self._encoders.for_parameters(parameters).nearest_raw(field, Fraction(0))
        return isinstance(nearest, Rejection) and nearest.reason is Refusal.MISSING_PARAMETER

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> Encoded | Refused:
        encoder = self._encoders.for_parameters(parameters)
        return _encoded(encoder.encode_raws(self.message_of(direction, command), node, raw, code))

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> Encoded | Refused:
        """Fractions that are doubles are converted as targets convert doubles."""
        encoder = self._encoders.for_parameters(parameters)
        message = self.message_of(direction, command)
        fields = {field.name: field for field in message.layout.fields}
        given = {
            name: _as_double(value, fields[name].type, encoder.assignment) if name in fields else value
            for name, value in values.items()
        }
        return _encoded(encoder.encode_values(message, node, given, code))

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        result = check_reply(self._decoder, request, reply, assignment(parameters))
        return _refused(result) if isinstance(result, Rejection) else None


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


def _refused(rejection: Rejection) -> Refused:
    return Refused(rejection.reason, rejection.field)


def _encoded(result: CanFrame | Rejection) -> Encoded | Refused:
    if isinstance(result, Rejection):
        return _refused(result)
    return Encoded(result.id, result.data, result.extended, result.remote)


def _value(value: ModelValue | list[ModelValue]) -> Value:
    if isinstance(value, list):
        return [_value(element) for element in value]  # type: ignore[return-value]
    return float(value) if isinstance(value, Fraction) else value
