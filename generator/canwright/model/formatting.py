"""Numbers, ranges, positions and conditions as text; the same in every output."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple, Protocol

from .layout import Field, Segment, Space
from .message import Command, IdRule, Key
from .metadata import Effect
from .types import Assignment, Bound, ByParameter, Encoding, Linear, Order, Parameter, Range, Type

MAX_DIGITS = 24
"""So many characters of a number are read before it is rounded."""


def exact(number: Fraction) -> str:
    """A decimal of at most fifteen decimal places, else a quotient: `0.01`, `1/3`."""
    if number.denominator == 1:
        return str(number.numerator)
    scaled, rest = divmod(abs(number.numerator) * 10**15, number.denominator)
    if rest:
        return f"{number.numerator}/{number.denominator}"
    digits = f"{scaled:016d}"
    sign = "-" if number.numerator < 0 else ""
    return f"{sign}{digits[:-15]}.{digits[-15:]}".rstrip("0")


def decimal(number: Fraction) -> str:
    """A decimal; one of at most six significant digits after `≈` where that is rounded: `0.01`, `≈0.333333`."""
    written = exact(number)
    return written if "/" not in written and len(written) <= MAX_DIGITS else f"≈{float(number):.6g}"


def counted(count: int, noun: str) -> str:
    """`1 frame`, `2 frames`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def spoken(name: str) -> str:
    """The title of an item without one, from its name: `read_level` is `Read level`."""
    return name.replace("_", " ").capitalize()


def multiple(number: str, parameter: str | None) -> str:
    """A number as a factor of a parameter: `2/65535*size`, `-size`; without a parameter the number itself."""
    if parameter is None:
        return number
    return {"1": parameter, "-1": f"-{parameter}"}.get(number, f"{number}*{parameter}")


def bound(end: Bound, written: Callable[[Fraction], str] = exact) -> str:
    """A bound of a range: `2048` or `100*size-1`."""
    if end.parameter is None:
        return written(end.constant)
    tail = f"{'+' if end.constant > 0 else '-'}{written(abs(end.constant))}" if end.constant else ""
    return multiple(written(end.coefficient), end.parameter) + tail


def step(linear: Linear) -> str:
    """The resolution (1 LSB) without its unit, as written in the spec: `33/2048`."""
    return multiple(linear.printed or exact(linear.scale), linear.times)


def parameter_value(value: str | Fraction) -> str:
    """The value of a parameter: the name of a choice, or an exact number."""
    return exact(value) if isinstance(value, Fraction) else value


def parameter_values(assignment: Assignment) -> dict[str, str]:
    """The values of parameters by name, as text."""
    return {name: parameter_value(value) for name, value in assignment.items()}


def offset(linear: Linear, written: Callable[[Fraction], str] = exact) -> str:
    """The value of raw 0, without its unit."""
    return multiple(written(linear.offset), linear.times if linear.offset else None)


def span(limits: Range, written: Callable[[Fraction], str] = exact) -> str:
    """`-2048..2048`."""
    return f"{bound(limits.low, written)}..{bound(limits.high, written)}"


def in_unit(limits: Range, linear: Linear) -> Range:
    """The range of the values of a range of raw integers."""

    def value(end: Bound) -> Bound:
        worth = end.constant * linear.scale + linear.offset
        if linear.times is not None and worth:
            return Bound(Fraction(0), worth, linear.times)
        return Bound(worth, end.coefficient * linear.scale, end.parameter)

    low, high = value(limits.low), value(limits.high)
    return Range(low, high) if linear.scale > 0 else Range(high, low)


def allowed(parameter: Parameter) -> str:
    """The allowed values of a number parameter: `1..9`, `1 or more`, `9 or less`; empty for any."""
    low, high = parameter.minimum, parameter.maximum
    if low is not None and high is not None:
        return f"{exact(low)}..{exact(high)}"
    return f"{exact(low)} or more" if low is not None else f"{exact(high)} or less" if high is not None else ""


_LETTERS = {Encoding.UNSIGNED: "u", Encoding.SIGNED: "i", Encoding.FLOAT: "f"}


class PlaceWords(NamedTuple):
    """The words of positions and raw formats."""

    id: str = "id"
    bit: str = "bit"
    bits: str = "bits"
    big_endian: str = "big-endian"


ENGLISH = PlaceWords()


class Place(NamedTuple):
    """Where the bits of a key or of an element of a field are; a key has no name."""

    position: str
    name: str
    raw: str


def key_place(key: Key, words: PlaceWords = ENGLISH) -> Place:
    """The place of a key."""
    order = f" {words.big_endian}" if key.order is Order.BIG and len(key.segments) > 1 else ""
    return Place(place(key.space, key.segments, words), "", f"u{key.width}{order}")


def field_places(field: Field, words: PlaceWords = ENGLISH) -> list[Place]:
    """The places of a field: one, or that of each element of an array."""
    return [
        Place(place(field.space, segments, words), name, raw_format(field.type, segments, words))
        for name, segments in elements(field)
    ]


def raw_format(type_: Type, segments: tuple[Segment, ...] = (), words: PlaceWords = ENGLISH) -> str:
    """`i16`, or `i16 big-endian` if it spans several bytes in that order."""
    spans = len(segments) > 1 or type_.width > 8
    order = f" {words.big_endian}" if type_.order is Order.BIG and spans else ""
    return f"{_LETTERS[type_.encoding]}{type_.width}{order}"


