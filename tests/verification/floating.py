"""Compares functions of `canwright_float.h` with exact fractions: `python -m tests.verification.floating [COUNT]`.

Random and boundary cases: quotients of 64-bit integers, raw integers of 52 to 64 bits, ties and their neighbours,
subnormal and huge numbers.
"""

from __future__ import annotations

import argparse
import math
import random
import struct
import subprocess
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from canwright.model.types import Linear
from canwright.targets.c.package import RUNTIME

from ..compilers import build
from ..float_rule import nearest_integer, quotient, raw_of_double

PROGRAM = Path(__file__).with_name("floating.c")
SINGLE, DOUBLE = 24, 53
DEFAULT_COUNT = 1_000_000
SCALES = ("1", "1/10", "1/100", "1/1000", "33/2048", "33/4096", "2/125", "-3/10", "7/3", "-1/2", "360/65536", "0.0001")
OFFSETS = ("0", "0", "0", "5", "-40", "-1/7", "100.5", "-273.15")


class Case(NamedTuple):
    """One call of the program, and its answer according to fractions."""

    operation: str
    given: tuple[int, ...]
    expected: str

    def line(self) -> str:
        return f"{self.operation} {' '.join(str(number % (1 << 64)) for number in self.given)}\n"


def differences(program: Path, cases: Sequence[Case]) -> list[str]:
    """The cases in which the program and the fractions differ."""
    lines = "".join(case.line() for case in cases)
    done = subprocess.run([program], input=lines, capture_output=True, text=True, check=True)
    answers = done.stdout.splitlines()
    assert len(answers) == len(cases)
    return [f"{case}: {answer}" for case, answer in zip(cases, answers, strict=True) if answer != case.expected]


def compiled(folder: Path, *flags: str) -> Path:
    """The program."""
    return build([PROGRAM], RUNTIME, folder / "floating", *flags)


def _ok(number: int) -> str:
    return f"ok {number:X}"


def number_of(bits: int, precision: int) -> Fraction:
    """The finite number with these bits."""
    code = ("<I", "<f") if precision == SINGLE else ("<Q", "<d")
    return Fraction(struct.unpack(code[1], struct.pack(code[0], bits))[0])


def is_finite(bits: int, precision: int) -> bool:
    """Whether these are the bits of a finite number."""
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


def cases(count: int, chance: random.Random) -> list[Case]:
    """Random cases."""
    kinds = (
        _quotient,
        _corrected,
        _corrected,
        _beside_offset,
        _resolved,
        _beside_limit,
        _beside_coarse,
        _narrowed,
        _bits,
        _nearest,
        _nearest,
        _of_ratio,
    )
    return [chance.choice(kinds)(chance) for _ in range(count)]


def _quotient(chance: random.Random) -> Case:
    """A raw integer as a double: a quotient of integers, also beside the middle of two doubles."""
    signed = chance.random() < 0.5
    divisor = chance.choice((1, 10, 100, 1000, 2048, abs(any_integer(chance, 63)) or 1))
    middle = chance.getrandbits(54) * divisor << chance.randint(0, 10)
    size = chance.choice((0, abs(any_integer(chance, 64)), chance.getrandbits(54), middle + chance.choice((-1, 0, 1))))
    dividend = size % (1 << 64 - signed)
    dividend *= chance.choice((1, -1)) if signed else 1
    if signed and chance.random() < 0.02:
        dividend = -(1 << 63)  # no int64_t has its magnitude
    return Case("s" if signed else "u", (dividend, divisor), _ok(bits_of(Fraction(dividend, divisor), DOUBLE)))


def _corrected(chance: random.Random) -> Case:
    """A value whose raw integer has 52 to 65 bits, also beside the middle of two raw integers and beside 2^63, 2^64."""
    scale, offset = Fraction(chance.choice(SCALES)), Fraction(chance.choice(OFFSETS))
    if chance.random() < 0.5:
        scale = Fraction(any_integer(chance, 45) or 1, abs(any_integer(chance, 45)) or 1)
        offset = Fraction(0)
    near = chance.choice((0, 0, 1 << 51, 1 << 63, 1 << 64, 11 << 61))
    size = near + any_integer(chance, 12) if near else chance.getrandbits(chance.randint(52, 65))
    raw = (size + Fraction(chance.choice((0, 1)), 2)) * chance.choice((1, -1))
    value = float(raw * scale + offset)
    for _ in range(chance.choice((0, 1, 2))):
        value = math.nextafter(value, chance.choice((math.inf, -math.inf)))
    return _corrected_value(chance, value, Linear(scale, offset))


