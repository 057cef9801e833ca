"""The signals of a frame: its selector, and the fields of every message under it."""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ... import words
from ...model import IDENTITY, Direction, Element, Encoding, Field, Key, Level, Linear, Order, Space, Type
from .frames import Part, Scope
from .selectors import bits, joined_span, joined_value, runs, selector_bits
from .text import fitting, in_ascii, number
from .view import Signal

RAW_UNIT = "raw"
"""Stands for the unit where there is no scale, so that counts are not taken for a quantity."""

LETTER = {Direction.REPLY: "r", Direction.REQUEST: "c"}
"""What the names of signals start with, so that those of the two directions differ."""

_FLOAT_KINDS = {32: 1, 64: 2}
_Numbers = tuple[str, str, str, str]
"""Factor, offset, and the least and the greatest value."""


class _Place(NamedTuple):
    """A signal's name, the selector value it stands under, and its bits from the least significant up."""

    name: str
    mux: str
    bits: tuple[int, ...]
    order: Order = Order.LITTLE

    @property
    def start(self) -> int:
        return self.bits[-1] if self.order is Order.BIG else self.bits[0]


class Signals:
    """Makes the signals of one frame, under names that are unique in it."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._letter = LETTER[scope.direction]
        self._taken: set[str] = set()

    def of(self, parts: Sequence[Part]) -> tuple[Signal, ...]:
        """All signals of a frame; the first selector tells the messages apart."""
        if not parts[0].selectors:
            return tuple(signal for part in parts for signal in self._message(part, ""))
        by_value: dict[int, list[Part]] = {}
        for part in parts:
            by_value.setdefault(part.selectors[0][1], []).append(part)
        names = _names({value: under[0] for value, under in by_value.items() if len(under[0].selectors) == 1})
        key = parts[0].selectors[0][0]
        signals = [self._selector(f"{self._letter}_{key.name}", "M", key, names, "Tells which command it is.")]
        for value, under in by_value.items():
            if len(under[0].selectors) == 1:
                signals += self._message(under[0], f"m{value}")
            else:
                signals += self._undecided(under, f"m{value}")
        return tuple(signals)

    def joined(self, parts: Sequence[Part], span: range) -> tuple[Signal, ...]:
        """All signals of a frame; its selectors are the bits of `span`, read as one number."""
        by_value = {joined_value(part, span): part for part in parts}
        name = "_".join((self._letter, *(key.name for key, _ in parts[0].selectors)))
        signals = [
            self._integer(_Place(name, "M", tuple(span)), "All selectors, read as one number.", values=_names(by_value))
        ]
        for value, part in by_value.items():
            signals += self._message(part, f"m{value}", span)
        return tuple(signals)

    def _selector(self, name: str, mux: str, key: Key, names: Iterable[tuple[int, str]], comment: str) -> Signal:
        return self._integer(_Place(name, mux, bits(key), key.order), comment, values=names)

    def _undecided(self, parts: Sequence[Part], mux: str) -> Iterator[Signal]:
        """Messages that a second selector tells apart: that selector, and the bits it decides about as they are."""
        code, *_ = parts[0].code.split("_")
        shared = parts[0].selectors[: min(len(part.selectors) for part in parts)]
        for i, (key, _) in enumerate(shared[1:], start=1):
            named = [(part.selectors[i][1], part.command.name) for part in parts]
            values = [value for value, _ in named]
            names = [(value, command) for value, command in named if values.count(value) == 1]
            name = f"{self._letter}{code}_{key.name}"
            yield self._selector(name, mux, key, names, "Tells what the other bits mean.")
        free = set(range(max(part.message.dlc for part in parts) * 8)) - {b for key, _ in shared for b in bits(key)}
        elsewhere = "; another file has them as fields" if all(map(joined_span, parts)) else ""
        for run in runs(free):
            place = _Place(f"{self._letter}{code}_data", mux, run)
            yield self._integer(place, f"Bits whose meaning the other selector tells{elsewhere}.")

    def _message(self, part: Part, mux: str, taken: Collection[int] = ()) -> list[Signal]:
        """The fields of a message that are not `taken`; where there is none, the reserved bits, for readers' sake."""
        layout = part.message.layout
        variant = layout.variant(self._scope.assignment)
        fields = variant.fields if variant else tuple(f for f in layout.fields if not f.only)
        places = [(f, e) for f in fields if f.space is Space.DATA for e in f.elements if e.bits[0] not in taken]
        prefix, title = f"{self._letter}{part.code}", in_ascii(part.command.title)
        signals: list[Signal] = []
        for field, element in places:
            about = "" if signals else _about(part)
            signals += self._field(f"{prefix}_{field.name}", mux, title, field, element, about)
        if signals:
            return signals
        free = runs(set(range(part.message.dlc * 8)) - selector_bits(part) - set(taken))
        if free:
            place = _Place(f"{prefix}_reserved", mux, max(free, key=len))
            comment = f"{title}: reserved, sent as 0.{_about(part)}"
            signals.append(self._integer(place, comment, documented=(0, 0)))
        return signals

    def _field(self, name: str, mux: str, title: str, field: Field, element: Element, about: str) -> Iterator[Signal]:
        type_ = field.type
        index = "" if element.index is None else str(element.index)
        place = _Place(f"{name}_{index}" if index else name, mux, element.bits, type_.order)
        which = f"{in_ascii(field.title)} {index}".strip()
        whole = (
            title
            if title.lower() == which.lower() or title.lower().endswith(f": {which}".lower())
            else f"{title}: {which}"
        )
        comment = f"{whole}.{_sentence(in_ascii(field.about) or in_ascii(type_.about))}{self._open(type_)}{about}"
        if field.constant is not None:
            always = f"{comment} Always {field.constant}." if field.checked else f"{comment} Sent as {field.constant}."
            yield self._integer(place, always, type_, documented=(field.constant,) * 2, start=field.constant)
        elif type_.flags:
            yield from self._flags(place, comment, type_)
        elif type_.enum:
            values = sorted((member.value, member.name) for member in type_.enum)
            yield self._integer(place, comment, type_, documented=(values[0][0], values[-1][0]), values=values)
        elif type_.encoding is Encoding.FLOAT:
            yield self._float(place, comment, type_)
        else:
            yield self._integer(place, comment, type_, documented=self._documented(type_))

    def _flags(self, place: _Place, comment: str, type_: Type) -> Iterator[Signal]:
        """One signal for each flag, and one for each run of bits without a name, so that none is lost."""
        named = {flag.value: flag for flag in type_.flags}
        for run in runs(range(type_.width), split=named):
            raw_bits = tuple(place.bits[i] for i in run)
            flag = named.get(run[0])
            if flag:
                one = _Place(f"{place.name}_{flag.name}", place.mux, raw_bits)
                yield self._integer(one, f"{comment} {in_ascii(flag.title)}.")
            else:
                name = "_".join((place.name, "bits", *(str(i) for i in sorted({run[0], run[-1]}))))
                unnamed = _Place(name, place.mux, raw_bits, place.order)
                yield self._integer(unnamed, f"{comment} Bits without a name.", documented=(0, 0))

    def _documented(self, type_: Type) -> tuple[int, int]:
        """The raw integers that the spec allows, as far as the parameters that are set tell."""
        low, high = type_.raw_limits
        first, last = self._range(type_)
        return (
            low if first is None else max(low, math.ceil(first)),
            high if last is None else min(high, math.floor(last)),
        )

    def _range(self, type_: Type) -> tuple[Fraction | None, Fraction | None]:
        """The ends of a type's range; None where there is no such end, or a parameter that is not set decides."""
        span = type_.raw_range.at(self._scope.assignment)
        return (span.low.at(self._scope.numbers), span.high.at(self._scope.numbers)) if span else (None, None)

    def _integer(
        self,
        place: _Place,
        comment: str,
        type_: Type | None = None,
        *,
        documented: tuple[int, int] | None = None,
        values: Iterable[tuple[int, str]] = (),
        start: int | None = None,
    ) -> Signal:
        """A signal of integers: bare bits without a type. Encoders are held to `documented`; any bits are decoded."""
        limits = type_.raw_limits if type_ else (0, (1 << len(place.bits)) - 1)
        if documented and self._scope.direction is Direction.REQUEST:
            limits = documented
        linear, unit = self._scale(type_)
        if start is None:
            start = 0 if limits[0] <= 0 <= limits[1] else limits[0]
        signed = type_ is not None and type_.encoding is Encoding.SIGNED
        return self._signal(place, comment, signed, _numbers(linear, limits), unit, tuple(values), start)

    def _float(self, place: _Place, comment: str, type_: Type) -> Signal:
        linear, unit = self._scale(type_)
        low, high = self._range(type_)
        limits = ("0", "0")
        if self._scope.direction is Direction.REQUEST and low is not None and high is not None:
            limits = (number(low), number(high))
        numbers = (number(linear.scale), number(linear.offset), *limits)
        return self._signal(place, comment, True, numbers, unit, float_kind=_FLOAT_KINDS[type_.width])

    def _scale(self, type_: Type | None) -> tuple[Linear, str]:
        if type_ is None:
            return IDENTITY, ""
        line = type_.linear.at(self._scope.assignment)
        linear = line.at(self._scope.numbers) if line else None
        if linear is None:
            return IDENTITY, RAW_UNIT
        return linear, type_.unit.dbc if type_.unit else ""

    def _open(self, type_: Type) -> str:
        """The scale of a signal that stays raw since the number that it is a multiple of is not set."""
        line = type_.linear.at(self._scope.assignment)
        if line is None or line.at(self._scope.numbers) is not None:
            return ""
        unit = f" {type_.unit.dbc}" if type_.unit else ""
        offset = f", counted from {words.offset(line)}{unit}" if line.offset else ""
        return _sentence(f"Raw: one step is {words.step(line)}{unit}{offset}")

    def _signal(
        self,
        place: _Place,
        comment: str,
        signed: bool,
        numbers: _Numbers,
        unit: str,
        values: tuple[tuple[int, str], ...] = (),
        start_value: int = 0,
        float_kind: int = 0,
    ) -> Signal:
        name = fitting(place.name, self._taken)
        self._taken.add(name)
        return Signal(
            name,
            place.mux,
            place.start,
            len(place.bits),
            place.order is Order.BIG,
            signed,
            *numbers,
            unit,
            comment,
            values,
            start_value,
            float_kind,
        )


