"""What a recorded frame can be in an edition, and what speaks against it.

One reader reads the frames of one node in one edition, in order: where a request and its reply share an id, what comes
after a request tells them apart. All that can be worked out once for an id is; logs are long.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Element, Field, ReservedRole, Space, Variant
from ..model.message import Direction, Message
from ..model.types import Assignment, Encoding, Type
from ..semantics.candidates import Candidates
from ..semantics.decoder import value_of
from ..semantics.frame import CanFrame, data_bits, node_of

WEAK = 1
"""Unusual: a reserved byte of a reply that is not 0, a raw integer beyond its printed range."""
UNNAMED = 2
"""A reserved byte of a request, which a host leaves 0; flags and values of a reply without a name: nodes know more of
them than manuals tell."""
IMPLAUSIBLE = 3
"""A value that no working node reports."""
STRONG = 4
"""Not in this edition: an id, a code, a length, a constant, a name that a host would have to know."""


@dataclass(frozen=True)
class Reason:
    """What speaks against an edition. `kind` are the frames among which it is counted; a reserved byte has its number."""

    points: int
    kind: str
    text: str
    byte: int | None = None


@dataclass(frozen=True)
class Reading:
    """What a frame is taken for, and what speaks against that."""

    kind: str
    reasons: tuple[Reason, ...]

    @property
    def points(self) -> int:
        reserved = [r.points for r in self.reasons if r.byte is not None]
        return min(sum(reserved), STRONG) + sum(r.points for r in self.reasons if r.byte is None)


class Reader:
    """Reads the frames of one node in one edition."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self._candidates = Candidates(edition)
        self._forms: dict[tuple[Message, int], list[_Form]] = {}
        self._asked: dict[str, bool] = {}

    def read(self, frame: CanFrame) -> Reading:
        """What the next frame is taken for: of all readings, the one with the least against it."""
        if not self._candidates.has_id(frame):
            kind = f"0x{frame.id:X}"
            return Reading(kind, (Reason(STRONG, kind, f"{kind} is no id of this edition"),))
        data = int.from_bytes(frame.data, "little")
        forms = (form for message in self._candidates.of(frame) for form in self._forms_of(message, frame))
        readings = [(form, form.read(frame, data)) for form in forms]
        if not readings:
            start = frame.data[:1].hex().upper()
            kind = f"0x{frame.id:X} {start}"
            size = formatting.counted(len(frame.data), "byte")
            code = f" that starts with {start}" if start else ""
            return Reading(kind, (Reason(STRONG, kind, f"it has no frame of {size}{code} on 0x{frame.id:X}"),))
        return self._chosen(frame, readings)

    def _chosen(self, frame: CanFrame, readings: list[tuple[_Form, Reading]]) -> Reading:
        """The reading with the least against it. What is no request in order, right after one that is, is its reply."""
        asking = any(form.is_request and not reading.reasons for form, reading in readings)
        asked = [form for form, _ in readings if self._asked.get(form.command)]
        for form, _ in readings:
            self._asked[form.command] = asking
        if asked and not asking:
            replies = [reading for form, reading in readings if not form.is_request]
            if not replies:
                kind = asked[0].kind
                text = f"0x{frame.id:X} carries a reply of {asked[0].command}{asked[0].elsewhere}"
                return Reading(kind, (Reason(STRONG, kind, text),))
            return min(replies, key=lambda reading: reading.points)
        return min((reading for _, reading in readings), key=lambda reading: reading.points)

    def _forms_of(self, message: Message, frame: CanFrame) -> list[_Form]:
        """A form for each variant of the layout, made once for an id."""
        known = (message, frame.id)
        if known not in self._forms:
            self._forms[known] = [_Form(self.edition, message, v, frame) for v in message.layout.variants]
        return self._forms[known]


