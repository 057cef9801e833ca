"""Scales that are multiples of a number parameter: C and Python come to the same, and to what is exact."""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from math import floor

import pytest
from canwright.conformance.adapter import CanFrame, Decoded, Refused
from canwright.conformance.python import PythonAdapter
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import Linear, Type
from canwright.project.loader import specification
from canwright.semantics.decoder import linear_of
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget

from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.reference import ReferenceAdapter
from ..float_rule import raw_of_double

TYPES = {
    "whole": "{raw: u16, scale: 2/65535*top, offset: -top, range: -top..top}",
    "falling": "{raw: i12, scale: -3/7*top, offset: 1/3*top, range: -100*top..1/2*top}",
    "mixed": "{raw: i16, scale: {by: size, small: 1/32767*top, big: 0.01*other, odd: 0.5, none_known: none}}",
    "shifted": "{raw: u8, scale: {by: size, small: top, big: 2, odd: top, none_known: none},"
    " offset: {by: size, small: -128*top, big: 1, odd: 0, none_known: 0},"
    " raw_range: {by: size, small: 1..255, big: 0..9, odd: none, none_known: none}}",
    "long": "{raw: i32, scale: 0.001*top}",
    "longest": "{raw: u64, scale: 1/3*top}",
}
SIZES = ("small", "big", "odd")
NUMBERS = ("12.5", "0.3", "95.5", "1", "2147483647", "0.0000001", "3.1415926")
ROUNDS = 40


def spec() -> str:
    lines = [
        "canwright: 1\nfamily: multiples\nedition: v1",
        "addresses: {it: {id: 0x100}}\nselector: {at: id.0, raw: u4}",
        "parameters: {size: {values: [small, big, odd, none_known]}, top: {number: {}}, other: {number: {}}}",
        "types:",
        *(f"  {name}: {written}" for name, written in TYPES.items()),
        "commands:",
    ]
    for code, name in enumerate(TYPES):
        lines.append(f"  {name}: {{code: {code}, request: {{it: {{at: 0, type: {name}}}}}, reply: none}}")
    return "\n".join([*lines, ""])


Made = tuple[EditionInput, CAdapter, PythonAdapter]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("multiples")
    file = folder / "spec.yaml"
    file.write_text(spec(), "utf-8")
    edition_input = specification(file)
    return edition_input, CAdapter.create(edition_input, folder), PythonAdapter.create(edition_input, folder)


def known(size: str, number: str) -> dict[str, int | str]:
    return {"size": size, "top": number, "other": number}


def line(edition: Edition, name: str, parameters: Mapping[str, int | str | Fraction]) -> tuple[Type, Linear]:
    type_ = next(t for t in edition.types if t.name == name)
    linear = linear_of(type_, {key: str(value) for key, value in parameters.items()})
    assert linear is not None
    return type_, linear


