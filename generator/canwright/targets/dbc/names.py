"""The names in DBC files, for the target and for programs that look for something of a spec in the files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ...model.layout import Element, Field, bits_of, is_one_run, runs_of
from ...model.message import Direction
from .frames import Part
from .text import camel
from .view import KIND

LETTER = {Direction.REPLY: "r", Direction.REQUEST: "c"}
"""First letter of signal names, so that the names of the two directions differ."""

RAW_UNIT = "raw"
"""Unit of values without a scale, so that raw integers are not mistaken for a quantity."""


def node_name(address: str, node: int | None) -> str:
    """The name of a node: the name of its address and its number; it may be too long."""
    return camel(address) + ("" if node is None else str(node))


def message_endings(part: Part) -> tuple[str, str, str]:
    """What follows the node in the name of a message: with a selector; without, beside the other direction, and alone."""
    kind, command = KIND[part.message.direction], part.command.name
    return "_".join((kind, *part.codes_in_id)), f"{command}_{kind}", command


def prefix(part: Part) -> str:
    """The start of the names of the signals of a message."""
    return f"{LETTER[part.message.direction]}{part.code}"


def reserved_name(part: Part) -> str:
    """The name of the signal of a message without fields."""
    return f"{prefix(part)}_reserved"


def signal_name(part: Part, field: Field, element: Element) -> str:
    """The name of a field, or of an element of an array; it may be too long."""
    name = f"{prefix(part)}_{field.name}"
    return name if element.index is None else f"{name}_{element.index}"


class SignalBits(NamedTuple):
    """A signal of an element: the end of its name, its first bit in the raw integer, and its bits in the data."""

    ending: str
    low: int
    bits: tuple[int, ...]
    flag: str | None = None


def signals_of(field: Field, element: Element) -> Iterator[SignalBits]:
    """The signals of an element: one, or one for each run of bits; of flags, one for each flag and each run between them."""
    type_, is_one = field.type, is_one_run(element.segments, field.type.order)
    if type_.flags and field.is_given:
        named = {flag.value: flag.name for flag in type_.flags}
        bit_of = {s.raw_low + i: s.byte * 8 + s.low + i for s in element.segments for i in range(s.width)}
        for run in adjacent(bit_of, split=named, before=() if is_one else [s.raw_low for s in element.segments]):
            flag = named.get(run[0])
            ending = flag or "_".join(("bits", *map(str, sorted({run[0], run[-1]}))))
            yield SignalBits(f"_{ending}", run[0], tuple(bit_of[i] for i in run), flag)
    elif type_.flags or is_one:
        yield SignalBits("", 0, element.bits)
    else:
        for segments in runs_of(element.segments, type_.order):
            low, bits = segments[0].raw_low, bits_of(segments)
            yield SignalBits(f"_bits_{low}_{low + len(bits) - 1}", low, bits)


def adjacent(numbers: Iterable[int], split: Iterable[int] = (), before: Iterable[int] = ()) -> list[list[int]]:
    """Runs of adjacent numbers; each number in `split` is a run of its own, one in `before` starts a run."""
    runs: list[list[int]] = []
    for n in sorted(numbers):
        if runs and runs[-1][-1] == n - 1 and n not in (*split, *before) and n - 1 not in split:
            runs[-1].append(n)
        else:
            runs.append([n])
    return runs
