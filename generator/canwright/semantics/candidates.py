"""The messages that a recorded frame can be if its direction and its request are unknown."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.edition import Edition
from ..model.layout import Space
from ..model.message import Direction, Key, Message
from .frame import CanFrame, data_bits, has_id


class Candidates:
    """The messages of an edition that have the id, the length and the keys of a frame, replies first.

    A reply is included for each code that it accepts, even if the decoder identifies the frame as another message.
    """

    def __init__(self, edition: Edition) -> None:
        self._messages = sorted(edition.all_messages(), key=lambda m: m.direction is Direction.REQUEST)
        self._of_id: dict[tuple[int, bool, bool], _OfId] = {}

    def has_id(self, frame: CanFrame) -> bool:
        """Whether some message has the id of a frame."""
        return bool(self._with_id(frame).patterns)

    def of(self, frame: CanFrame) -> Sequence[Message]:
        """The messages that a frame can be."""
        return self._with_id(frame).matching(frame)

    def _with_id(self, frame: CanFrame) -> _OfId:
        known = (frame.id, frame.extended, frame.remote)
        if known not in self._of_id:
            self._of_id[known] = _OfId([_Pattern(m) for m in self._messages if has_id(m, frame)])
        return self._of_id[known]


class _Pattern:
    """The keys of a message as masks and values of the data, read as one little-endian integer."""

    def __init__(self, message: Message) -> None:
        self.message = message
        keys = [key for key in message.keys if key.space is Space.DATA]
        first = keys[:1] if message.keys[:1] == tuple(keys[:1]) else []
        self.first_bits = data_bits((key.space, key.segments) for key in first)
        values = (message.keys[0].value, *message.accept, *message.claims) if first else ()
        self.first_values = {_placed(key, value) for key in first for value in values} or {0}
        others = keys[len(first) :]
        self.other_bits = data_bits((key.space, key.segments) for key in others)
        self.other_values = sum(_placed(key, key.value) for key in others)


class _OfId:
    """The messages of one id, cached by length and by the bits of all first keys."""

    def __init__(self, patterns: Sequence[_Pattern]) -> None:
        self.patterns = patterns
        self._bits = 0
        for pattern in patterns:
            self._bits |= pattern.first_bits
        self._known: dict[tuple[int, int], list[_Pattern]] = {}

    def matching(self, frame: CanFrame) -> list[Message]:
        data = int.from_bytes(frame.data, "little")
        known = (len(frame.data), data & self._bits)
        if known not in self._known:
            self._known[known] = [
                pattern
                for pattern in self.patterns
                if (frame.remote or pattern.message.dlc == known[0])
                and data & pattern.first_bits in pattern.first_values
            ]
        return [one.message for one in self._known[known] if data & one.other_bits == one.other_values]


def _placed(key: Key, value: int) -> int:
    """The value of a key at its position in the data."""
    return sum((value >> s.raw_low & (1 << s.width) - 1) << (s.byte * 8 + s.low) for s in key.segments)
