"""Frame lengths as in the literature on the response times of CAN (Davis, Burns, Bril, Lukkien 2007)."""

from __future__ import annotations

import pytest
from canwright.semantics.bus_load import FrameBits, frame_bits


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
