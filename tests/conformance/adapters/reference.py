"""The reference decoder and encoder of `semantics`, replayed as any target."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.semantics.decoder import Decoder, Rejection, Value as ModelValue
from canwright.semantics.encoder import Encoders
from canwright.semantics.exchange import check_reply
from canwright.targets.base import Described

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

    def __init__(self, edition: Edition) -> None:
        super().__init__(edition)
        self._decoder = Decoder(edition)
        self._encoders = Encoders()

    @classmethod
    def create(cls, described: Described, workdir: Path) -> ReferenceAdapter:
        """Needs no files."""
        return cls(described.edition)

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        known = assignment(parameters)
        if expected is None:
            found = self._decoder.decode(direction, frame, known)
        else:
            found = self._decoder.decode_as(self.message_of(direction, expected), frame, known)
        if isinstance(found, Rejection):
            return _refused(found)
        return Decoded(found.message.command, found.node, found.raws, {n: _value(v) for n, v in found.values.items()})

    def encode_raw(
        self, direction: Direction, command: str, node: int | None, raw: Mapping[str, Raw], parameters: Parameters
    ) -> Encoded | Refused:
        encoder = self._encoders.under(parameters)
        return _encoded(encoder.encode_raws(self.message_of(direction, command), node, raw))

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
    ) -> Encoded | Refused:
        encoder = self._encoders.under(parameters)
        return _encoded(encoder.encode_values(self.message_of(direction, command), node, values))

    def answers(self, request: CanFrame, reply: CanFrame) -> Refused | None:
        found = check_reply(self._decoder, request, reply)
        return _refused(found) if isinstance(found, Rejection) else None


def _refused(rejection: Rejection) -> Refused:
    return Refused(rejection.reason, rejection.field)


def _encoded(found: CanFrame | Rejection) -> Encoded | Refused:
    if isinstance(found, Rejection):
        return _refused(found)
    return Encoded(found.id, found.data, found.extended, found.remote)


def _value(value: ModelValue | list[ModelValue]) -> Value:
    if isinstance(value, list):
        return [_value(one) for one in value]  # type: ignore[return-value]
    return float(value) if isinstance(value, Fraction) else value
