"""Conversions of numbers in Python and in the reference encoder, compared with plain arithmetic of fractions."""

from __future__ import annotations

import math
import struct
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from canwright.model.message import Direction
from canwright.model.types import Encoding, Linear, Type
from canwright.semantics.decoder import value_of
from canwright.semantics.encoder import Encoder, exact_value
from canwright.targets.python.runtime._codec import CodecError, Float, Integer, Number, Real, Refusal
from hypothesis import example, given, settings, strategies as st

from ..float_rule import effective, raw_of_double
from ..spec_texts import edition
from ..verification.floating import SINGLE, bits_of

WIDTHS = st.sampled_from([8, 16, 24, 31, 32, 33, 51, 52, 53, 54, 56, 63, 64])
NUMERATORS = st.integers(-(10**6), 10**6).filter(bool) | st.sampled_from([1, -1, 10**15, 1 << 60])
DENOMINATORS = st.integers(1, 10**6) | st.sampled_from([1, 100, 1 << 20, 10**15])
OFFSETS = st.just(Fraction(0)) | st.fractions(-(10**6), 10**6, max_denominator=10**4) | st.just(Fraction(10**12, 7))


@st.composite
def numbers(draw: st.DrawFn) -> tuple[Number, Fraction, Fraction]:
    """A number with its scale and its offset."""
    width, signed = draw(WIDTHS), draw(st.booleans())
    numerator, denominator, offset = draw(NUMERATORS), draw(DENOMINATORS), draw(OFFSETS)
    low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
    scale = Fraction(numerator, denominator)
    return Number(low, high, scale=(scale.numerator, scale.denominator, offset)), scale, offset


def nearest(exact: Fraction) -> int:
    """The nearest integer, ties away from zero."""
    return math.floor(exact + Fraction(1, 2)) if exact > 0 else math.ceil(exact - Fraction(1, 2))


def converted(number: Number, value: Real) -> int | None:
    """The raw integer of a value; None when it is out of range."""
    try:
        return number.raw(value, None, "it")
    except CodecError as error:
        assert error.refusal is Refusal.OUT_OF_RANGE
        return None


@settings(max_examples=2000)
@given(st.data(), numbers())
def test_a_value_becomes_the_nearest_raw_integer(data: st.DataObject, case: tuple[Number, Fraction, Fraction]) -> None:
    number, scale, offset = case
    raw = data.draw(st.integers(number.low - 2, number.high + 2))
    steps = raw + data.draw(st.sampled_from([Fraction(0), Fraction(1, 2), Fraction(-1, 2), Fraction(499, 1000)]))
    exact = steps * scale + offset
    near = float(exact)
    given_values = (exact, near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf), round(exact))
    for value in (*given_values, Decimal(near)):
        wanted = nearest((Fraction(value) - offset) / scale)
        if isinstance(value, float):
            wanted = raw_of_double(value, Linear(scale, offset))
        assert converted(number, value) == (wanted if number.low <= wanted <= number.high else None)


@settings(max_examples=1000)
@given(st.data(), numbers())
def test_a_raw_integer_becomes_the_nearest_float(data: st.DataObject, case: tuple[Number, Fraction, Fraction]) -> None:
    number, scale, offset = case
    raw = data.draw(st.integers(number.low, number.high))
    assert number.value(raw, None, "it") == float(raw * scale + offset)


@settings(max_examples=500)
@given(raw=st.integers(0, (1 << 60) - 1), numerator=st.integers(1, 1 << 60), bits=st.integers(0, 60))
@example(raw=0xFFFF, numerator=(1 << 38) + 1, bits=3)
@example(raw=0xFFFF, numerator=(1 << 55) + 1, bits=3)
@example(raw=(1 << 55) + 5, numerator=3, bits=3)
def test_a_scale_that_depends_on_a_parameter_is_exact(raw: int, numerator: int, bits: int) -> None:
    largest = 0xFFFF if raw <= 0xFFFF else (1 << 60) - 1
    number = Number(0, largest, scale={1: (numerator, 1 << bits, 0), 2: (numerator, 3, 0)}, scale_by="real")
    for parameter, denominator in ((1, 1 << bits), (2, 3)):
        exact = Fraction(raw * numerator, denominator)
        assert number.value(raw, complex(parameter), "it") == float(exact)
        assert number.raw(exact, complex(parameter), "it") == raw


@given(st.integers(-(2**63), 2**63 - 1), st.sampled_from([Fraction(0), Fraction(1, 2), Fraction(-1, 2)]))
def test_an_integer_is_its_value(raw: int, part: Fraction) -> None:
    number = Integer(-(2**63), 2**63 - 1)
    assert (number.value(raw, None, "it"), number.raw(raw, None, "it")) == (raw, raw)
    wanted = nearest(raw + part)
    assert converted(number, raw + part) == (wanted if number.low <= wanted <= number.high else None)


