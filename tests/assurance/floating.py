"""Compares the conversions of `canwright_float.h` with exact fractions: `python -m tests.assurance.floating [COUNT]`.

Random and boundary cases: scales up to 63 bits, offsets, ratios, ties between raw integers and their neighbours,
integers above 2^53, subnormal and huge numbers.
"""

from __future__ import annotations

import argparse
import math
import random
import struct
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from canwright.targets.c import RUNTIME

from ..compilers import build

PROGRAM = Path(__file__).with_name("floating.c")
SINGLE, DOUBLE = 24, 53
DEFAULT_COUNT = 1_000_000
SCALES = ("1", "1/10", "1/100", "1/1000", "33/2048", "33/4096", "2/125", "-3/10", "7/3", "-1/2", "360/65536", "0.0001")
OFFSETS = ("0", "0", "0", "5", "-40", "-1/7", "100.5", "-273.15")


class Linear(NamedTuple):
    """value = ratio * (raw * factor + addend) / divisor."""

    factor: int
    addend: int
    divisor: int
    numerator: int
    denominator: int

    def value(self, raw: Fraction) -> Fraction:
        return Fraction(self.numerator, self.denominator) * (raw * self.factor + self.addend) / self.divisor

    def raw(self, value: Fraction) -> Fraction:
        return (value * self.divisor * self.denominator / self.numerator - self.addend) / self.factor


class Case(NamedTuple):
    """One call of the program; `number` is a raw integer, or the bits of a number."""

    operation: str
    linear: Linear
    number: int

    def line(self) -> str:
        return f"{self.operation} {' '.join(map(str, self.linear))} {self.number & (1 << 64) - 1:X}\n"


def differences(program: Path, count: int, seed: int) -> list[str]:
    """The cases in which the program and the fractions differ."""
    cases = list(_cases(count, random.Random(seed)))
    lines = "".join(case.line() for case in cases)
    done = subprocess.run([program], input=lines, capture_output=True, text=True, check=True)
    answers = done.stdout.splitlines()
    assert len(answers) == len(cases)
    return [
        f"{case}: {answer}, expected {expected}"
        for case, answer in zip(cases, answers, strict=True)
        if answer != (expected := _expected(case))
    ]


def compiled(folder: Path, *flags: str) -> Path:
    """The program."""
    return build([PROGRAM], RUNTIME, folder / "floating", *flags)


def _expected(case: Case) -> str:
    """The answer of the program according to fractions."""
    operation, linear, number = case
    precision = SINGLE if operation.isupper() else DOUBLE
    match operation.lower():
        case "v":
            return _ok(bits_of(linear.value(Fraction(number)), SINGLE))
        case "w":
            nearest = nearest_integer(linear.raw(number_of(number, SINGLE)))
            return _ok(nearest & (1 << 64) - 1) if abs(nearest) <= _narrow_limit(linear) else "out_of_range 0"
        case "s" | "u":
            return _ok(bits_of(linear.value(Fraction(number)), precision))
        case "a" | "b":
            source = SINGLE if operation.lower() == "a" else DOUBLE
            return _ok(bits_of(linear.value(number_of(number, source)), precision))
        case "n" | "m":
            nearest = nearest_integer(linear.raw(number_of(number, precision)))
            low, high = (-(1 << 63), (1 << 63) - 1) if operation.lower() == "n" else (0, (1 << 64) - 1)
            return _ok(nearest & (1 << 64) - 1) if low <= nearest <= high else "out_of_range 0"
        case _:
            bits = number
            if operation.lower() == "d" or linear != (1, 0, 1, 1, 1):
                bits = bits_of(linear.raw(number_of(number, precision)), DOUBLE)
                precision = DOUBLE
            if operation.lower() == "c" and precision != SINGLE:
                if not _is_finite(bits, DOUBLE):
                    return "out_of_range 0"
                bits, precision = bits_of(number_of(bits, DOUBLE), SINGLE) | bits >> 63 << 31, SINGLE
            return _ok(bits) if _is_finite(bits, precision) else "out_of_range 0"


def nearest_integer(number: Fraction) -> int:
    """The nearest integer, ties away from zero."""
    return math.floor(abs(number) + Fraction(1, 2)) * (1 if number > 0 else -1)


def _narrow_limit(linear: Linear) -> int:
    """The greatest raw integer of a scale that fits in 64 bits."""
    return ((1 << 62) - (1 << 37) - abs(linear.factor)) // abs(linear.factor)


def _ok(number: int) -> str:
    return f"ok {number:X}"


def number_of(bits: int, precision: int) -> Fraction:
    """The finite number with these bits."""
    code = ("<I", "<f") if precision == SINGLE else ("<Q", "<d")
    return Fraction(struct.unpack(code[1], struct.pack(code[0], bits))[0])


def _is_finite(bits: int, precision: int) -> bool:
    infinity = 0x7F800000 if precision == SINGLE else 0x7FF0000000000000
    return bits & infinity != infinity


def bits_of(value: Fraction, precision: int) -> int:
    """The bits of the nearest number, ties to even."""
    lowest, width = (-149, 32) if precision == SINGLE else (-1074, 64)
    infinity = 0x7F800000 if precision == SINGLE else 0x7FF0000000000000
    sign = 1 << (width - 1) if value < 0 else 0
    size = abs(value)
    if not size:
        return 0
    exponent = max(size.numerator.bit_length() - size.denominator.bit_length() - precision, lowest)
    mantissa, rest, divisor = _scaled(size, exponent)
    if mantissa >= 1 << precision:
        exponent += 1
        mantissa, rest, divisor = _scaled(size, exponent)
    mantissa += 2 * rest > divisor or (2 * rest == divisor and mantissa & 1)
    return sign | min(mantissa + (exponent - lowest << precision - 1), infinity)