class _Form:
    """A message under one variant of its layout, ready to read data that is one integer, the first byte lowest."""

    def __init__(self, edition: Edition, message: Message, variant: Variant, frame: CanFrame) -> None:
        self.kind = message.name
        self.command = message.command
        self.is_request = message.direction is Direction.REQUEST
        keys = data_bits((key.space, key.segments) for key in message.keys)
        fields = data_bits((f.space, e.segments) for f in variant.fields for e in f.elements)
        self._reserved = ~(keys | fields)
        self.elsewhere = _elsewhere(edition, message, frame)
        self._where = f"{message.direction.value} of {message.command}" + (self.elsewhere if self.is_request else "")
        self._per_byte = UNNAMED if self.is_request else WEAK
        self._checks = [check for field in variant.fields for check in self._checks_of(field)]
        self._clean = Reading(self.kind, ())

    def read(self, frame: CanFrame, data: int) -> Reading:
        """What speaks against a frame's being this."""
        reasons = []
        if data & self._reserved:
            reasons = [
                Reason(self._per_byte, self.kind, self._where, at)
                for at in range(len(frame.data))
                if (data & self._reserved) >> at * 8 & 0xFF
            ]
        for in_id, parts, check in self._checks:
            source = frame.id if in_id else data
            raw = 0
            for shift, mask, raw_low in parts:
                raw |= (source >> shift & mask) << raw_low
            reason = check(raw)
            if reason is not None:
                reasons.append(reason)
        return Reading(self.kind, tuple(reasons)) if reasons else self._clean

    def _checks_of(self, field: Field) -> list[tuple[bool, list[tuple[int, int, int]], Callable[[int], Reason | None]]]:
        type_ = field.type
        bounded = any(type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases))
        if isinstance(field.role, ReservedRole):
            return []
        if not (field.demanded is not None or type_.enum or type_.flags or type_.plausible or bounded):
            return []
        check = functools.cache(functools.partial(self._reason, field))
        return [(field.space is Space.ID, _parts(element), check) for element in field.elements]

    def _reason(self, field: Field, bits: int) -> Reason | None:
        """What speaks against the bits of a field."""
        type_, named = field.type, f"{self._where}: `{field.name}`"
        signed = type_.encoding is Encoding.SIGNED and bits >> (type_.width - 1)
        raw = bits - (1 << type_.width) if signed else bits
        name = STRONG if self.is_request else UNNAMED
        if field.demanded is not None:
            wrong = raw != field.demanded
            return Reason(STRONG, self.kind, f"{named} is not {field.demanded}") if wrong else None
        if type_.enum and all(member.value != raw for member in type_.enum):
            return Reason(name, self.kind, f"{named} has a value without a name")
        if type_.flags and raw & ~sum(1 << flag.value for flag in type_.flags):
            return Reason(UNNAMED, self.kind, f"{named} has bits without a name")
        if not _is_plausible(type_, raw):
            limits = formatting.span(type_.plausible) if type_.plausible else ""
            unit = f" {type_.unit.symbol}" if type_.unit else ""
            return Reason(IMPLAUSIBLE, self.kind, f"{named} is not within a plausible {limits}{unit}")
        if not _is_in_range(type_, raw):
            return Reason(WEAK, self.kind, f"{named} is beyond its range")
        return None


def _elsewhere(edition: Edition, message: Message, frame: CanFrame) -> str:
    """Where replies to a request come, when it is not on its id."""
    reply, node = edition.command(message.command).reply, node_of(message, frame)
    if reply is None or reply.id == message.id or reply.id.nodes is None or node is None:
        return ""
    return f", though replies come on 0x{reply.id.base + node * reply.id.node_step:X}"


def _parts(element: Element) -> list[tuple[int, int, int]]:
    """Shift, mask and place in the raw integer; neighbours that stay in order are one."""
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
    return parts


def _assignments(parameter: str | None, cases: Iterable[str]) -> list[Assignment]:
    return [{parameter: case} for case in cases] if parameter else [{}]


def _is_plausible(type_: Type, raw: int) -> bool:
    if type_.plausible is None:
        return True
    low, high = type_.plausible.low.constant, type_.plausible.high.constant
    values = [value_of(type_, raw, a) for a in _assignments(type_.linear.parameter, type_.linear.cases)]
    return any(not isinstance(value, Fraction) or low <= value <= high for value in values)


def _is_in_range(type_: Type, raw: int) -> bool:
    """Whether a raw integer is in the range under some parameter; one that a number decides is not judged."""
    spans = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    return any(s is None or not s.is_constant or s.low.constant <= raw <= s.high.constant for s in spans)
