"""Compares integer arithmetic and printing of the C runtime with exact fractions: `python -m tests.verification.integers [COUNT]`.

Random and boundary cases of the functions of `canwright.h`, `canwright_exact.h` and `canwright_print.h`: values of integers
and of numbers in floating point under any scale, ties and their neighbours, results beyond 64 bits, wide integers, short
buffers, rejected frames.
"""

from __future__ import annotations

import argparse
import math
import random
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from canwright.model.refusal import Refusal
from canwright.targets.c.package import RUNTIME

from ..compilers import build
from ..float_rule import nearest_integer
from .floating import DEFAULT_COUNT, DOUBLE, SINGLE, Case, any_integer, differences, is_finite, number_of
from .wide import wide_cases

PROGRAM = Path(__file__).with_name("integers.c")
SIZE = 200
"""Size of the buffer of the program; no text is as long."""

LARGEST = (1 << 64) - 1
STATUSES = ("ok", *(refusal.value for refusal in Refusal), "?")
EXTENDED, REMOTE = 1 << 31, 1 << 30


def cases(count: int, chance: random.Random) -> list[Case]:
    """Random cases."""
    kinds = (
        _value,
        _value,
        _value,
        _floating,
        _floating,
        _beside_tie,
        _beside_tie,
        _number,
        _digits,
        _rejected,
        _divided,
        _bounds,
        _share,
        _bits,
    )
    made: list[Case] = []
    while len(made) < count:
        made += [kind(chance) for kind in kinds]
        made += wide_cases(chance)
    return made[:count]


def _printed(operation: str, given: Sequence[int], text: str, chance: random.Random) -> Case:
    """A text in a buffer that is often too small."""
    size = chance.choice((SIZE, SIZE, SIZE, 0, 1, 2, len(text), len(text) + 1, chance.randint(0, 30)))
    return Case(operation, (*(*given, 0, 0, 0, 0, 0, 0)[:7], size), f"{len(text)} {text[: max(size - 1, 0)]}")


def _value(chance: random.Random) -> Case:
    """The value of an integer, often the middle between two texts."""
    raw = any_integer(chance, 64)
    raw = abs(raw) if raw < -(1 << 63) or raw >= 1 << 63 else raw
    return _linear(chance, "s" if -(1 << 63) <= raw < 1 << 63 else "u", raw, Fraction(raw), 9)


def _floating(chance: random.Random) -> Case:
    """The value of a number in floating point, mostly of a magnitude that is not printed as 0 or as too large."""
    width, precision, exponents, bias = chance.choice(((32, SINGLE, 8, 127), (64, DOUBLE, 11, 1023)))
    bits = chance.getrandbits(width)
    if chance.random() < 0.7:
        exponent = max(0, min(bias + chance.randint(-60, 80), (1 << exponents) - 2))
        bits = bits & ~((1 << exponents) - 1 << precision - 1) | exponent << precision - 1
    sign, fraction = bits >> width - 1 << width - 1, (1 << precision - 1) - 1
    if chance.random() < 0.2:
        bits &= -1 << precision - chance.randint(1, 4)
    elif chance.random() < 0.2:  # infinity, NaN, zero and subnormal numbers
        exponent = chance.choice((0, (1 << exponents) - 1))
        bits = sign | exponent << precision - 1 | chance.choice((0, 1, fraction + 1 >> 1, bits & fraction))
    operation = "f" if precision == SINGLE else "d"
    if not is_finite(bits, precision):
        text = "nan" if bits & fraction else f"{'-' if sign else ''}inf"
        return _printed(operation, (bits, 1, 0, 1, 1, 1, 6), text, chance)
    return _linear(chance, operation, bits, number_of(bits, precision), 6)


