"""The messages that a recorded frame can be if its direction and its request are unknown."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.edition import Edition
from ..model.message import Direction, Message
from .bits import data_bits
from .decoder import Decoder, Identified
from .frame import CanFrame, has_id, is_message
from .plan import only_by_request

MAX_KNOWN = 1 << 16
"""The maximum number of ids, and of kinds of frames, that are remembered."""


class Candidates:
    """What the dispatch plan makes of a frame in each direction, and the replies that only a request explains.

    Such a reply has a code that, without its request, belongs to another message.
    """

    def __init__(self, edition: Edition) -> None:
        self._decoder = Decoder(edition)
        self._messages = edition.all_messages()
        self._answers = only_by_request(edition)
        self._key_bits: dict[tuple[int, bool, bool], int | None] = {}
        self._known: dict[tuple[int, bool, bool, int, int], Sequence[Message]] = {}

    def has_id(self, frame: CanFrame) -> bool:
        """Whether some message has the id of a frame."""
        return self.key_bits(frame) is not None

    def of(self, frame: CanFrame) -> Sequence[Message]:
        """The messages that a frame can be, replies first; cached by id, length and the bits of all keys."""
        bits = int.from_bytes(frame.data, "little") & (self.key_bits(frame) or 0)
        known = (frame.id, frame.extended, frame.remote, len(frame.data), bits)
        if known not in self._known:
            if len(self._known) >= MAX_KNOWN:
                self._known.clear()
            self._known[known] = self._candidates(frame)
        return self._known[known]

    def key_bits(self, frame: CanFrame) -> int | None:
        """The data bits of all keys of the messages with this id; None without such a message."""
        known = (frame.id, frame.extended, frame.remote)
        if known not in self._key_bits:
            if len(self._key_bits) >= MAX_KNOWN:
                self._key_bits.clear()
            having = [message for message in self._messages if has_id(message, frame)]
            bits = data_bits((key.space, key.segments) for message in having for key in message.keys)
            self._key_bits[known] = bits if having else None
        return self._key_bits[known]

    def _candidates(self, frame: CanFrame) -> Sequence[Message]:
        reply, request = (
            self._decoder.identify(direction, frame) for direction in (Direction.REPLY, Direction.REQUEST)
        )
        replies = [reply.message] if isinstance(reply, Identified) else []
        replies += [answer for answer in self._answers if answer not in replies and is_message(answer, frame)]
        return [*replies, request.message] if isinstance(request, Identified) else replies
