"""Interpretations of recorded frames in several editions, and the reasons against them.

Frames with the same candidates and the same results of all checks are one observation: logs are long, and a million
frames have a few hundred of them.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Element, Field, ReservedRole, Space, Variant
from ..model.message import Direction, IdRule, Message
from ..model.types import Assignment, Encoding, Linear, Type
from ..semantics.candidates import Candidates
from ..semantics.decoder import value_of
from ..semantics.frame import CanFrame, data_bits, has_id, read_bits

WEAK = 1
"""Unusual: a reserved byte that is not 0, a raw integer beyond its printed range."""
UNNAMED = 2
"""An unnamed flag or value of a reply: manuals do not list all of them."""
IMPLAUSIBLE = 3
"""A value that no working node reports."""
STRONG = 4
"""Not in this edition: an id, a code, a length, a constant, an unnamed value in a request."""
MAX_KNOWN = 1 << 12
"""The maximum number of results that are remembered of each check, and of observations of one kind of frame."""


class Reason(NamedTuple):
    """A reason against an interpretation; `byte` is set for a reserved byte."""

    points: int
    text: str
    byte: int | None = None


class Interpretation:
    """A possible meaning of a frame in an edition, and the reasons against it; `message` is None without one."""

    __slots__ = ("is_dirty", "kind", "message", "points", "reasons")

    def __init__(self, kind: str, message: Message | None, reasons: tuple[Reason, ...]) -> None:
        self.kind = kind
        self.message = message
        self.reasons = reasons
        is_request = message is not None and message.direction is Direction.REQUEST
        reserved = sum(reason.points for reason in reasons if reason.byte is not None)
        self.is_dirty = bool(is_request and reserved)
        """Whether it is a request with reserved bytes that its host left uncleared."""
        others = sum(reason.points for reason in reasons if reason.byte is None)
        self.points = min(others + (min(reserved, WEAK) if is_request else reserved), STRONG)


@dataclass(frozen=True, eq=False)
class Observation:
    """Equal frames, as far as any edition distinguishes them: the interpretations in each edition, replies first."""

    kind: Kind
    by_edition: tuple[tuple[Interpretation, ...], ...]


class Kind:
    """The frames with the same candidates in all editions: the same id rule, length and keys."""

    def __init__(self, forms: Sequence[Sequence[Form]], nothing: Sequence[Reason]) -> None:
        self._forms = forms
        self._nothing = nothing
        probes: dict[tuple[bool, Parts], _Probe] = {}
        for form in dict.fromkeys(form for own in forms for form in own):
            for check in form.checks:
                place = check.in_id, _whole_byte(check.parts)
                probes.setdefault(place, _Probe(*place)).checks.append(check)
        self._probes = [probe for probe in probes.values() if probe.in_id or len(probe.parts) > 1]
        whole = [probe for probe in probes.values() if not probe.in_id and len(probe.parts) == 1]
        # Most probes have one part, and most of their results are known.
        self._quick = [(*probe.parts[0][:2], probe.limits(), probe.known, probe) for probe in whole]
        self._observations: dict[tuple[int, ...], Observation] = {}

    def observation(self, id_: int, data: int) -> Observation:
        """The observation of a frame; `data` as one little-endian integer."""
        results = []
        for shift, mask, steps, known, probe in self._quick:
            bits = data >> shift & mask
            result = known.get(bits if steps is None else bisect_right(steps, bits))
            results.append(probe.result(bits) if result is None else result)
        for probe in self._probes:
            results.append(probe.result(_bits(probe.parts, id_ if probe.in_id else data)))
        found = tuple(results)
        observation = self._observations.get(found)
        if observation is None:
            observation = self._observation(id_, data)
            if len(self._observations) < MAX_KNOWN:
                self._observations[found] = observation
        return observation

    def _observation(self, id_: int, data: int) -> Observation:
        interpretations = [
            tuple(form.interpret(id_, data) for form in own) or (Interpretation(nothing.text, None, (nothing,)),)
            for own, nothing in zip(self._forms, self._nothing, strict=True)
        ]
        return Observation(self, tuple(interpretations))


class Kinds:
    """The kinds of frames of several editions."""

    def __init__(self, editions: Sequence[Edition]) -> None:
        self._candidates = [Candidates(edition) for edition in editions]
        self._editions = editions
        self._forms: dict[tuple[int, Message], list[Form]] = {}
        self._kinds: dict[tuple[object, ...], Kind] = {}
        self._messages: dict[tuple[int, bool, bool], list[Message]] = {}

    def messages(self, frame: CanFrame) -> list[Message]:
        """The messages of all editions with the id of a frame."""
        id_ = frame.id, frame.extended, frame.remote
        found = self._messages.get(id_)
        if found is None:
            found = [m for edition in self._editions for m in edition.all_messages() if has_id(m, frame)]
            if len(self._messages) < MAX_KNOWN:
                self._messages[id_] = found
        return found

    def code_bits(self, frame: CanFrame) -> int:
        """The data bits of the first keys of all messages with the id of a frame."""
        return data_bits((key.space, key.segments) for message in self.messages(frame) for key in message.keys[:1])

    def key_bits(self, frame: CanFrame) -> int:
        """The data bits of all keys of the messages with the id and the first key of a frame."""
        return data_bits(
            (key.space, key.segments)
            for message in self.messages(frame)
            if not message.keys or read_bits(message.keys[0], frame) in (*message.accept, *message.claims)
            for key in message.keys
        )

    def kind(self, frame: CanFrame, rule: IdRule) -> Kind:
        """The kind of a frame with an id of `rule`."""
        found = [tuple(candidates.of(frame)) if candidates.has_id(frame) else None for candidates in self._candidates]
        code = frame.data[:1] if self.code_bits(frame) == 0xFF else b""
        known = (rule, len(frame.data), code, *found)
        if known not in self._kinds:
            where = formatting.id_rule(rule)
            start = f" that starts with {code.hex().upper()}" if code else ""
            unknown = f"no frame of {formatting.counted(len(frame.data), 'byte')}{start} on {where}"
            nothing = [
                Reason(STRONG, f"{where} is not an id of this edition" if messages is None else unknown)
                for messages in found
            ]
            forms = [[f for m in messages or () for f in self._forms_of(i, m)] for i, messages in enumerate(found)]
            self._kinds[known] = Kind(forms, nothing)
        return self._kinds[known]

    def _forms_of(self, edition: int, message: Message) -> list[Form]:
        """A form for each variant of the layout."""
        if (edition, message) not in self._forms:
            own = [Form(self._editions[edition], message, variant) for variant in message.layout.variants]
            self._forms[edition, message] = own
        return self._forms[edition, message]


class Form:
    """A message under one variant of its layout."""

    def __init__(self, edition: Edition, message: Message, variant: Variant) -> None:
        self.checks: list[Check] = []
        self._message = message
        keys = data_bits((key.space, key.segments) for key in message.keys)
        fields = data_bits((f.space, e.segments) for f in variant.fields for e in f.elements)
        is_request = message.direction is Direction.REQUEST
        where = f"{message.direction.value} of {message.command}" + (reply_rule(edition, message) if is_request else "")
        for at in range(message.dlc):
            mask = ~(keys | fields) >> at * 8 & 0xFF
            if mask:
                self.checks.append(_ReservedCheck(at, mask, where))
        for field in variant.fields:
            self.checks += _FieldCheck.of(field, where, is_request=is_request)

    def interpret(self, id_: int, data: int) -> Interpretation:
        """A frame as this message, with the reasons against it."""
        found = (check.reason(_bits(check.parts, id_ if check.in_id else data)) for check in self.checks)
        return Interpretation(self._message.name, self._message, tuple(reason for reason in found if reason))


Parts = tuple[tuple[int, int, int], ...]
"""Shift, mask and position of the bits of a raw integer."""


class Check:
    """A check of some bits of a frame; the result changes only at the numbers `steps`, unless they are None."""

    in_id: bool
    parts: Parts
    steps: Sequence[int] | None

    def reason(self, bits: int) -> Reason | None:
        """The reason against the bits; None without one."""
        raise NotImplementedError


class _ReservedCheck(Check):
    """The reserved bits of a byte are 0."""

    def __init__(self, at: int, mask: int, where: str) -> None:
        self.in_id = False
        self.parts = ((at * 8, mask, 0),)
        self.steps = (1,)
        self._reason = Reason(WEAK, where, at)

    def reason(self, bits: int) -> Reason | None:
        return self._reason if bits else None


class _FieldCheck(Check):
    """An element of a field has a constant, a name, or a value within its range."""

    def __init__(self, field: Field, element: Element, where: str, *, is_request: bool) -> None:
        self.in_id = field.space is Space.ID
        self.parts = _parts(element)
        self.steps = _steps(field)
        self._field = field
        self._named = f"{where}: `{field.name}`"
        self._unnamed = STRONG if is_request else UNNAMED

    @classmethod
    def of(cls, field: Field, where: str, *, is_request: bool) -> list[Check]:
        """The checks of a field; none if it accepts everything."""
        type_ = field.type
        bounded = any(type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases))
        is_checked = field.demanded is not None or type_.enum or type_.flags or type_.plausible or bounded
        if isinstance(field.role, ReservedRole) or not is_checked:
            return []
        return [cls(field, element, where, is_request=is_request) for element in field.elements]

    def reason(self, bits: int) -> Reason | None:
        type_ = self._field.type
        signed = type_.encoding is Encoding.SIGNED and bits >> (type_.width - 1)
        raw = bits - (1 << type_.width) if signed else bits
        if self._field.demanded is not None:
            wrong = raw != self._field.demanded
            return Reason(STRONG, f"{self._named} is not {self._field.demanded}") if wrong else None
        if type_.enum and all(member.value != raw for member in type_.enum):
            return Reason(self._unnamed, f"{self._named} has a value without a name")
        if type_.flags and raw & ~sum(1 << flag.value for flag in type_.flags):
            return Reason(UNNAMED, f"{self._named} has bits without a name")
        if not _is_plausible(type_, raw):
            limits = formatting.span(type_.plausible) if type_.plausible else ""
            unit = f" {type_.unit.symbol}" if type_.unit else ""
            return Reason(IMPLAUSIBLE, f"{self._named} is outside the plausible range {limits}{unit}")
        if not _is_in_range(type_, raw):
            return Reason(WEAK, f"{self._named} is out of range")
        return None


class _Probe:
    """The checks of the same bits, in all forms of a kind: a number for each combination of their results.

    `known` are the numbers by bits, or by the position of the bits among the limits.
    """

    def __init__(self, in_id: bool, parts: Parts) -> None:
        self.in_id = in_id
        self.parts = parts
        self.checks: list[Check] = []
        self.known: dict[int, int] = {}
        self._numbers: dict[tuple[Reason | None, ...], int] = {}

    def limits(self) -> list[int] | None:
        """The numbers at which a result changes; None if it depends on all bits."""
        steps = [check.steps for check in self.checks if check.steps is not None]
        if len(steps) < len(self.checks) or any(check.parts != self.parts for check in self.checks):
            return None
        return sorted({step for own in steps for step in own})

    def result(self, bits: int) -> int:
        """The number of the result for these bits."""
        ((shift, _, _),) = self.parts if len(self.parts) == 1 else ((0, 0, 0),)
        reasons = tuple(
            check.reason(bits if check.parts == self.parts else _bits(check.parts, bits << shift))
            for check in self.checks
        )
        number = self._numbers.setdefault(reasons, len(self._numbers))
        if len(self.known) < MAX_KNOWN:
            limits = self.limits()
            self.known[bits if limits is None else bisect_right(limits, bits)] = number
        return number


def _whole_byte(parts: Parts) -> Parts:
    """The byte that contains some bits; the bits themselves if they are in several."""
    ((shift, mask, _), *others) = parts
    is_within = not others and shift % 8 + mask.bit_length() <= 8
    return ((shift // 8 * 8, 0xFF, 0),) if is_within else parts


def reply_rule(edition: Edition, message: Message) -> str:
    """The id rule of the reply to a request, as text; empty if both have the same ids."""
    reply = edition.command(message.command).reply
    if reply is None or reply.id == message.id or reply.id.nodes is None:
        return ""
    return f"; expected replies on {formatting.id_rule(reply.id)}"


def _bits(parts: Parts, source: int) -> int:
    bits = 0
    for shift, mask, low in parts:
        bits |= (source >> shift & mask) << low
    return bits


def _parts(element: Element) -> Parts:
    """The bits of an element; consecutive segments are joined."""
    parts: list[tuple[int, int, int]] = []
    for s in sorted(element.segments, key=lambda s: s.raw_low):
        shift, mask = s.byte * 8 + s.low, (1 << s.width) - 1
        if parts:
            before, known, low = parts[-1]
            width = known.bit_length()
            if (before + width, low + width) == (shift, s.raw_low):
                parts[-1] = (before, known | mask << width, low)
                continue
        parts.append((shift, mask, s.raw_low))
    return tuple(parts)


def _steps(field: Field) -> list[int] | None:
    """The numbers at which a limit of an integer begins or ends; None if other results depend on its bits."""
    type_ = field.type
    if field.demanded is not None or type_.enum or type_.flags or type_.encoding is Encoding.FLOAT:
        return None
    limits = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    bounds = [b.constant for one in limits if one and one.is_constant for b in (one.low, one.high)]
    if type_.plausible is not None:
        for assignment in _assignments(type_.linear.parameter, type_.linear.cases):
            linear = type_.linear.at(assignment) or Linear(Fraction(1), Fraction(0))
            ends = (type_.plausible.low.constant, type_.plausible.high.constant)
            bounds += [(end - linear.offset) / linear.scale for end in ends]
    near = {around for b in bounds for around in (math.floor(b), math.floor(b) + 1, math.ceil(b) + 1)}
    modulus = 1 << type_.width
    return sorted({number % modulus for number in near} | {modulus >> 1})


def _assignments(parameter: str | None, cases: Iterable[str]) -> list[Assignment]:
    return [{parameter: case} for case in cases] if parameter else [{}]


def _is_plausible(type_: Type, raw: int) -> bool:
    if type_.plausible is None:
        return True
    low, high = type_.plausible.low.constant, type_.plausible.high.constant
    values = [value_of(type_, raw, a) for a in _assignments(type_.linear.parameter, type_.linear.cases)]
    return any(not isinstance(value, Fraction) or low <= value <= high for value in values)


def _is_in_range(type_: Type, raw: int) -> bool:
    """Whether a raw integer is in range under some parameter value; ranges with a number parameter are not checked."""
    spans = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    return any(s is None or not s.is_constant or s.low.constant <= raw <= s.high.constant for s in spans)
