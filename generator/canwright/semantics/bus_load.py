"""The length of frames on the bus, in bits.

Those of CAN FD count as if the bit rate did not switch, so a bus with bit rate switch has less load.
"""

from __future__ import annotations

from typing import NamedTuple

from ..model.message import Message
from ..model.metadata import FrameFormat

INTERMISSION = 3
"""Bits after each frame."""
_FIXED = {False: 44, True: 64}
"""Bits of a data frame without data bytes and stuff bits, with 11 and with 29 bits of id."""
_STUFFED = {False: 34, True: 54}
"""Those of them to which stuff bits are added."""
_FD_START = {False: 22, True: 41}
"""Bits before the data of a CAN FD frame; stuff bits are added to them and to the data."""
_FD_END = 10
"""Bits after its checksum."""
_LONG_CHECKSUM = 17
"""With so many data bytes, the checksum has 21 bits instead of 17."""


class FrameBits(NamedTuple):
    """The length of a frame with the bits after it: without stuff bits, and with as many as there can be."""

    least: int
    most: int


def frame_bits(extended: bool, data_bytes: int, *, is_fd: bool = False) -> FrameBits:
    """The length of a frame. A stuff bit follows five equal bits, then at most every fourth bit.

    A CAN FD frame has a count of stuff bits of 4 bits with its checksum, and fixed stuff bits before and in both.
    """
    if is_fd:
        stuffed = _FD_START[extended] + 8 * data_bytes
        checked = 4 + (21 if data_bytes >= _LONG_CHECKSUM else 17)
        least = stuffed + checked + 1 + checked // 4 + _FD_END + INTERMISSION
        return FrameBits(least, least + (stuffed - 1) // 4)
    least = _FIXED[extended] + 8 * data_bytes + INTERMISSION
    return FrameBits(least, least + (_STUFFED[extended] + 8 * data_bytes - 1) // 4)


def message_bits(message: Message, frame_format: FrameFormat) -> FrameBits:
    """The length of the frames of a message."""
    return frame_bits(message.id.extended, message.length, is_fd=frame_format.is_fd)
