"""The signals of a frame: its selector, and one signal for each field, flag and element of an array."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from ...model import formatting
from ...model.layout import Element, Field, Space, bits_of
from ...model.message import Command, Direction, Key
from ...model.metadata import Effect, Level
from ...model.types import IDENTITY, Assignment, Bound, Encoding, Linear, Order, Range, Type
from ...semantics.plan import message_plan
from ...semantics.valid_raws import FiniteFloats, NamedRaws, RawInterval, ValidRaws, valid_raws, width_limits
from ..field_contents import Content, contents
from .comments import Comments
from .frames import Part, is_shown_by
from .names import LETTER, RAW_UNIT, SignalBits, adjacent, reserved_name, signal_name, signals_of
from .text import any_text
from .view import Numbers, Signal

MAX_NAMED = 16
"""So many raw integers of one name for no value are listed."""

_ZERO = Numbers(Fraction(0), Fraction(0))
_FLOAT_KINDS = {32: 1, 64: 2}


class Signals:
    """Builds the signals of the frames of one direction; those of a message once for each set of parameters it uses."""

    def __init__(self, direction: Direction, numbers: Mapping[str, Fraction], comments: Comments) -> None:
        self._direction = direction
        self._letter = LETTER[direction]
        self._numbers = numbers
        self._comments = comments
        self._messages: dict[tuple[object, ...], Sequence[Signal]] = {}
        self._readings: dict[tuple[object, ...], tuple[Numbers, str]] = {}

    def of(self, parts: Sequence[Part], assignment: Assignment) -> Iterator[Signal]:
        """All signals of a frame; the first selector identifies the message."""
        if not parts[0].selectors:
            for part in parts:
                yield from self._message(part, assignment, "")
            return
        by_value: dict[int, list[Part]] = {}
        keyless = [part for part in parts if not part.selectors]
        for part in parts[: len(parts) - len(keyless)]:
            by_value.setdefault(part.selectors[0][1], []).append(part)
        key = parts[0].selectors[0][0]
        names = _names(
            (value, _shared_name(under), under[0].code.partition("_")[0]) for value, under in by_value.items()
        )
        selector = self._selector(f"{self._letter}_{key.name}", "M", key, names, "selector")
        about = (self._sharing(part, key) for part in keyless)
        yield selector._replace(comment=self._comments.sentences([selector.comment, *about]))
        for value, under in by_value.items():
            if len(under[0].selectors) == 1:
                yield from self._message(under[0], assignment, f"m{value}")
            else:
                yield from self._undecided(under, f"m{value}")
        for part in keyless:
            yield from self._ranged(part, assignment, key, by_value)

    def _sharing(self, part: Part, key: Key) -> str:
        """The sentence about the message with all values of a selector that others leave."""
        field = self._comments.listed(f.name for f in part.message.layout.fields if is_shown_by(f, key.segments))
        name = "all_others_with_field" if field else "all_others"
        return self._comments.fixed(name, command=part.command.name, field=field)

    def _ranged(self, part: Part, assignment: Assignment, key: Key, taken: Collection[int]) -> Iterator[Signal]:
        """The signals of a message with all values of a selector that are not taken."""
        runs = adjacent(value for value in range(1 << key.width) if value not in taken)
        ranges = tuple(range(run[0], run[-1] + 1) for run in runs)
        bits = bits_of(key.segments)
        for signal in self._message(part, assignment, f"m{runs[0][0]}", range(bits[0], bits[-1] + 1)):
            yield signal._replace(ranges=ranges)

    def joined(self, parts: Sequence[Part], assignment: Assignment, span: range) -> Iterator[Signal]:
        """All signals of a frame; its selectors are the bits of `span`, read as one number."""
        by_value = {part.joined_value(span): part for part in parts}
        name = "_".join((self._letter, *(key.name for key, _ in parts[0].selectors)))
        names = _names((value, part.command.name, part.code) for value, part in by_value.items())
        yield _bare(name, "M", span, self._sentence("joined"))._replace(values=tuple(names))
        for value, part in by_value.items():
            yield from self._message(part, assignment, f"m{value}", span)

    def _undecided(self, parts: Sequence[Part], mux: str) -> Iterator[Signal]:
        """Messages with a second selector: that selector, and all other bits as raw bits."""
        code, *_ = parts[0].code.split("_")
        shared = parts[0].selectors[: min(len(part.selectors) for part in parts)]
        for i, (key, _) in enumerate(shared[1:], start=1):
            named = [(part.selectors[i][1], part.command.name) for part in parts]
            values = [value for value, _ in named]
            names = [(value, command) for value, command in named if values.count(value) == 1]
            yield self._selector(f"{self._letter}{code}_{key.name}", mux, key, names, "index")
        free = set(range(max(part.message.dlc for part in parts) * 8)).difference(
            *(bits_of(k.segments) for k, _ in shared)
        )
        comment = self._sentence("separate_file" if all(part.joined_span for part in parts) else "undecided")
        for run in adjacent(free):
            yield _bare(f"{self._letter}{code}_data", mux, run, comment)

    def _selector(self, name: str, mux: str, key: Key, names: Sequence[tuple[int, str]], comment: str) -> Signal:
        bare = _bare(name, mux, bits_of(key.segments), self._sentence(comment), key.order)
        return bare._replace(values=tuple(names))

    def _sentence(self, name: str) -> str:
        return self._comments.sentences([self._comments.fixed(name)])

    def _message(self, part: Part, assignment: Assignment, mux: str, taken: range = range(0)) -> Sequence[Signal]:
        """The fields of a message outside the `taken` bits; the reserved bits if there are none, as readers need a signal."""
        known = {name: assignment[name] for name in part.message.layout.parameters if name in assignment}
        key = (part, mux, taken, *known.items())
        if key not in self._messages:
            self._messages[key] = list(self._fields(part, known, mux, taken)) or list(self._reserved(part, mux, taken))
        return self._messages[key]

    def _fields(self, part: Part, known: Assignment, mux: str, taken: range) -> Iterator[Signal]:
        layout = part.message.layout
        variant = layout.variant(known)
        about = list(self._about(part))
        for field in variant.fields if variant else tuple(f for f in layout.fields if not f.only):
            for element in field.elements if field.space is Space.DATA else ():
                if element.bits[0] not in taken:
                    yield from self._field(part, known, mux, field, element, about)
                    about = []

    def _reserved(self, part: Part, mux: str, taken: range) -> Iterator[Signal]:
        free = [bit for bit in range(part.message.dlc * 8) if bit not in taken and not part.selector_bits >> bit & 1]
        if free:
            reserved = self._comments.labelled(self._comments.of(part.command.title), self._comments.fixed("reserved"))
            comment = self._comments.sentences([reserved, *self._about(part)])
            yield self._unused(reserved_name(part), mux, max(adjacent(free), key=len), comment)

    def _unused(self, name: str, mux: str, bits: Sequence[int], comment: str, order: Order = Order.LITTLE) -> Signal:
        """Bits that are sent as 0; a decoder accepts any."""
        bare = _bare(name, mux, bits, comment, order)
        return bare._replace(numbers=_ZERO) if self._direction is Direction.REQUEST else bare

    def _field(
        self, part: Part, known: Assignment, mux: str, field: Field, element: Element, about: Sequence[str]
    ) -> Iterator[Signal]:
        """The signals of a field; `about` are sentences about the message."""
        comments, type_ = self._comments, field.type
        title = comments.of(part.command.title)
        which = f"{comments.of(field.title)} {'' if element.index is None else element.index}".strip()
        is_included = comments.labelled("", title).lower().endswith(comments.labelled("", which).lower())
        numbers, step = self._reading(type_, known)
        sentences = [
            title if is_included else comments.labelled(title, which),
            comments.deprecation(field.deprecated),
            comments.of(field.about) or comments.of(type_.about),
            *(comments.deprecation(m.deprecated, m.name) for m in (*type_.enum, *type_.no_values, *type_.names)),
            *(comments.fixed("nan", means=no_value.name) for no_value in type_.no_values if no_value.is_nan),
            step,
            comments.in_manual(field.manual_name),
            *about,
            *self._content(field, contents(part.message).get(field)),
        ]
        sent = message_plan(part.message).sent.get(field)
        signal = Signal(signal_name(part, field, element), mux, element.bits, type_.order, "", numbers)
        runs = list(signals_of(field, element))
        if runs[0].ending and not type_.flags:
            yield from self._parts(signal, sentences, runs, type_, sent)
        elif sent is not None:
            numbers = self._integers(type_, numbers.linear, numbers.unit, (sent, sent))
            yield signal._replace(comment=comments.sentences(sentences), numbers=numbers._replace(start_value=sent))
        elif not field.is_given:
            yield signal._replace(comment=comments.sentences(sentences))
        elif type_.flags:
            yield from self._flags(signal, sentences, runs, type_)
        else:
            no_values = [no_value for no_value in type_.no_values if not no_value.is_nan]
            named = [(raw, no_value.name) for no_value in no_values for raw in _listed(no_value.raws)]
            members = ((member.value, member.name) for member in (*type_.enum, *type_.names))
            values = tuple(sorted((*members, *named)))
            yield signal._replace(comment=comments.sentences(sentences), values=values)

    def _content(self, field: Field, content: Content | None) -> Iterator[str]:
        """The sentence about what is sent in a field, if its type does not state it."""
        if field.counter:
            yield self._comments.fixed("counter", first=field.counter.first, last=field.counter.last)
        if content:
            yield self._comments.fixed(f"content_{content.kind}", content=content.written)

    def _parts(
        self, whole: Signal, sentences: Sequence[str], runs: Sequence[SignalBits], of: Type, sent: int | None
    ) -> Iterator[Signal]:
        """One signal for each run of bits of a number: the value is the sum of their values."""
        names = [whole.whole_name + run.ending for run in runs]
        scale, offset = whole.numbers.linear.scale, whole.numbers.linear.offset
        summed = self._comments.fixed("summed", signals=self._comments.listed(names))
        comment = self._comments.sentences([*sentences, summed])
        for name, run in zip(names, runs, strict=True):
            low, width = run.low, len(run.bits)
            is_top = run is runs[-1] and of.encoding is Encoding.SIGNED
            ends = (-(1 << width - 1), (1 << width - 1) - 1) if is_top else (0, (1 << width) - 1)
            if sent is not None:
                raw = sent >> low if is_top else sent >> low & (1 << width) - 1
                ends = raw, raw
            linear = Linear(scale * (1 << low), Fraction(0) if low else offset)
            numbers = _integers(ends, linear, whole.numbers.unit, is_top, 0 if sent is None else ends[0])
            yield whole._replace(whole_name=name, bits=run.bits, comment=comment, numbers=numbers)

    def _flags(self, whole: Signal, sentences: Sequence[str], runs: Iterable[SignalBits], of: Type) -> Iterator[Signal]:
        """One signal for each flag, and one for each run of bits without a name, so that no bit is missing."""
        named = {flag.name: flag for flag in of.flags}
        for run in runs:
            name = whole.whole_name + run.ending
            if run.flag:
                flag = named[run.flag]
                about = [self._comments.of(flag.title), self._comments.deprecation(flag.deprecated)]
                comment = self._comments.sentences([*sentences, *about])
                yield _bare(name, whole.mux, run.bits, comment, whole.order)
            else:
                comment = self._comments.sentences([*sentences, self._comments.fixed("unnamed_bits")])
                yield self._unused(name, whole.mux, run.bits, comment, whole.order)

    def _reading(self, type_: Type, known: Assignment) -> tuple[Numbers, str]:
        """The numbers of all signals of a type; a sentence on the scale of a signal that stays raw."""
        key = (type_, *known.items())
        if key not in self._readings:
            line = type_.linear.at(known)
            linear = line.at(self._numbers) if line else None
            unit = RAW_UNIT if linear is None else type_.unit.dbc if type_.unit else ""
            step = self._step(type_, line) if line and linear is None else ""
            linear, valid = linear or IDENTITY, valid_raws(type_).at(known) or width_limits(type_)
            if isinstance(valid, FiniteFloats):
                numbers = self._floats(type_, linear, unit, valid.scaled)
            else:
                numbers = self._integers(type_, linear, unit, self._ends(type_, valid))
            self._readings[key] = numbers, step
        return self._readings[key]

    def _ends(self, type_: Type, valid: ValidRaws) -> tuple[int, int]:
        """The smallest and the largest valid raw integer, as far as the set parameters determine them."""
        if isinstance(valid, NamedRaws):
            return valid.values[0], valid.values[-1]
        if not isinstance(valid, RawInterval):
            return type_.raw_limits
        low, high = self._end(valid.low_bound), self._end(valid.high_bound)
        return (
            valid.low if low is None else max(valid.low, math.ceil(low)),
            valid.high if high is None else min(valid.high, math.floor(high)),
        )

    def _end(self, bound: Bound | None) -> Fraction | None:
        return bound.at(self._numbers) if bound else None

    def _integers(self, type_: Type, linear: Linear, unit: str, valid: tuple[int, int]) -> Numbers:
        """The numbers of an integer signal: the valid ones for an encoder; a decoder accepts all bit patterns."""
        limits = valid if self._direction is Direction.REQUEST else type_.raw_limits
        start_value = 0 if limits[0] <= 0 <= limits[1] else limits[0]
        return _integers(limits, linear, unit, type_.encoding is Encoding.SIGNED, start_value)

    def _floats(self, type_: Type, linear: Linear, unit: str, scaled: Range | None) -> Numbers:
        """The numbers of a float signal; it starts with 0, or with the first integer in its range."""
        low, high = (self._end(scaled.low), self._end(scaled.high)) if scaled else (None, None)
        numbers = _ZERO
        if self._direction is Direction.REQUEST and low is not None and high is not None:
            first, last = sorted((end - linear.offset) / linear.scale for end in (low, high))
            numbers = Numbers(low, high, start_value=0 if first <= 0 <= last else math.ceil(first))
        return numbers._replace(linear=linear, unit=unit, signed=True, float_kind=_FLOAT_KINDS[type_.width])

    def _step(self, type_: Type, line: Linear) -> str:
        """The scale of a signal that stays raw because its scale is a multiple of a parameter that is not set."""
        unit = f" {type_.unit.dbc}" if type_.unit else ""
        parts = [self._comments.fixed("raw_integer", step=formatting.with_ascii_pi(formatting.step(line)) + unit)]
        if line.offset:
            parts.append(
                self._comments.fixed("offset", offset=formatting.with_ascii_pi(formatting.offset(line)) + unit)
            )
        return self._comments.listed(parts)

    def _about(self, part: Part) -> Iterator[str]:
        """Warnings and manual section of a command, as sentences."""
        command = part.command
        yield self._comments.deprecation(command.deprecated, command.name)
        if part.message.direction is Direction.REQUEST:
            yield from (self._effect(command, e) for e in command.effects if e.level is not Level.NOTE)
            if not command.implemented:
                yield self._comments.fixed("not_implemented")
        cited = formatting.cited(any_text(command.manual), self._comments.printed(command.manual_name))
        if cited:
            yield self._comments.fixed("manual", section=cited)

    def _effect(self, command: Command, effect: Effect) -> str:
        title, values = self._comments.of(effect.title), formatting.exemptions(command, effect)
        return self._comments.fixed("effect_except", effect=title, values=values) if values else title


def _listed(raws: range) -> Sequence[int]:
    """The raw integers of a name that a file lists: both ends of many, since a DBC has no names for ranges."""
    return raws if len(raws) <= MAX_NAMED else (raws[0], raws[-1])


def _bare(name: str, mux: str, bits: Sequence[int], comment: str, order: Order = Order.LITTLE) -> Signal:
    """A signal without a type: plain bits."""
    return Signal(name, mux, tuple(bits), order, comment, Numbers(Fraction(0), Fraction((1 << len(bits)) - 1)))


def _integers(ends: tuple[int, int], linear: Linear, unit: str, signed: bool, start_value: int) -> Numbers:
    """The numbers of a signal with the raw integers between two ends."""
    low, high = sorted(end * linear.scale + linear.offset for end in ends)
    return Numbers(low, high, linear, unit, signed, start_value)


def _shared_name(parts: Sequence[Part]) -> str:
    """The command of a selector value: of messages with one more selector, the name of all of them; empty if they differ."""
    first, *further = parts
    if len(first.selectors) == 1:
        return first.command.name
    return first.command.spec_name if all(part.command.spec_name == first.command.spec_name for part in further) else ""


def _names(named: Iterable[tuple[int, str, str]]) -> list[tuple[int, str]]:
    """Values with names from value, name and code. Names are unique, because readers look values up by name."""
    values: dict[str, int] = {}
    for value, name, code in named:
        if name:
            values[f"{name}_{code}" if name in values else name] = value
    return [(value, name) for name, value in values.items()]