@pytest.mark.parametrize("number", [Number(0, 255, scale=(1, 10, 0)), Integer(0, 255), Float(32), Float(64)])
def test_what_is_not_finite_or_too_large_is_refused(number: Number) -> None:
    for value in (math.nan, math.inf, -math.inf):
        with pytest.raises(CodecError, match="is not a finite number") as caught:
            number.raw(value, None, "it")
        assert caught.value.refusal is Refusal.NOT_FINITE
    for large in (10**400, -(10**400), Fraction(10**400, 3), 10**5000):
        assert converted(number, large) is None
    for wrong in ("1", None, [1], 1j):
        with pytest.raises(TypeError, match="is no number"):
            number.raw(wrong, None, "it")  # type: ignore[arg-type]


@settings(max_examples=500)
@given(st.data(), st.sampled_from([32, 64]), st.sampled_from([(1, 1, 0), (1, 10, 0), (-3, 7, Fraction(1, 3))]))
def test_a_float_is_scaled_by_one_operation_a_step(
    data: st.DataObject, width: int, scale: tuple[int, int, Fraction | int]
) -> None:
    number, (numerator, denominator, offset) = Float(width, scale=scale), scale
    pattern = {32: "<f", 64: "<d"}[width]
    stored = data.draw(st.floats(width=32 if width == 32 else 64, allow_nan=False, allow_infinity=False))
    bits = int.from_bytes(struct.pack(pattern, stored), "little")
    wanted = stored * numerator / denominator + float(offset)
    assert number.value(bits, None, "it") == wanted
    if math.isfinite(wanted):
        try:
            packed = struct.pack(pattern, (wanted - float(offset)) * denominator / numerator)
        except OverflowError:
            return
        if packed[-2:] not in (b"\xf0\x7f", b"\xf0\xff"):
            assert struct.unpack(pattern, number.raw(wanted, None, "it").to_bytes(width // 8, "little")) == (
                struct.unpack(pattern, packed)
            )


SPEC = """\
canwright: 1
family: lamp
edition: v1
addresses: {{lamp: {{id: 0x100}}}}
selector: {{at: 0, raw: u8}}
types: {{it: {{raw: {kind}, scale: {scale}, offset: {offset}}}}}
commands: {{dim: {{code: 1, request: {{it: {{at: 1, type: it}}}}, reply: none}}}}
"""


@pytest.mark.parametrize(("width", "scale", "offset"), [(56, "0.01", "0"), (56, "1/3", "-7/9"), (24, "33/2048", "0.1")])
def test_the_reference_converts_in_the_same_way(width: int, scale: str, offset: str, tmp_path: Path) -> None:
    loaded_edition = edition(tmp_path, SPEC.format(kind=f"i{width}", scale=scale, offset=offset))
    (message,) = loaded_edition.messages(Direction.REQUEST)
    (field,) = message.layout.fields
    line: Any = field.type.linear.constant
    ours = Number(*field.type.raw_limits, scale=(line.scale.numerator, line.scale.denominator, line.offset))
    encoder = Encoder({})

    @settings(max_examples=300)
    @given(st.integers(*field.type.raw_limits), st.sampled_from([0, 0.25, 0.5, -0.5]))
    def same(raw: int, part: float) -> None:
        exact = (raw + Fraction(part)) * line.scale + line.offset
        assert _value(field.type, raw) == ours.value(raw, None, "it")
        for value in (exact, float(exact)):
            given_value = effective(Fraction(value), field.type, line) if isinstance(value, float) else value
            theirs = encoder.field_raw(field, exact_value(given_value))
            assert (theirs if isinstance(theirs, int) else None) == converted(ours, value)

    same()


def test_an_exact_number_is_rounded_once(tmp_path: Path) -> None:
    loaded_edition = edition(tmp_path, SPEC.format(kind="f32", scale="0.5", offset="-40"))
    (message,) = loaded_edition.messages(Direction.REQUEST)
    (field,) = message.layout.fields
    ours, encoder = Float(32, scale=(1, 2, -40)), Encoder({})

    @settings(max_examples=200)
    @given(
        st.fractions() | st.integers(-(1 << 70), 1 << 70),
        st.sampled_from([Fraction(0), Fraction(1, 1 << 24), Fraction(1, 1 << 150)]),
        st.sampled_from([-1, 0, 1]),
    )
    @example(0, Fraction(1, 1 << 150), 1)
    @example(1, Fraction(1, 1 << 24), 1)
    @example(1, Fraction(1, 1 << 24), 0)
    def nearest(near: Fraction | int, tie: Fraction, beside: int) -> None:
        steps = near + tie + Fraction(beside, 1 << 200)
        value = steps / 2 - 40
        assert encoder.nearest_raw(field, value) == ours.raw(value, None, "it") == bits_of(steps, SINGLE)

    nearest()


def _value(type_: Type, raw: int) -> float:
    assert type_.encoding is Encoding.SIGNED
    value = value_of(type_, raw, {})
    assert isinstance(value, int | Fraction)
    return float(value)