def place(space: Space, segments: tuple[Segment, ...], words: PlaceWords = ENGLISH) -> str:
    """The position of bits: `DATA[4..5]`, `DATA[3] bits 0..3`, `id bits 5..10`."""
    if space is Space.ID:
        return f"{words.id} {_bits(segments[0].low, segments[0].width, words)}"
    ordered = sorted(segments, key=lambda s: s.byte)
    if all(s.width == 8 for s in ordered):
        first, last = ordered[0].byte, ordered[-1].byte
        return f"DATA[{first}]" if first == last else f"DATA[{first}..{last}]"
    return ", ".join(f"DATA[{s.byte}]" + ("" if s.width == 8 else f" {_bits(s.low, s.width, words)}") for s in ordered)


def _bits(low: int, width: int, words: PlaceWords) -> str:
    return f"{words.bit} {low}" if width == 1 else f"{words.bits} {low}..{low + width - 1}"


def scale(type_: Type, among: tuple[str, ...] = (), offset_word: str = ", offset ") -> Sequence[tuple[str, str]]:
    """Resolutions (1 LSB): (parameter values, `25/65535 rad, offset -12.5 rad`); the former are empty if it is constant.

    If `among` contains values of that parameter, the others are left out. `offset_word` precedes an offset.
    """
    cases = (type_.linear.constant, *type_.linear.cases.values())
    return _scale(type_, among, offset_word, tuple(linear.printed for linear in cases if linear is not None))


@functools.lru_cache(maxsize=1 << 12)
def _scale(
    type_: Type, among: tuple[str, ...], offset_word: str, printed: tuple[str, ...]
) -> Sequence[tuple[str, str]]:
    """Cached by `printed` too: types that differ only in the notation of their scales are equal."""
    unit = f" {type_.unit.symbol}" if type_.unit else ""

    def worth(linear: Linear | None) -> str:
        if linear is None:
            return "not given"
        added = f"{offset_word}{offset(linear)}{unit}" if linear.offset else ""
        return f"{step(linear)}{unit}{added}"

    kept = [(_among(names, among), linear) for names, linear in type_.linear.distinct()]
    return [(", ".join(names), worth(linear)) for names, linear in kept if names is not None]


def _among(names: Sequence[str], among: Sequence[str]) -> Sequence[str] | None:
    """The names that are in `among`; None if all of them are left out."""
    if not names or not among:
        return names
    return [name for name in names if name in among] or None


@functools.lru_cache(maxsize=1 << 12)
def ranges(type_: Type) -> Sequence[tuple[str, str]]:
    """Allowed raw integers: (parameter values, `-2048..2048`)."""
    limits_of: ByParameter[Range] = type_.raw_range
    return [(", ".join(names), span(limits)) for names, limits in limits_of.distinct() if limits is not None]


class Sent(Protocol):
    """A frame on the bus."""

    @property
    def id(self) -> int: ...
    @property
    def extended(self) -> bool: ...
    @property
    def remote(self) -> bool: ...
    @property
    def data(self) -> bytes: ...


def sent(frame: Sent) -> str:
    """A frame in the notation of can-utils: `12B#0102`, `0000012B#0102` with a 29-bit id, `12B#R` for a remote one."""
    digits = 8 if frame.extended else 3
    return f"{frame.id:0{digits}X}#{'R' if frame.remote else frame.data.hex().upper()}"


def bus_id(id_: int, extended: bool, remote: bool) -> str:
    """The id of a recorded frame: `0x141`, `0x00000141` with 29 bits, `0x141 remote`."""
    return f"0x{id_:0{8 if extended else 1}X}{' remote' if remote else ''}"


def numbers(listed: Iterable[int]) -> str:
    """Ascending numbers, of which consecutive ones are a range: `1..3, 7`."""
    runs: list[list[int]] = []
    for number in listed:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}..{run[-1]}" for run in runs)


def condition(only: Mapping[str, tuple[str, ...]]) -> str:
    """A condition on parameters: `model A, B`; empty without one."""
    return "; ".join(f"{name} {', '.join(values)}" for name, values in only.items())


def exemptions(command: Command, effect: Effect) -> str:
    """The values of the request with which a command does not have an effect: `action = read`; empty without any."""
    return ", ".join(f"{field.name} = {member.name}" for field, member in command.exemptions(effect))


def effect(title: str, command: Command, effect: Effect) -> str:
    """The English title of an effect of a command, with the values without it."""
    values = exemptions(command, effect)
    return f"{title} (not with {values})" if values else title


def elements(field: Field) -> list[tuple[str, tuple[Segment, ...]]]:
    """The elements of a field, each with its name and bits: `level`, or `level[1]`, `level[2]`, … for an array."""
    return [(field.name if e.index is None else f"{field.name}[{e.index}]", e.segments) for e in field.elements]


def id_rule(rule: IdRule) -> str:
    """An id rule: `0x100 + node`, `0x1 + (node << 5)`, `node * 10`, or a fixed id."""
    if rule.nodes is None:
        return f"0x{rule.base:X}"
    node, step = "node", rule.node_step
    if step > 1:
        shift = f"node << {step.bit_length() - 1}"
        node = f"node * {step}" if step.bit_count() > 1 else f"({shift})" if rule.base else shift
    return f"0x{rule.base:X} + {node}" if rule.base else node
