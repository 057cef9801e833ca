"""Cases for the wide integers of the C runtime, and for its functions of frames, answered by `integers.c`."""

from __future__ import annotations

import random
from collections.abc import Iterator

from .floating import Case, any_integer

WIDTH = 256
ALL_RULES = (1 << WIDTH) - 1


def wide_cases(chance: random.Random) -> list[Case]:
    """One case of every function."""
    return [*_sums(chance), _divided(chance), *_shifted(chance), *_terms(chance), _frames(chance)]


def _number(chance: random.Random, width: int = WIDTH) -> int:
    """A number of any length, often with runs of equal bits."""
    number = abs(any_integer(chance, width))
    if chance.random() < 0.5:
        run = (1 << chance.randint(1, width)) - 1 << chance.randrange(width)
        number = number | run if chance.random() < 0.5 else number & ~run
    return number & (1 << width) - 1


def _words(number: int) -> tuple[int, ...]:
    return tuple(number >> 64 * i & (1 << 64) - 1 for i in range(4))


def _shown(size: int, exponent: int = 0, negative: bool = True) -> str:
    return f"{size:064X} {exponent} {int(negative)}"


def _sums(chance: random.Random) -> Iterator[Case]:
    first, second = _number(chance), _number(chance)
    if chance.random() < 0.5:
        second = first ^ 1 << chance.randrange(WIDTH) if chance.random() < 0.7 else first
    given = (*_words(first), *_words(second))
    yield Case("A", given, _shown(first + second & ALL_RULES))
    yield Case("B", given, _shown(first - second & ALL_RULES))
    yield Case("E", given, str(int(first < second)))
    yield Case("G", given, str(first.bit_length()))
    factor = _number(chance, 64)
    yield Case("K", (*_words(first), factor), _shown(first * factor & ALL_RULES))


def _divided(chance: random.Random) -> Case:
    """A quotient, also of a shifted dividend or divisor; often beside 64 bits and beside a divisor of 32 bits."""
    below = _number(chance, chance.choice((33, 95))) or 1
    whole = chance.choice((_number(chance, 64), _number(chance, 66), (1 << 64) - chance.choice((0, 1))))
    above = whole * below + chance.choice((0, below - 1, chance.randrange(below)))
    count = chance.randint(-60, 90)
    if count >= 0:
        above >>= count
    whole, rest = divmod(above << max(count, 0), below << max(-count, 0))
    given = (*_words(above), *_words(below), count)
    return Case("D", given, f"{whole:X} {_shown(rest)}" if whole < 1 << 64 else "false")


def _shifted(chance: random.Random) -> Iterator[Case]:
    number, count = _number(chance), chance.choice((chance.randrange(WIDTH), 32 * chance.randrange(9)))
    if chance.random() < 0.5:
        number = number >> count << count & ALL_RULES
    right = number >> count | bool(number & (1 << count) - 1)
    left = number << count & ALL_RULES
    yield Case("I", (*_words(number), 0, 0, 0, 0, count), _shown(left))
    yield Case("J", (*_words(number), 0, 0, 0, 0, count), _shown(right))
    yield Case("T", (*_words(number), 0, 0, 0, 0, 100, 100 + count), _shown(left, 100))
    yield Case("T", (*_words(number), 0, 0, 0, 0, 100, 100 - count), _shown(right, 100))


def _terms(chance: random.Random) -> Iterator[Case]:
    """The parts of numbers in floating point: zero, subnormal and normal ones."""
    for operation, precision, bias, last in (("U", 23, 150, 254), ("V", 52, 1075, 2046)):
        sign, exponent = chance.getrandbits(1), chance.choice((0, 1, chance.randint(0, last)))
        fraction = chance.choice((0, chance.getrandbits(precision)))
        bits = sign << (31 if precision == 23 else 63) | exponent << precision | fraction
        size = fraction | (1 << precision if exponent else 0)
        yield Case(operation, (0, 0, 0, 0, bits), _shown(size, max(exponent, 1) - bias, bool(sign)))


def _frames(chance: random.Random) -> Case:
    """Two frames, often with one byte of difference; a filter, often with one bit of difference."""
    data, dlc = chance.getrandbits(64), chance.choice((*range(9), 255))
    id_, mask = chance.getrandbits(32), chance.getrandbits(32)
    other_data = data ^ chance.choice((0, 1 << chance.randrange(64)))
    other_dlc = chance.choice((dlc, dlc, dlc, chance.randrange(9)))
    wanted = id_ ^ chance.choice((0, 1 << chance.randrange(32)))
    used = (1 << 8 * min(dlc, 8)) - 1
    same = dlc == other_dlc and data & used == other_data & used
    accepted = id_ & mask == wanted & mask
    return Case("F", (data, other_data, dlc, other_dlc, id_, wanted, mask), f"{int(same)} {int(accepted)} 0 0")
