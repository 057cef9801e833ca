"""The reference decoder and encoder as programs use them: for an edition and the parameters of a node."""

from __future__ import annotations

from collections.abc import Mapping

from ..model.edition import Edition
from ..model.golden_frames import Value
from ..model.message import Direction, Message
from ..resolve.number_parameters import assignment
from ..semantics import decoder, encoder, exchange
from ..semantics.decoder import Decoded, Identified, Rejection
from ..semantics.encoder import Number
from ..semantics.frame import CanFrame, Raw


class Decoder:
    """Decodes frames to and from the nodes of an edition, under the parameters of these nodes.

    Parameters are names of values and numbers, also as text. Raises ValueError for unknown names and invalid values. A value
    that depends on a parameter that is not given is None.
    """

    def __init__(self, edition: Edition, parameters: Mapping[str, str | Number] | None = None) -> None:
        self._assignment = assignment([edition], parameters or {})
        self._decoder = decoder.Decoder(edition)

    def decode(self, direction: Direction, frame: CanFrame) -> Decoded | Rejection:
        """The message that a frame is, with its fields."""
        return self._decoder.decode(direction, frame, self._assignment)

    def decode_as(self, message: Message, frame: CanFrame) -> Decoded | Rejection:
        """The fields of a frame that is expected to be one message, as the reply to a request is."""
        return self._decoder.decode_as(message, frame, self._assignment)

    def check_reply(self, request: CanFrame, reply: CanFrame) -> Identified | Rejection:
        """The reply to a request that a frame is; rejected if it is not one, or if the request is rejected."""
        return exchange.check_reply(self._decoder, request, reply, self._assignment)


class Encoder:
    """Encodes messages to and from the nodes of an edition, under the parameters of these nodes.

    Parameters are names of values and numbers, also as text. Raises ValueError for unknown names and invalid values. A value
    that depends on a parameter that is not given is rejected.
    """

    def __init__(self, edition: Edition, parameters: Mapping[str, str | Number] | None = None) -> None:
        self._encoder = encoder.Encoder(assignment([edition], parameters or {}))

    def encode_values(
        self,
        message: Message,
        node: int | None,
        values: Mapping[str, Value | Number | list[Number]],
        code: int | None = None,
    ) -> CanFrame | Rejection:
        """The frame of a message with these values by field, and with a code as in `encode_raws`."""
        return self._encoder.encode_values(message, node, values, code)

    def encode_raws(
        self, message: Message, node: int | None, raws: Mapping[str, Raw], code: int | None = None
    ) -> CanFrame | Rejection:
        """The frame of a message with these raw integers by field. Raises ValueError for other fields.

        `code` is that of a decoded frame, one of those that the message accepts; None is the one that is usually sent.
        """
        return self._encoder.encode_raws(message, node, raws, code)