def _linear(chance: random.Random, operation: str, given: int, raw: Fraction, most: int) -> Case:
    """A value under any scale, as canwright_print_value prints it."""
    factor = chance.choice((1, 1, any_integer(chance, 63) or 1))
    divisor = chance.choice((1, 2, 10, 1000, 2048, abs(any_integer(chance, 63)) or 1))
    addend = chance.choice((0, 0, any_integer(chance, 63), -math.floor(raw * factor + chance.randint(0, 3)) or 0))
    addend = addend if abs(addend) < 1 << 63 else 0
    ratio = chance.choice(((1, 1), (chance.randint(1, (1 << 31) - 1), chance.randint(1, (1 << 32) - 1)), (36, 7)))
    decimals = chance.randint(0, most if addend else 19)
    value = (raw * factor + addend) / divisor * Fraction(*ratio)
    return _printed(operation, (given, factor, addend, divisor, *ratio, decimals), decimal(value, decimals), chance)


def _beside_tie(chance: random.Random) -> Case:
    """The middle between two texts, and a number in floating point that is too small for any text."""
    decimals = chance.randint(0, 6)
    addend, divisor = (2 * chance.getrandbits(20) + 1) * chance.choice((1, -1)), 2 * 10**decimals
    bits = chance.getrandbits(1) << 63 | chance.choice((0, chance.randint(1, 800))) << 52
    bits |= chance.choice((0, 1, chance.getrandbits(52), 1 << chance.randrange(52)))
    value = (number_of(bits, DOUBLE) + addend) / divisor
    return _printed("d", (bits, 1, addend, divisor, 1, 1, decimals), decimal(value, decimals), chance)


def decimal(value: Fraction, decimals: int) -> str:
    """A value with at most some decimals, with fewer where its digits exceed 64 bits."""
    for places in range(decimals, -1, -1):
        digits = nearest_integer(abs(value) * 10**places)
        if digits <= LARGEST:
            whole, rest = divmod(digits, 10**places)
            fraction = f".{rest:0{places}}".rstrip("0") if rest else ""
            return f"{'-' if value < 0 and digits else ''}{whole}{fraction}"
    return f"{'<-' if value < 0 else '>'}{LARGEST}"


def _number(chance: random.Random) -> Case:
    number = any_integer(chance, 63)
    return _printed("i", (number,), str(number), chance)


def _digits(chance: random.Random) -> Case:
    number, digits = chance.choice((0, abs(any_integer(chance, 64)))), chance.randint(1, 9)
    if chance.random() < 0.5:
        return _printed("x", (number, 16, digits), f"{number:0{digits}X}", chance)
    return _printed("x", (number, 10, digits), f"{number:0{digits}}", chance)


def _rejected(chance: random.Random) -> Case:
    """A rejected frame; also one of more than eight data bytes, of which eight are printed."""
    status, dlc, data = chance.randrange(len(STATUSES)), chance.choice((*range(10), 255)), chance.randbytes(8)
    id_ = chance.getrandbits(29) if chance.random() < 0.5 else chance.getrandbits(11)
    flags = chance.choice((0, EXTENDED, REMOTE, EXTENDED | REMOTE))
    rest = " remote" if flags & REMOTE else "".join(f" {byte:02X}" for byte in data[:dlc])
    text = f"{STATUSES[status]}: {id_:0{8 if flags & EXTENDED else 3}X} [{dlc}]{rest}"
    return _printed("r", (status, id_ | flags, dlc, int.from_bytes(data, "little")), text, chance)