def raws(type_: Type, chance: random.Random) -> list[int]:
    low, high = type_.raw_limits
    ends = [low, low + 1, 0, 1, (low + high) // 2, (low + high) // 2 + 1, high - 1, high]
    return ends + [chance.randint(low, high) for _ in range(ROUNDS)]


def nearest(exact: Fraction) -> int:
    size = floor(abs(exact) + Fraction(1, 2))
    return size if exact >= 0 else -size


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("name", TYPES)
def test_a_value_is_rounded_once(name: str, number: str, made: Made) -> None:
    edition_input, in_c, in_python = made
    for size in SIZES:
        parameters = known(size, number)
        type_, linear = line(edition_input.edition, name, parameters)
        for raw in raws(type_, random.Random(name + number)):
            data = (raw & ((1 << type_.width) - 1)).to_bytes(8, "little")
            frame = CanFrame(0x100 + list(TYPES).index(name), data)
            exact = float(raw * linear.scale + linear.offset)
            in_both = [target.decode(Direction.REQUEST, frame, parameters, None) for target in (in_c, in_python)]
            assert all(isinstance(answer, Decoded) for answer in in_both)
            values = [answer.values["it"] for answer in in_both if isinstance(answer, Decoded)]
            if name == "longest":  # products of more than 64 bits are rounded at each step in C
                assert values == [pytest.approx(exact, rel=2**-50, abs=0), exact], (raw, size)
            else:
                assert values == [exact, exact], (raw, size)


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("name", TYPES)
def test_a_value_goes_to_the_same_raw_integer(name: str, number: str, made: Made) -> None:
    edition_input, in_c, in_python = made
    chance = random.Random(name + number)
    for size in SIZES:
        parameters = known(size, number)
        type_, linear = line(edition_input.edition, name, parameters)
        limits = type_.raw_range.at({"size": size})
        low, high = (limits.low.constant, limits.high.constant) if limits else type_.raw_limits
        for raw in [*raws(type_, chance), low - 1, high + 1]:
            for part in (0, Fraction(1, 3), Fraction(1, 2)):
                value = Fraction(float((raw + part) * linear.scale + linear.offset))
                relative = type_.linear.at({"size": size})
                assert relative is not None
                raw_integer = raw_of_double(float(value), relative, Fraction(number))
                data = (raw_integer & ((1 << type_.width) - 1)).to_bytes(8, "little")
                fits = low <= raw_integer <= high
                expected = (
                    CanFrame(0x100 + list(TYPES).index(name), data) if fits else Refused(Refusal.OUT_OF_RANGE, "it")
                )
                for target in (in_c, in_python):
                    answer = target.encode_values(Direction.REQUEST, name, None, {"it": value}, parameters)
                    assert answer == expected, (size, raw, part)


@pytest.mark.parametrize("number", NUMBERS)
def test_the_middle_goes_away_from_zero(number: str, made: Made) -> None:
    _, in_c, in_python = made
    for target in (in_c, in_python):
        answer = target.encode_values(Direction.REQUEST, "whole", None, {"it": Fraction(0)}, {"top": number})
        assert answer == CanFrame(0x100, (32768).to_bytes(8, "little"))


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("name", [name for name in TYPES if name != "longest"])
def test_thousandths(name: str, number: str, made: Made) -> None:
    edition_input, in_c, _ = made
    for size in SIZES:
        parameters = known(size, number)
        type_, linear = line(edition_input.edition, name, parameters)
        limits = type_.raw_range.at({"size": size})
        low, high = (limits.low.constant, limits.high.constant) if limits else type_.raw_limits
        for raw in raws(type_, random.Random(name + number)):
            milli = nearest((raw * linear.scale + linear.offset) * 1000)
            assert in_c.milli(name, "to", raw, parameters) == milli, (size, raw)
            for near in (milli - 1, milli, milli + 1, milli * 2, -milli):
                back = nearest((Fraction(near, 1000) - linear.offset) / linear.scale)
                wanted = back if low <= back <= high else Refused(Refusal.OUT_OF_RANGE)
                assert in_c.milli(name, "from", near, parameters) == wanted, (size, near)
        for far in ((1 << 63) - 1, 1 - (1 << 63)):
            assert in_c.milli(name, "from", far, parameters) == Refused(Refusal.OUT_OF_RANGE), size


def test_no_thousandths_where_64_bits_are_too_few(made: Made) -> None:
    header = next(o.text for o in CTarget().generate([made[0]], {}) if o.path.endswith("/v1.h"))
    assert "longest_to_milli" not in header
    assert "No thousandths: 64 bits are too few to multiply with top" in " ".join(header.replace("*", " ").split())


@pytest.mark.parametrize(
    ("number", "says"), [("0", Refusal.OUT_OF_RANGE), ("-1", Refusal.OUT_OF_RANGE), ("", Refusal.MISSING_PARAMETER)]
)
def test_a_parameter_has_to_be_above_zero(number: str, says: Refusal, made: Made) -> None:
    item, in_c, in_python = made
    parameters: dict[str, int | str] = {"top": number} if number else {}
    for target in (in_c, in_python, ReferenceAdapter(item.edition)):
        for value in (Fraction(0), "nan"):
            answer = target.encode_values(Direction.REQUEST, "whole", None, {"it": value}, parameters)
            assert answer == Refused(says, "it")
    assert in_c.milli("whole", "to", 1, parameters) == Refused(says)
    assert in_c.milli("whole", "from", 1, parameters) == Refused(says)


def test_python_says_what_is_wrong_with_a_parameter(made: Made) -> None:
    module = made[2]._module
    texts: dict[object, str] = {
        None: "it depends on top, which is not given; pass Parameters(top=...)",
        0: "it depends on top, which has to be above 0 and is 0",
        -2.5: "it depends on top, which has to be above 0 and is -2.5",
        True: "it depends on top, and True is not a finite number",
        5e-324: "it=1.0 is out of range",
    }
    for top, text in texts.items():
        with pytest.raises(module.CodecError) as refused:
            module.WholeRequest(it=1.0, parameters=module.Parameters(top=top))
        assert str(refused.value).startswith(text)
        assert refused.value.field == "it"
    for top in (float("nan"), float("inf")):
        with pytest.raises(module.CodecError, match=f"top={top!r} is not a finite number"):
            module.Parameters(top=top)
    huge = module.FallingRequest.from_raw(it=200, parameters=module.Parameters(top=1.7e308))
    with pytest.raises(module.CodecError, match="it is larger than any float"):
        _ = huge.it
    assert module.WholeRequest(it=1, parameters=module.Parameters(top=1)).it_raw == 65535


def test_raw_integers_need_no_parameter(made: Made) -> None:
    _, in_c, in_python = made
    for target in (in_c, in_python):
        answer = target.encode_raw(Direction.REQUEST, "whole", None, {"it": 7}, {})
        assert answer == CanFrame(0x100, (7).to_bytes(8, "little"))
        decoded = target.decode(Direction.REQUEST, CanFrame(0x100, (7).to_bytes(8, "little")), {}, None)
        assert isinstance(decoded, Decoded)
        assert (decoded.raw, decoded.values) == ({"it": 7}, {})