def _beside_offset(chance: random.Random) -> Case:
    """A value that is so small that its raw number is next to that of the offset, of 52 to 64 bits and a fraction."""
    scale = Fraction(any_integer(chance, 45) or 1, abs(any_integer(chance, 45)) or 1)
    raw = Fraction(chance.getrandbits(chance.randint(52, 63)) * chance.choice((1, -1)))
    raw += Fraction(chance.randrange(abs(scale.numerator)), scale.numerator)
    exponent = chance.choice((chance.randrange(1023), chance.randint(950, 1022)))  # a shift by 64 bits is at most 1010
    value = _double(chance.getrandbits(1) << 63 | exponent << 52 | chance.getrandbits(52))
    steps = Fraction(value) / scale + raw
    if abs(steps) > 1 << 63 or abs(steps % 1 - Fraction(1, 2)) < Fraction(scale.denominator, 1 << 45):
        value = 0.0  # so close to a tie that the last bits of the value decide
    return _corrected_value(chance, value, Linear(scale, -raw * scale))


def _resolved(chance: random.Random) -> Case:
    """A value whose last bit decides, as the sum with the offset is beside the middle of two raw integers."""
    scale = Fraction(abs(any_integer(chance, 45)) or 1, abs(any_integer(chance, 45)) or 1)
    last = Fraction(1, 1 << max(1, 48 - scale.numerator.bit_length()))  # 2^-47, relative to one raw integer
    value = last * any_integer(chance, 53)
    raw = chance.getrandbits(chance.randint(52, 62)) + Fraction(1, 2)
    addend = math.floor((value - raw * scale) * scale.denominator) + chance.choice((-1, 0, 1))
    return _corrected_value(chance, float(value), Linear(scale, Fraction(addend, scale.denominator)))


def _beside_limit(chance: random.Random) -> Case:
    """A value that is added to an offset of about 2^64 raw integers, so that the sum is beside 2^64."""
    scale = Fraction(any_integer(chance, 45) or 1, abs(any_integer(chance, 45)) or 1)
    raw = (1 << 64) - chance.getrandbits(16)
    return _corrected_value(chance, float(chance.getrandbits(18) * scale), Linear(scale, -raw * scale))


def _beside_coarse(chance: random.Random) -> Case:
    """A value whose quotient in floating point is 2^51 or next to it, after three rounded operations."""
    scale = Fraction(any_integer(chance, 45) or 1, abs(any_integer(chance, 45)) or 1)
    raw = any_integer(chance, 55)
    value = float(((1 << 51) + raw) * scale)
    for _ in range(chance.randrange(4)):
        value = math.nextafter(value, math.inf if scale > 0 else -math.inf)
    return _corrected_value(chance, value, Linear(scale, raw * scale))


def _corrected_value(chance: random.Random, value: float, linear: Linear) -> Case:
    signed = chance.random() < 0.5
    nearest = raw_of_double(value, linear)
    low, high = (-(1 << 63), (1 << 63) - 1) if signed else (0, (1 << 64) - 1)
    factor, addend, divisor = linear.as_quotient
    sign = 1 if factor > 0 else -1
    if low <= nearest <= high:
        low, high = chance.choice(((low, high), (nearest, nearest), (low, nearest), (nearest, high)))
        low = low + (nearest == low) * chance.choice((0, 0, 1)) * (low < high)
        high = high - (nearest == high) * chance.choice((0, 0, 1)) * (low < high)
    return Case(
        "n" if signed else "m",
        (_of(value), _of(quotient(value, linear)), sign * divisor, sign * addend, abs(factor), low, high),
        _ok(nearest % (1 << 64)) if low <= nearest <= high else "out_of_range 0",
    )


def _narrowed(chance: random.Random) -> Case:
    """A double as a float, also beside the middle of two floats, subnormal and too large ones."""
    exponent = chance.choice((chance.randint(1023 - 152, 1023 + 129), chance.randint(1023 - 151, 1023 - 125)))
    zeros = 29 + max(0, 1023 - 126 - exponent)  # the bits that leave the fraction
    middle = chance.getrandbits(64) >> zeros << zeros | 1 << zeros - 1
    beside = chance.choice((1, 1 << chance.randrange(zeros))) if zeros < 64 else 0
    bits = chance.choice((chance.getrandbits(64), middle, middle + beside, middle - 1)) % (1 << 64)
    if chance.random() < 0.9:
        bits = bits & ~(0x7FF << 52) | exponent << 52
    if chance.random() < 0.05:
        bits = bits >> 63 << 63 | 0x7FF << 52 | chance.choice((0, 1, 1 << 51, bits & 0xFFFFFFFFFFFFF))
    if not is_finite(bits, DOUBLE):
        return Case("f", (bits,), _ok(bits >> 63 << 31 | 0x7F800000 | (0x400000 if bits & 0xFFFFFFFFFFFFF else 0)))
    return Case("f", (bits,), _ok(bits_of(number_of(bits, DOUBLE), SINGLE) | bits >> 63 << 31))


