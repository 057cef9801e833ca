from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.language import notation
from canwright.model import formatting
from canwright.model.layout import Space
from canwright.model.types import Bound, Order, Range
from hypothesis import given, strategies as st

from ..spec_texts import MINIMAL, edition


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.01", Fraction(1, 100)), ("16.5/2048", Fraction(33, 4096)), ("0x10", Fraction(16)), ("-1/3", Fraction(-1, 3))],
)
def test_rationals_are_exact(text: str, value: Fraction) -> None:
    assert notation.rational(text) == value


@pytest.mark.parametrize("written", ["0.0000001", "0.000000000000000000000000000001"])
def test_small_decimals_are_numbers(written: str, tmp_path: Path) -> None:
    linear = edition(tmp_path, MINIMAL.replace("scale: 0.1", f"scale: {written}")).types[0].linear
    scaled = linear.at({})
    assert scaled is not None and scaled.scale == Fraction(written)
    assert notation.value(Decimal(written)) == Fraction(written)


@pytest.mark.parametrize("text", ["1/0", "a", "1/", "1/2/3", "", "nan", "__import__('os')"])
def test_invalid_rationals_are_rejected(text: str) -> None:
    with pytest.raises(ValueError, match="`"):
        notation.rational(text)


def test_ranges_may_depend_on_a_parameter() -> None:
    assert notation.span("-850..850") == Range(Bound(Fraction(-850)), Bound(Fraction(850)))
    high = Bound(Fraction(-1), Fraction(36000), "gear_ratio")
    assert notation.span("0..36000*gear_ratio-1") == Range(Bound(Fraction(0)), high)
    assert high.at({"gear_ratio": Fraction(48, 5)}) == 345599
    assert high.at({}) is None
    assert formatting.span(notation.span("0..36000*gear_ratio-1")) == "0..36000*gear_ratio-1"


def test_a_number_may_be_a_multiple_of_a_parameter() -> None:
    assert notation.multiple("2/65535 * top") == notation.Multiple(Fraction(2, 65535), "top", "2/65535")
    assert notation.multiple("-top") == notation.Multiple(Fraction(-1), "top", "-1")
    assert notation.multiple("+top") == notation.multiple("top") == notation.Multiple(Fraction(1), "top", "1")
    assert notation.multiple("360/16384") == notation.Multiple(Fraction(360, 16384), None, "360/16384")
    assert notation.span("-1/2*top..top+1") == Range(
        Bound(Fraction(0), Fraction(-1, 2), "top"), Bound(Fraction(1), Fraction(1), "top")
    )
    assert formatting.span(notation.span("-top..0.5*top")) == "-top..0.5*top"


@pytest.mark.parametrize(
    "text", ["top*2", "2*", "*top", "2*3*top", "1/0*top", "top+1", "none", "2top", "1e3*top", "--top"]
)
def test_invalid_multiples_are_rejected(text: str) -> None:
    with pytest.raises(ValueError, match="`"):
        notation.multiple(text)


@pytest.mark.parametrize("text", ["5", "9..3", "0..X", "1..2..3", "0..2*Gear"])
def test_invalid_ranges_are_rejected(text: str) -> None:
    with pytest.raises(ValueError, match="range"):
        notation.span(text)


def test_id_expressions() -> None:
    assert notation.id_expression("0x140 + node") == notation.IdExpression(0x140, 1)
    assert notation.id_expression("node << 5 + 1") == notation.IdExpression(1, 32)
    assert notation.id_expression("300 + node * 10") == notation.IdExpression(300, 10)
    assert notation.id_expression("1 + (node << 5)") == notation.IdExpression(1, 32)
    assert notation.id_expression("0x10*node + 1") == notation.IdExpression(1, 16)
    assert notation.id_expression("640") == notation.IdExpression(640, None)
    for text in (
        "node + node",
        "0x140 - node",
        "node << x",
        "node * 0",
        "2 * node * 3",
        "10 << node",
        "(1 + node)",
        "(node",
        "((node))",
        "node *",
        "",
    ):
        with pytest.raises(ValueError, match="`"):
            notation.id_expression(text)


def test_positions() -> None:
    assert notation.at("4") == notation.At(Space.DATA, 4, None)
    assert notation.at("4.3") == notation.At(Space.DATA, 4, 3)
    assert notation.at("id.5") == notation.At(Space.ID, 0, 5)
    with pytest.raises(ValueError, match="position"):
        notation.at("4.8")


@pytest.mark.parametrize(
    ("at", "width", "order", "bits"),
    [
        ("4", 16, Order.LITTLE, range(32, 48)),
        ("1.4", 6, Order.LITTLE, range(12, 18)),
        ("0", 16, Order.BIG, [*range(8, 16), *range(8)]),
        ("3.3", 12, Order.BIG, [*range(32, 40), *range(24, 28)]),
        ("2", 12, Order.BIG, [*range(28, 32), *range(16, 24)]),
        ("id.5", 6, Order.BIG, range(5, 11)),
    ],
)
def test_bits_of_a_field(at: str, width: int, order: Order, bits: list[int]) -> None:
    assert list(notation.frame_bits(notation.at(at), width, order)) == list(bits)


@given(st.fractions())
def test_exact_numbers_round_trip(number: Fraction) -> None:
    assert notation.rational(formatting.exact(number)) == number


def test_each_edition_shows_a_scale_in_its_own_notation(tmp_path: Path) -> None:
    (decimal,) = edition(tmp_path, MINIMAL).types
    (quotient,) = edition(tmp_path, MINIMAL.replace("scale: 0.1", "scale: 1/10")).types
    assert decimal.linear == quotient.linear
    assert [formatting.scale(type_) for type_ in (decimal, quotient)] == [[("", "0.1 %")], [("", "1/10 %")]]