def _divided(chance: random.Random) -> Case:
    """Quotients, often beside the middle of two integers; without overflow."""
    operation = chance.choice("QRM")
    width = {"Q": 30, "R": 62, "M": 30}[operation]
    divisor = abs(any_integer(chance, width)) or 1
    dividend = any_integer(chance, width)
    if chance.random() < 0.5:
        steps = chance.getrandbits(max(1, width - divisor.bit_length() - 1))
        dividend = (steps * divisor + divisor // 2 + chance.choice((-1, 0, 1))) * chance.choice((1, -1))
    ratio = (1, 1)
    if operation == "M":
        ratio = (any_integer(chance, 31), chance.randint(1, (1 << 32) - 1))
    exact = Fraction(dividend * ratio[0], divisor * ratio[1])
    return Case(operation, (dividend, *ratio, divisor), str(nearest_integer(exact)))


def _bounds(chance: random.Random) -> Case:
    """Integers beside a bound that depends on a ratio."""
    ratio = (any_integer(chance, 20), chance.randint(1, 1 << chance.randint(1, 16)))
    factor, addend, divisor = any_integer(chance, 30), any_integer(chance, 30), chance.randint(1, 1 << 20)
    exact = (Fraction(*ratio) * factor + addend) / divisor
    operation, bound = chance.choice((("L", math.floor(exact)), ("C", math.ceil(exact))))
    return Case(operation, (factor, *ratio, divisor, addend), str(bound))


def _share(chance: random.Random) -> Case:
    """A value divided by a parameter and a scale, at both limits and beyond them."""
    ratio = (chance.randint(1, 1 << chance.randint(1, 16)), chance.randint(1, 1 << chance.randint(1, 8)))
    divisor, factor, addend = chance.randint(1, 1000), chance.randint(1, 1000), any_integer(chance, 10)
    most = chance.choice((chance.randint(0, 1000), 1 << 20))
    limit = math.floor(Fraction(*ratio) * most)
    share = chance.choice((any_integer(chance, 20), limit, limit + 1, -limit, -limit - 1))
    exact = (Fraction(share) / Fraction(*ratio) * divisor - addend) / factor
    nearest = nearest_integer(exact)
    lowest, highest = chance.choice(((nearest, nearest), (nearest + 1, 1 << 40), (-1 << 40, nearest - 1)))
    accepted = abs(share) <= limit and lowest <= nearest <= highest
    given = (share, *ratio, divisor, addend, most, factor, lowest, highest)
    return Case("H", given, str(nearest) if accepted else "false")


def _bits(chance: random.Random) -> Case:
    """Signed numbers of any width; order and finiteness of numbers in floating point."""
    operation, precision, width = chance.choice(
        (("W", 0, 32), ("X", 0, 64), ("Y", 0, 64), ("O", SINGLE, 32), ("P", DOUBLE, 64))
    )
    if not precision:
        bits = chance.randint(1, 32) if width == 32 else chance.randint(33, 64)
        ends = -(1 << bits - 1), (1 << bits - 1) - 1
        number = chance.choice((chance.randint(*ends), *ends))
        if operation == "Y":
            return Case(operation, (number >> 32 & 0xFFFFFFFF, number & 0xFFFFFFFF), str(number))
        return Case(operation, (number % (1 << bits), bits), str(number))
    infinity = (1 << width - precision) - 1 << precision - 1
    special = (0, infinity, infinity + 1, infinity - 1, 1 << width - 1)
    first, second = (chance.choice((*special, *[chance.getrandbits(width) for _ in special])) for _ in range(2))
    if chance.random() < 0.2:
        second = first + 1 & (1 << width) - 1
    if not is_finite(second, precision):
        second = 0
    is_less = is_finite(first, precision) and _order(first, precision, width) < _order(second, precision, width)
    if not is_finite(first, precision):  # sorts beyond all finite numbers of its sign
        is_less = bool(first >> width - 1)
    return Case(operation, (first, second), str(2 * is_finite(first, precision) + is_less))


def _order(bits: int, precision: int, width: int) -> tuple[Fraction, int]:
    """The number, and whether it is positive: -0.0 sorts below 0.0."""
    return number_of(bits, precision), 1 - (bits >> width - 1)


def compiled(folder: Path, *flags: str) -> Path:
    """The program."""
    return build([PROGRAM], RUNTIME, folder / "integers", *flags)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, nargs="?", default=DEFAULT_COUNT, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        different = differences(compiled(Path(folder), "-O2"), cases(given.count, random.Random(given.seed)))
    for line in different[:20]:
        print(line)
    print(f"{given.count} cases, {len(different)} differ from exact fractions")
    return 1 if different else 0


if __name__ == "__main__":
    raise SystemExit(main())