@functools.lru_cache(maxsize=1 << 12)
def _numbers(linear: Linear, raw: tuple[int, int]) -> _Numbers:
    """The numbers of a signal of integers, whose ends are `raw`: many signals have the same."""
    low, high = sorted(end * linear.scale + linear.offset for end in raw)
    return number(linear.scale), number(linear.offset), number(low), number(high)


def _names(parts: Mapping[int, Part]) -> list[tuple[int, str]]:
    """The commands of selector values. No name stands twice: readers look the value up by it."""
    named: dict[str, int] = {}
    for value, part in parts.items():
        name = part.command.name
        named[f"{name}_{part.code}" if name in named else name] = value
    return [(value, name) for name, value in named.items()]


def _about(part: Part) -> str:
    """What is worth knowing of a command before it is sent, as sentences with a space before."""
    command = part.command
    sentences: list[str] = []
    if part.message.direction is Direction.REQUEST:
        sentences += [in_ascii(e.title) for e in command.effects if e.level is not Level.NOTE]
        sentences += [] if command.implemented else ["Not implemented yet, the manual says"]
    sentences += [f"Manual {command.manual}"] if command.manual else []
    return "".join(map(_sentence, sentences))


def _sentence(text: str) -> str:
    return f" {text.rstrip('.')}." if text else ""
