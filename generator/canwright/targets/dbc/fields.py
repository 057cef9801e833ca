"""The signals of messages: one for each field, flag and element of an array."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.layout import Element, Field, FixedRole, ReservedRole, Space
from ...model.message import Command, Direction
from ...model.metadata import Effect, Level
from ...model.types import IDENTITY, Assignment, Encoding, Linear, Order, Type
from .comments import Comments
from .frames import Part
from .selectors import runs, selector_bits
from .text import any_text, number
from .view import Signal

RAW_UNIT = "raw"
"""Unit of values without a scale, so that raw integers are not mistaken for a quantity."""

LETTER = {Direction.REPLY: "r", Direction.REQUEST: "c"}
"""First letter of signal names, so that the names of the two directions differ."""

_FLOAT_KINDS = {32: 1, 64: 2}


class Place(NamedTuple):
    """Name, selector value and bits of a signal, least significant bit first."""

    name: str
    mux: str
    bits: tuple[int, ...]
    order: Order = Order.LITTLE

    @property
    def start(self) -> int:
        return self.bits[-1] if self.order is Order.BIG else self.bits[0]


class _Numbers(NamedTuple):
    """The numbers of a signal as text, and their unit."""

    signed: bool
    factor: str
    offset: str
    minimum: str
    maximum: str
    unit: str


class _Reading(NamedTuple):
    """Properties of all signals of a type; `step` is a sentence on the scale of a signal that stays raw."""

    numbers: _Numbers
    values: tuple[tuple[int, str], ...]
    start_value: int
    float_kind: int
    step: str


def bare(
    place: Place, comment: str, values: Sequence[tuple[int, str]] = (), limits: tuple[int, int] | None = None
) -> Signal:
    """A signal without a type: plain bits."""
    low, high = limits or (0, (1 << len(place.bits)) - 1)
    return _signal(place, comment, _Numbers(False, "1", "0", str(low), str(high), ""), tuple(values))


class Fields:
    """Builds the signals of messages for given parameter values; names may be too long or not unique."""

    def __init__(
        self, direction: Direction, assignment: Assignment, numbers: Mapping[str, Fraction], comments: Comments
    ) -> None:
        self._direction = direction
        self._comments = comments
        self._assignment = assignment
        self._numbers = numbers
        self._messages: dict[tuple[Part, str, range], Sequence[Signal]] = {}
        self._types: dict[Type, _Reading] = {}

    def of(self, part: Part, mux: str, taken: range = range(0)) -> Sequence[Signal]:
        """The fields of a message outside the `taken` bits; the reserved bits if there are none, as readers need a signal."""
        key = (part, mux, taken)
        if key not in self._messages:
            self._messages[key] = list(self._message(*key)) or list(self._reserved(*key))
        return self._messages[key]

    def _message(self, part: Part, mux: str, taken: range) -> Iterator[Signal]:
        layout = part.message.layout
        variant = layout.variant(self._assignment)
        fields = variant.fields if variant else tuple(f for f in layout.fields if not f.only)
        places = [(f, e) for f in fields if f.space is Space.DATA for e in f.elements if e.bits[0] not in taken]
        prefix, title, about = self._prefix(part), self._comments.of(part.command.title), list(self._about(part))
        for field, element in places:
            yield from self._field(f"{prefix}_{field.name}", mux, title, field, element, about)
            about = []

    def _reserved(self, part: Part, mux: str, taken: range) -> Iterator[Signal]:
        free = runs(set(range(part.message.dlc * 8)) - selector_bits(part) - set(taken))
        if free:
            place = Place(f"{self._prefix(part)}_reserved", mux, max(free, key=len))
            reserved = self._comments.labelled(self._comments.of(part.command.title), self._comments.fixed("reserved"))
            comment = self._comments.sentences([reserved, *self._about(part)])
            yield bare(place, comment, limits=self._sent((0, 0)))

    def _prefix(self, part: Part) -> str:
        return f"{LETTER[self._direction]}{part.code}"

    def _sent(self, limits: tuple[int, int]) -> tuple[int, int] | None:
        """Limits for encoders; None for a direction that is only decoded, where all bit patterns are valid."""
        return limits if self._direction is Direction.REQUEST else None

    def _field(
        self, name: str, mux: str, title: str, field: Field, element: Element, about: Sequence[str]
    ) -> Iterator[Signal]:
        """The signals of a field; `about` are sentences about the message."""
        comments, type_ = self._comments, field.type
        index = "" if element.index is None else str(element.index)
        place = Place(f"{name}_{index}" if index else name, mux, element.bits, type_.order)
        which = f"{comments.of(field.title)} {index}".strip()
        is_included = comments.labelled("", title).lower().endswith(comments.labelled("", which).lower())
        whole = title if is_included else comments.labelled(title, which)
        reading = self._reading(type_)
        sentences = [
            whole,
            comments.deprecation(field.deprecated),
            comments.of(field.about) or comments.of(type_.about),
        ]
        sentences += [*(comments.deprecation(m.deprecated, m.name) for m in type_.enum), reading.step, *about]
        if isinstance(field.role, FixedRole):
            numbers, _ = self._integers(type_, (field.role.raw, field.role.raw))
            word = "sent_as" if isinstance(field.role, ReservedRole) else "always"
            comment = comments.sentences([*sentences, comments.fixed(word, raw=field.role.raw)])
            yield _signal(place, comment, numbers, start_value=field.role.raw)
        elif type_.flags:
            yield from self._flags(place, sentences, type_)
        else:
            comment = comments.sentences(sentences)
            yield _signal(place, comment, reading.numbers, reading.values, reading.start_value, reading.float_kind)

    def _flags(self, place: Place, sentences: Sequence[str], type_: Type) -> Iterator[Signal]:
        """One signal for each flag, and one for each run of bits without a name, so that no bit is missing."""
        named = {flag.value: flag for flag in type_.flags}
        for run in runs(range(type_.width), split=named):
            raw_bits = tuple(place.bits[i] for i in run)
            flag = named.get(run[0])
            if flag:
                flag_place = Place(f"{place.name}_{flag.name}", place.mux, raw_bits, place.order)
                about = [self._comments.of(flag.title), self._comments.deprecation(flag.deprecated)]
                yield bare(flag_place, self._comments.sentences([*sentences, *about]))
            else:
                name = "_".join((place.name, "bits", *(str(i) for i in sorted({run[0], run[-1]}))))
                unnamed = Place(name, place.mux, raw_bits, place.order)
                comment = self._comments.sentences([*sentences, self._comments.fixed("unnamed_bits")])
                yield bare(unnamed, comment, limits=self._sent((0, 0)))

    def _reading(self, type_: Type) -> _Reading:
        if type_ not in self._types:
            self._types[type_] = self._made_reading(type_)
        return self._types[type_]

    def _made_reading(self, type_: Type) -> _Reading:
        if type_.encoding is Encoding.FLOAT:
            numbers, start_value = self._floats(type_)
            return _Reading(numbers, (), start_value, _FLOAT_KINDS[type_.width], self._step(type_))
        values = tuple(sorted((member.value, member.name) for member in type_.enum))
        documented = (values[0][0], values[-1][0]) if values else self._documented(type_)
        numbers, start_value = self._integers(type_, documented)
        return _Reading(numbers, values, start_value, 0, self._step(type_))

    def _documented(self, type_: Type) -> tuple[int, int]:
        """The raw integers that the spec allows, as far as the set parameters determine them."""
        low, high = type_.raw_limits
        first, last = self._range(type_)
        return (
            low if first is None else max(low, math.ceil(first)),
            high if last is None else min(high, math.floor(last)),
        )

    def _range(self, type_: Type) -> tuple[Fraction | None, Fraction | None]:
        """The ends of the range of a type; None if an end does not exist or depends on a parameter that is not set."""
        span = type_.raw_range.at(self._assignment)
        return (span.low.at(self._numbers), span.high.at(self._numbers)) if span else (None, None)

    def _integers(self, type_: Type, documented: tuple[int, int]) -> tuple[_Numbers, int]:
        """The numbers of an integer signal, and its start value."""
        limits = self._sent(documented) or type_.raw_limits
        linear, unit = self._scale(type_)
        low, high = sorted(end * linear.scale + linear.offset for end in limits)
        signed = type_.encoding is Encoding.SIGNED
        numbers = _Numbers(signed, number(linear.scale), number(linear.offset), number(low), number(high), unit)
        return numbers, 0 if limits[0] <= 0 <= limits[1] else limits[0]

    def _floats(self, type_: Type) -> tuple[_Numbers, int]:
        """The numbers of a float signal, and its start value: 0, or the first integer in its range."""
        linear, unit = self._scale(type_)
        low, high = self._range(type_)
        limits, start_value = ("0", "0"), 0
        if self._direction is Direction.REQUEST and low is not None and high is not None:
            limits = (number(low), number(high))
            first, last = sorted((end - linear.offset) / linear.scale for end in (low, high))
            start_value = 0 if first <= 0 <= last else math.ceil(first)
        return _Numbers(True, number(linear.scale), number(linear.offset), *limits, unit), start_value

    def _scale(self, type_: Type) -> tuple[Linear, str]:
        line = type_.linear.at(self._assignment)
        linear = line.at(self._numbers) if line else None
        if linear is None:
            return IDENTITY, RAW_UNIT
        return linear, type_.unit.dbc if type_.unit else ""

    def _step(self, type_: Type) -> str:
        """The scale of a signal that stays raw because its scale is a multiple of a parameter that is not set."""
        line = type_.linear.at(self._assignment)
        if line is None or line.at(self._numbers) is not None:
            return ""
        unit = f" {type_.unit.dbc}" if type_.unit else ""
        parts = [self._comments.fixed("raw_integer", step=f"{formatting.step(line)}{unit}")]
        if line.offset:
            parts.append(self._comments.fixed("offset", offset=f"{formatting.offset(line)}{unit}"))
        return self._comments.listed(parts)

    def _about(self, part: Part) -> Iterator[str]:
        """Warnings and manual section of a command, as sentences."""
        command = part.command
        yield self._comments.deprecation(command.deprecated, command.name)
        if part.message.direction is Direction.REQUEST:
            yield from (self._effect(command, e) for e in command.effects if e.level is not Level.NOTE)
            if not command.implemented:
                yield self._comments.fixed("not_implemented")
        if command.manual:
            yield self._comments.fixed("manual", section=any_text(command.manual))

    def _effect(self, command: Command, effect: Effect) -> str:
        title, values = self._comments.of(effect.title), formatting.exemptions(command, effect)
        return self._comments.fixed("effect_except", effect=title, values=values) if values else title


def _signal(
    place: Place,
    comment: str,
    numbers: _Numbers,
    values: tuple[tuple[int, str], ...] = (),
    start_value: int = 0,
    float_kind: int = 0,
) -> Signal:
    is_big = place.order is Order.BIG
    return Signal(
        place.name,
        place.mux,
        place.start,
        len(place.bits),
        is_big,
        *numbers,
        comment,
        values,
        start_value,
        float_kind,
    )
