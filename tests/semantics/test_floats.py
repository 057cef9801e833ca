"""Numbers of 32 bits as decimals for readers."""

from __future__ import annotations

import pytest
from canwright.semantics.floats import bits_of, float_of, shortest
from hypothesis import given, settings, strategies as st


@pytest.mark.parametrize(
    ("bits", "text"),
    [
        (0x3DCCCCCD, "0.1"),
        (0xBDCCCCCD, "-0.1"),
        (0x3F9D70A4, "1.23"),
        (0x4B7FFFFF, "16777215.0"),
        (0x3DFCD6EA, "0.12345679"),
        (0x7F7FFFFF, "3.4028235e+38"),
        (0x80000000, "-0.0"),
        (0x7F800000, "inf"),
    ],
)
def test_a_decimal_has_no_digits_that_the_frame_does_not_have(bits: int, text: str) -> None:
    assert str(shortest(float_of(32, bits))) == text


@given(st.floats(width=32, allow_nan=False))
@settings(deadline=None, derandomize=True)
def test_a_decimal_names_its_number(number: float) -> None:
    assert bits_of(32, shortest(number)) == bits_of(32, number)
