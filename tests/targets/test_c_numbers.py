"""Conversions of awkward types in C: negative and unequal scales, offsets, 64 bits, floats, ranges by parameters."""

from __future__ import annotations

import math
import random
import struct
from fractions import Fraction

import pytest
from canwright.conformance.adapter import CanFrame, Decoded, Parameters, Refused
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import Encoding, Type
from canwright.project.loader import specification

from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.c_facts import SINGLE_ERROR
from ..float_rule import bits_of_double, raw_of_double
from ..verification.floating import SINGLE, bits_of, number_of

TYPES = {
    "falling": "{raw: i16, scale: -0.3, offset: 5}",
    "shifted": "{raw: i12, scale: 7/3, offset: -1/7, raw_range: -100..100}",
    "fine": "{raw: u8, scale: 0.0001}",
    "nothing": "{raw: u8, scale: 0.0001, raw_range: 3..4}",
    "coarse": "{raw: i8, scale: 1000000}",
    "middle": "{raw: u25, scale: 7/3}",
    "wide": "{raw: i64, scale: 0.01}",
    "wider": "{raw: u64, scale: 1/3}",
    "seven": "{raw: i56, scale: 33/2048}",
    "by_size": "{raw: i16, scale: {by: size, small: 0.1, big: 3/7, huge: none}, offset: 2.5}",
    "limited": "{raw: u32, scale: 0.5, raw_range: 2*ratio+1..36000*ratio-1}",
    "below": "{raw: i16, raw_range: -30*ratio..-3*ratio}",
    "limited_by_size": "{raw: i16, raw_range: {by: size, small: -5..5, big: none, huge: 0..100}}",
    "angle": "{raw: u16, scale: 25.132741228718345/65535, offset: -12.566370614359172}",
    "digits": "{raw: i32, scale: 3.14159265358979323846}",
    "falling_digits": "{raw: i16, scale: -0.1234567890123456789012345}",
    "tiny": "{raw: u24, scale: 1/1000000000000000000000000000000}",
    "huge": "{raw: i24, scale: 1000000000000000000000000000000}",
    "whole": "{raw: u64}",
    "single": "{raw: f32, scale: -0.5, range: -3.1..7}",
    "precise": "{raw: f64, range: 0..0.1}",
    "free": "{raw: f32}",
}
SIZES = ("small", "big", "huge")
ROUNDS = 60


def spec() -> str:
    lines = [
        "canwright: 1\nfamily: numerals\nedition: v1",
        "addresses: {it: {id: node << 5, nodes: 1..3}}\nselector: {at: id.0, raw: u5}",
        f"parameters: {{size: {{values: {{{', '.join(f'{s}: {{}}' for s in SIZES)}}}}}, ratio: {{number: {{}}}}}}",
        "types:",
        *(f"  {name}: {written}" for name, written in TYPES.items()),
        "commands:",
    ]
    for code, name in enumerate(TYPES):
        lines.append(f"  {name}_command: {{code: {code}, request: {{it: {{at: 0, type: {name}}}}}, reply: none}}")
    return "\n".join([*lines, ""])


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Edition, CAdapter]:
    folder = tmp_path_factory.mktemp("numbers")
    file = folder / "spec.yaml"
    file.write_text(spec(), "utf-8")
    edition_input = specification(file)
    return edition_input.edition, CAdapter.create(edition_input, folder)


