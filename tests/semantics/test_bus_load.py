"""Frame lengths as in the literature on the response times of CAN (Davis, Burns, Bril, Lukkien 2007)."""

from __future__ import annotations

import pytest
from canwright.semantics.bus_load import FrameBits, frame_bits

FD = [
    # ISO 11898-1: 22 or 41 bits before the data, 27 or 32 of the checksum with its stuff bits, 10 at the end, 3 between frames
    (False, 0, FrameBits(62, 67)),
    (False, 16, FrameBits(190, 227)),
    (False, 20, FrameBits(227, 272)),
    (True, 64, FrameBits(598, 736)),
]


@pytest.mark.parametrize(("extended", "data_bytes", "expected"), FD)
def test_bits_of_frames_of_can_fd(extended: bool, data_bytes: int, expected: FrameBits) -> None:
    assert frame_bits(extended, data_bytes, is_fd=True) == expected


@pytest.mark.parametrize(
    ("extended", "data_bytes", "expected"),
    [
        (False, 8, FrameBits(111, 135)),
        (False, 0, FrameBits(47, 55)),
        (True, 8, FrameBits(131, 160)),
        (True, 0, FrameBits(67, 80)),
    ],
)
def test_bits_of_frames_with_and_without_stuffing(extended: bool, data_bytes: int, expected: FrameBits) -> None:
    assert frame_bits(extended, data_bytes) == expected
