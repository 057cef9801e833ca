"""The length of classic CAN frames on the bus, in bits, and the load that they cause."""

from __future__ import annotations

from typing import NamedTuple

from ..model.message import Message

INTERMISSION = 3
"""Bits after each frame."""
_FIXED = {False: 44, True: 64}
"""Bits of a data frame without data bytes and stuff bits, with 11 and with 29 bits of id."""
_STUFFED = {False: 34, True: 54}
"""Those of them to which stuff bits are added."""


class FrameBits(NamedTuple):
    """The length of a frame with the bits after it: without stuff bits, and with as many as there can be."""

    least: int
    most: int


def frame_bits(extended: bool, data_bytes: int) -> FrameBits:
    """The length of a frame. A stuff bit follows five equal bits, then at most every fourth bit."""
    least = _FIXED[extended] + 8 * data_bytes + INTERMISSION
    return FrameBits(least, least + (_STUFFED[extended] + 8 * data_bytes - 1) // 4)


def message_bits(message: Message) -> FrameBits:
    """The length of the frames of a message."""
    return frame_bits(message.id.extended, 0 if message.remote else message.dlc)