def _scaled(size: Fraction, exponent: int) -> tuple[int, int, int]:
    """Quotient and remainder of a number divided by 2^exponent, and the divisor of the remainder."""
    divisor = size.denominator << max(exponent, 0)
    return *divmod(size.numerator << max(-exponent, 0), divisor), divisor


def _cases(count: int, chance: random.Random) -> Iterator[Case]:
    for _ in range(count):
        operation = chance.choice("susunmnmabcd")
        operation = chance.choice((operation, operation.upper()))
        if chance.random() < 0.2:
            yield _narrow(chance)
        elif operation in "nNbBdD" and chance.random() < 0.1:
            yield _beside_tie(operation, chance)
        else:
            linear = _linear(chance)
            yield Case(operation, linear, _operand(operation, linear, chance))


def _narrow(chance: random.Random) -> Case:
    """A case of the functions for scales that fit in 64 bits."""
    factor, divisor = _any(chance, 31) or 1, abs(_any(chance, 31)) or 1
    linear = Linear(factor, chance.choice((0, _any(chance, 37))), divisor, 1, 1)
    raw = Fraction(_any(chance, 62) * 2 + chance.choice((0, 1)), 2)
    raw %= _narrow_limit(linear) + chance.choice((0, 1)) or 1
    if chance.random() < 0.5:
        return Case("v", linear, min(int(raw), _narrow_limit(linear)) * chance.choice((1, -1)))
    value = linear.value(raw * chance.choice((1, -1)))
    bits = chance.choice((bits_of(value, SINGLE), chance.randrange(0x7F800000)))
    beside = max((bits & 0x7FFFFFFF) + chance.choice((-1, 0, 0, 1)), 0) | bits & _sign(SINGLE)
    return Case("w", linear, beside)


def _beside_tie(operation: str, chance: random.Random) -> Case:
    """An offset that is a tie of the result, and a number that is much smaller, which decides."""
    factor = chance.choice((1, -1))
    if operation in "nN":
        linear = Linear(2 * factor, _any(chance, 40) | 1, 1, 1, 1)
    else:
        precision = SINGLE if operation == "B" else DOUBLE
        linear = Linear(factor, (_any(chance, 8) | 1) + (1 << precision), 1, 1, 1)
    bits = chance.randrange(1, 0x30000000 if operation in "ND" else 0x3000000000000000)
    return Case(operation, linear, bits | chance.choice((0, _sign(SINGLE if operation in "ND" else DOUBLE))))


def _linear(chance: random.Random) -> Linear:
    if chance.random() < 0.1:
        return Linear(*(chance.getrandbits(width) | 1 for width in (63, 63, 63, 31, 32)))
    if chance.random() < 0.6:
        scale, offset = Fraction(chance.choice(SCALES)), Fraction(chance.choice(OFFSETS))
        divisor = math.lcm(scale.denominator, offset.denominator)
        factor, addend = int(scale * divisor), int(offset * divisor)
    else:
        factor = _any(chance, 63) or 1
        addend = chance.choice((0, _any(chance, 63)))
        divisor = abs(_any(chance, 63)) or 1
    if chance.random() < 0.7:
        return Linear(factor, addend, divisor, 1, 1)
    return Linear(factor, addend, divisor, abs(_any(chance, 31)) or 1, abs(_any(chance, 32)) or 1)


def _any(chance: random.Random, width: int) -> int:
    """An integer of any length up to `width` bits, with a sign."""
    return chance.choice((1, -1)) * chance.getrandbits(chance.choice((width, chance.randint(1, width))))


def _operand(operation: str, linear: Linear, chance: random.Random) -> int:
    kind = operation.lower()
    if kind == "s":
        return _any(chance, 63)
    if kind == "u":
        return abs(_any(chance, 64))
    precision = SINGLE if operation.isupper() else DOUBLE
    if kind in "ab":
        precision = SINGLE if kind == "a" else DOUBLE
    infinity = 0x7F800000 if precision == SINGLE else 0x7FF0000000000000
    if kind in "abcd" or chance.random() < 0.1:
        bits = chance.randrange(1, infinity)
    else:
        near = chance.choice((0, 0, 0, 1 << 63, 1 << 64)) * chance.choice((1, -1))
        raw = near + Fraction(_any(chance, chance.choice((8, 16, 32, 64))) * 2 + chance.choice((0, 1, 1)), 2)
        bits = bits_of(linear.value(raw), precision)
        bits = max((bits & ~_sign(precision)) + chance.choice((-1, 0, 0, 1)), 0) | bits & _sign(precision)
        if not _is_finite(bits, precision):
            bits = infinity - 1
    return bits | (_sign(precision) if chance.random() < 0.2 and bits else 0)


def _sign(precision: int) -> int:
    return 1 << (31 if precision == SINGLE else 63)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=DEFAULT_COUNT, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(Path(folder), "-O2")
        found = differences(program, given.count, given.seed)
    for line in found[:20]:
        print(line)
    print(f"{given.count} conversions, {len(found)} differ from exact fractions")
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
