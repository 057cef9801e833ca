"""Numbers, texts and names of DBC files."""

from __future__ import annotations

from fractions import Fraction

import pytest
from canwright.targets.dbc.text import NAME_LENGTH, camel, fitting, in_ascii, number, text
from hypothesis import given, strategies as st


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (Fraction(1), "1"),
        (Fraction(100), "100"),
        (Fraction(0), "0"),
        (Fraction(1, 100), "0.01"),
        (Fraction(-33, 2048), "-0.01611328125"),
        (Fraction(1, 2**40), "0.0000000000009094947017729282379150390625"),
        (Fraction(1, 3), "0.3333333333333333"),
        (Fraction(1, 3 * 10**9), "0.0000000003333333333333333"),
        (Fraction(2**80, 3), "402975273204876400000000"),
        (Fraction(2**63 - 1), "9223372036854775807"),
    ],
)
def test_numbers_are_written_out(value: Fraction, written: str) -> None:
    assert number(value) == written


@given(st.integers(-(2**64), 2**64), st.integers(0, 40), st.integers(0, 40))
def test_finite_decimals_are_exact(numerator: int, twos: int, fives: int) -> None:
    value = Fraction(numerator, 2**twos * 5**fives)
    assert Fraction(number(value)) == value


@given(st.fractions(min_value=-(10**30), max_value=10**30))
def test_other_numbers_are_the_nearest_double_without_exponent(value: Fraction) -> None:
    assert "e" not in number(value).lower()
    assert float(number(value)) == float(value)


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("12 °C, 3 µs, 4 Ω", "12 degC, 3 us, 4 Ohm"),
        ('say "no"\\', "say 'no'/"),
        ("a\nSG_ b\r\n\tc\x00\x7f", "a SG_ b c"),
        ("naïve Å", "naive A"),
        ("\u202eevil\u2066", "evil"),
        ("电机温度", ""),
        ("写入 PID", ""),
        ("1 → 2½", "1 ? 21/2"),
    ],
)
def test_texts_are_one_line_of_ascii(written: str, shown: str) -> None:
    assert text(written) == shown


@given(st.text())
def test_no_text_breaks_out_of_its_quotes(written: str) -> None:
    assert all(" " <= c <= "~" and c not in '"\\' for c in text(written))


def test_english_replaces_texts_that_ascii_cannot_express() -> None:
    assert in_ascii({"zh": "电机", "en": "Motor"}) == "Motor"
    assert in_ascii({"zh": "电机"}) == ""
    assert in_ascii({}) == ""


def test_names_fit_and_differ() -> None:
    long_names = {fitting(f"{'x' * 40}_{i}") for i in range(12)}
    assert len(long_names) == 12
    assert {len(name) for name in long_names} == {NAME_LENGTH}
    assert fitting("BO_") == "BO__2"
    assert fitting("FLOAT") == "FLOAT_2"
    assert camel("left_arm") == "LeftArm"
