"""The reference decoder and encoder of `semantics`, replayed as any target."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Direction
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS
from ..semantics.decoder import Decoder, Rejection, Value as ModelValue
from ..semantics.encoder import Encoders
from ..semantics.exchange import check_reply
from ..semantics.frame import node_of
from ..targets.base import EditionInput
from .adapter import (
    Adapter,
    CanFrame,
    Decoded,
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
    ) -> CanFrame | Refused:
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
    ) -> CanFrame | Refused:
        encoder = self._encoders.for_parameters(parameters)
        return _encoded(encoder.encode_values(self.message_of(direction, command), node, values, code))

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        result = check_reply(self._decoder, request, reply, assignment(parameters))
        return _refused(result) if isinstance(result, Rejection) else None


def _refused(rejection: Rejection) -> Refused:
    return Refused(rejection.reason, rejection.field)


def _encoded(result: CanFrame | Rejection) -> CanFrame | Refused:
    return _refused(result) if isinstance(result, Rejection) else result


def _value(value: ModelValue | list[ModelValue]) -> Value:
    if isinstance(value, list):
        return [_value(element) for element in value]  # type: ignore[return-value]
    return float(value) if isinstance(value, Fraction) else value