def _bits(chance: random.Random) -> Case:
    """The bits of a number of the same format, or of the other one; also infinity, NaN, zero and subnormal numbers."""
    operation, given, result = chance.choice(
        (("J", SINGLE, DOUBLE), ("K", SINGLE, SINGLE), ("D", DOUBLE, DOUBLE), ("E", DOUBLE, SINGLE))
    )
    value, steps = (_any_bits(chance, given) for _ in range(2))
    if not is_finite(value, given):
        return Case(operation, (value, steps), "not_finite 0")
    infinity, width = (0x7F800000, 32) if result == SINGLE else (0x7FF << 52, 64)
    sign = steps >> (31 if given == SINGLE else 63) << width - 1
    bits = bits_of(number_of(steps, given), result) | sign if is_finite(steps, given) else infinity
    return Case(operation, (value, steps), _ok(bits) if bits & infinity != infinity else "out_of_range 0")


def _any_bits(chance: random.Random, precision: int) -> int:
    """Bits of a number; often special ones, and those beside the limits of a float."""
    width, fraction = (32, 23) if precision == SINGLE else (64, 52)
    exponents = [0, 1, (1 << width - 1 - fraction) - 1, chance.getrandbits(width - 1 - fraction)]
    if precision == DOUBLE:
        exponents += [*(chance.randint(1023 - 152, 1023 + 129) for _ in range(4)), 1023 + 127]
    ends = (0, 1, (1 << fraction) - 1, (1 << fraction) - (1 << 28 if precision == DOUBLE else 2))
    mantissa = chance.choice((*ends, *[chance.getrandbits(fraction) for _ in ends]))
    return chance.getrandbits(1) << width - 1 | chance.choice(exponents) << fraction | mantissa


def _nearest(chance: random.Random) -> Case:
    """The integer nearest to a number of steps: ties and their neighbours, limits, NaN and infinity."""
    kinds = {"A": (DOUBLE, 32, 1), "B": (DOUBLE, 64, 1), "C": (DOUBLE, 64, 0)}
    kinds |= {"G": (SINGLE, 32, 1), "H": (SINGLE, 64, 1), "I": (SINGLE, 64, 0)}
    operation = chance.choice([*kinds])
    precision, width, is_signed = kinds[operation]
    least, most = (-1 << width - 1, (1 << width - 1) - 1) if is_signed else (0, (1 << width) - 1)
    near = chance.choice((0, least, most, most + 1, any_integer(chance, width)))
    exact = near + chance.choice(
        (Fraction(chance.randint(-3, 3), chance.choice((1, 3))), Fraction(-1, 2), Fraction(1, 2))
    )
    steps = bits_of(exact, precision) + (chance.choice((-1, 0, 0, 1)) if exact else 0)
    value = chance.choice((0, 0, 0, _any_bits(chance, precision)))
    if not is_finite(value, precision):
        return Case(operation, (value, steps, least, most), "not_finite 0")
    if chance.random() < 0.05:
        steps = 0x7FC00000 if precision == SINGLE else 0x7FF8 << 48
        return Case(operation, (value, steps, least, most), "out_of_range 0")
    nearest = nearest_integer(number_of(steps, precision))
    low, high = least, most
    if least <= nearest <= most:
        low, high = chance.choice(((least, most), (nearest, nearest), (nearest + 1, most), (least, nearest - 1)))
    if not least <= low <= high <= most:
        low, high = least, most
    is_valid = low <= nearest <= high
    return Case(operation, (value, steps, low, high), _ok(nearest % (1 << 64)) if is_valid else "out_of_range 0")


def _of_ratio(chance: random.Random) -> Case:
    """A number multiplied or divided by a ratio: each operation is rounded."""
    operation, precision = chance.choice((("M", DOUBLE), ("N", DOUBLE), ("O", SINGLE), ("P", SINGLE)))

    def rounded(number: Fraction | int) -> Fraction:
        return number_of(bits_of(Fraction(number), precision), precision)

    numerator, denominator = chance.randint(1, (1 << 31) - 1), chance.randint(1, (1 << 32) - 1)
    first, second = (rounded(Fraction(any_integer(chance, 40) or 1, 1024)) for _ in range(2))
    if operation in "MO":
        result = rounded(first * rounded(numerator)) / rounded(second * rounded(denominator))
    else:
        result = rounded(first * rounded(denominator)) / rounded(numerator)
    given = (bits_of(first, precision), bits_of(second, precision), numerator, denominator)
    return Case(operation, given, _ok(bits_of(result, precision)))


def _double(bits: int) -> float:
    number: float = struct.unpack("<d", struct.pack("<Q", bits))[0]
    return number


def _of(number: float) -> int:
    bits: int = struct.unpack("<Q", struct.pack("<d", number))[0]
    return bits


def any_integer(chance: random.Random, width: int) -> int:
    """An integer of any length up to `width` bits, with a sign."""
    return chance.choice((1, -1)) * chance.getrandbits(chance.choice((width, chance.randint(1, width))))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=DEFAULT_COUNT, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(Path(folder), "-O2")
        different = differences(program, cases(given.count, random.Random(given.seed)))
    for line in different[:20]:
        print(line)
    print(f"{given.count} conversions, {len(different)} differ from exact fractions")
    return 1 if different else 0


if __name__ == "__main__":
    raise SystemExit(main())