@pytest.mark.parametrize("name", TYPES)
@pytest.mark.parametrize("size", SIZES)
def test_from_raw_to_value(name: str, size: str, made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    type_ = _type(edition, name)
    linear = type_.linear.at({"size": size})
    for raw in _raws(type_, random.Random(name)):
        frame = CanFrame((1 << 5) | list(TYPES).index(name), (raw & ((1 << type_.width) - 1)).to_bytes(8, "little"))
        decoded = target.decode(Direction.REQUEST, frame, {"size": size}, None)
        assert isinstance(decoded, Decoded)
        assert decoded.raw["it"] == raw
        value = decoded.values["it"]
        if linear is None:
            assert value is None
            continue
        number = _number(type_, raw)
        assert isinstance(value, float)
        if math.isfinite(number):
            assert value == float(Fraction(number) * linear.scale + linear.offset), (name, raw)
        else:
            assert not math.isfinite(value)


@pytest.mark.parametrize("name", TYPES)
@pytest.mark.parametrize("size", SIZES)
def test_from_value_to_raw(name: str, size: str, made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    type_ = _type(edition, name)
    linear = type_.linear.at({"size": size})
    known: Parameters = {"size": size, "ratio": "7/2"}
    chance = random.Random(name)
    for raw in _raws(type_, chance):
        if linear is None:
            break
        number = _number(type_, raw)
        if not math.isfinite(number) or (number == 0 and type_.encoding is Encoding.FLOAT):
            continue
        between = Fraction(number) + Fraction(chance.choice(["0", "0.3", "0.5"]))
        value = float(between * linear.scale + linear.offset)
        is_float = type_.encoding is Encoding.FLOAT
        wanted = bits_of_double(value, type_, linear) if is_float else raw_of_double(value, linear)
        answer = target.encode_values(Direction.REQUEST, f"{name}_command", 2, {"it": Fraction(value)}, known)
        if wanted is None or not _within(type_, wanted, size):
            assert answer == Refused(Refusal.OUT_OF_RANGE, "it"), (name, value, wanted)
        else:
            data = (wanted & ((1 << type_.width) - 1)).to_bytes(8, "little")
            assert answer == CanFrame((2 << 5) | list(TYPES).index(name), data), (name, value, wanted)


def test_a_range_from_zero_has_both_zeros(made: tuple[Edition, CAdapter]) -> None:
    _, target = made
    minus_zero = 1 << 63
    answer = target.encode_raw(Direction.REQUEST, "precise_command", 1, {"it": minus_zero}, {})
    assert answer == CanFrame((1 << 5) | list(TYPES).index("precise"), minus_zero.to_bytes(8, "little"))


@pytest.mark.parametrize("name", TYPES)
def test_what_is_no_number_is_refused(name: str, made: tuple[Edition, CAdapter]) -> None:
    _, target = made
    for value in ("nan", "inf", "-inf"):
        answer = target.encode_values(
            Direction.REQUEST, f"{name}_command", 1, {"it": value}, {"size": "small", "ratio": "1"}
        )
        assert answer == Refused(Refusal.NOT_FINITE, "it")


@pytest.mark.parametrize("name", [n for n, written in TYPES.items() if "raw: f" not in written and "scale" in written])
def test_thousandths(name: str, made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    type_ = _type(edition, name)
    if name in ("wide", "wider", "seven", "angle", "digits", "falling_digits", "tiny", "huge"):
        assert not any(f"{name}_to_milli" in text for text in _headers(edition)), "64 bits are too few for these"
        return
    known: Parameters = {"size": "big", "ratio": "7/2"}
    linear = type_.linear.at({"size": "big"})
    assert linear is not None
    for raw in [r for r in _raws(type_, random.Random(name)) if _within_bits(type_, r)]:
        exact = (raw * linear.scale + linear.offset) * 1000
        milli = _round(exact)
        assert target.milli(name, "to", raw, known) == milli
        for near in range(milli - 2, milli + 3):
            back = _round((Fraction(near, 1000) - linear.offset) / linear.scale)
            wanted = back if _within(type_, back, "big") else Refused(Refusal.OUT_OF_RANGE)
            assert target.milli(name, "from", near, known) == wanted, (name, near)


@pytest.mark.parametrize("name", [n for n, written in TYPES.items() if "raw: f" not in written])
@pytest.mark.parametrize("size", SIZES[:2])
def test_single_precision(name: str, size: str, made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    type_ = _type(edition, name)
    linear = type_.linear.at({"size": size})
    assert linear is not None
    known: Parameters = {"size": size, "ratio": "7/2"}
    for raw in _raws(type_, random.Random(name)):
        value = raw * linear.scale + linear.offset
        error = SINGLE_ERROR * (abs(raw * linear.scale) + abs(linear.offset))
        single = target.single(name, "to", raw, known)
        assert isinstance(single, int)
        assert abs(number_of(single, SINGLE) - value) <= error, (name, raw)
        factor, addend, divisor = linear.as_quotient
        if max(max(map(abs, type_.raw_limits)) * abs(factor) + abs(addend), divisor) <= 1 << 24:
            assert single == bits_of(value, SINGLE), (name, raw)
        for steps in (Fraction(raw), raw + Fraction(1, 2)):
            bits = bits_of(steps * linear.scale + linear.offset, SINGLE)
            number = number_of(bits, SINGLE)
            back = (number - linear.offset) / linear.scale
            error = SINGLE_ERROR * (abs(number) + abs(linear.offset)) / abs(linear.scale)
            near = [_round(back - error), _round(back + error)]
            answer = target.single(name, "from", bits, known)
            if isinstance(answer, int):
                assert _within(type_, answer, size) and min(near) <= answer <= max(near), (name, raw)
            else:
                assert answer == Refused(Refusal.OUT_OF_RANGE)
                assert not all(_within(type_, bound, size) for bound in near), (name, raw)


def _headers(edition: Edition) -> list[str]:
    from canwright.targets.base import EditionInput
    from canwright.targets.c.target import CTarget

    return [
        output.text for output in CTarget().generate([EditionInput(edition, None)], {}) if output.path.endswith(".h")
    ]


def _type(edition: Edition, name: str) -> Type:
    return next(type_ for type_ in edition.types if type_.name == name)


def _raws(type_: Type, chance: random.Random) -> list[int]:
    low, high = type_.raw_limits
    raws = [low, low + 1, -106, -105, -11, -10, -1, 0, 1, 3, 4, 5, 8, 125998, 125999, 126000, high - 1, high]
    raws += [chance.randint(low, high) for _ in range(ROUNDS)]
    raws += [chance.randint(low, high) >> chance.randint(0, type_.width) for _ in range(ROUNDS)]
    if type_.encoding is Encoding.FLOAT:
        code = {32: ("<f", "<I"), 64: ("<d", "<Q")}[type_.width]
        numbers = [0.0, -0.0, 6.2, -14.0, -14.000001, 6.19999, 0.1, 0.10000001, -1e-30, 3e38]
        raws += [struct.unpack(code[1], struct.pack(code[0], number))[0] for number in numbers]
    return [raw for raw in raws if _within_bits(type_, raw)]


def _within_bits(type_: Type, raw: int) -> bool:
    low, high = type_.raw_limits
    return low <= raw <= high


def _within(type_: Type, raw: int, size: str) -> bool:
    limits = type_.raw_range.at({"size": size})
    if type_.encoding is Encoding.FLOAT:
        linear = type_.linear.at({"size": size})
        assert linear is not None
        number = _number(type_, raw)
        if not math.isfinite(number):
            return False
        value = Fraction(number) * linear.scale + linear.offset
        return limits is None or limits.low.constant <= value <= limits.high.constant
    if limits is None:
        return _within_bits(type_, raw)
    numbers = {"ratio": Fraction(7, 2)}
    low, high = limits.low.at(numbers), limits.high.at(numbers)
    return _within_bits(type_, raw) and low is not None and high is not None and low <= raw <= high


def _number(type_: Type, raw: int) -> float | int:
    if type_.encoding is not Encoding.FLOAT:
        return raw
    code = {32: ("<f", "<I"), 64: ("<d", "<Q")}[type_.width]
    number: float = struct.unpack(code[0], struct.pack(code[1], raw))[0]
    return number


def _round(number: Fraction) -> int:
    magnitude = math.floor(abs(number) + Fraction(1, 2))
    return magnitude if number >= 0 else -magnitude
