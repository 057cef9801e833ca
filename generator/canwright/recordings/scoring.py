"""Interpretations of recorded frames in an edition, and the evidence against them.

A scorer interprets the frames of one node in one edition, in order: if a request and its reply share an id, the order
distinguishes them. Everything that depends on the id only is computed once per id, because logs are long.
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
"""A reserved byte of a request that is not 0; an unnamed flag or value of a reply: manuals do not list all of them."""
IMPLAUSIBLE = 3
"""A value that no working node reports."""
STRONG = 4
"""Not in this edition: an id, a code, a length, a constant, an unnamed value in a request."""


@dataclass(frozen=True)
class Reason:
    """A reason against an edition, counted among the frames of a `kind`; `byte` is set for a reserved byte."""

    points: int
    kind: str
    text: str
    byte: int | None = None


@dataclass(frozen=True)
class Interpretation:
    """A possible meaning of a frame, and the reasons against it."""

    kind: str
    reasons: tuple[Reason, ...]

    @property
    def points(self) -> int:
        reserved = [r.points for r in self.reasons if r.byte is not None]
        return min(sum(reserved), STRONG) + sum(r.points for r in self.reasons if r.byte is None)


class Scorer:
    """Interprets the frames of one node in one edition."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self._candidates = Candidates(edition)
        self._forms: dict[tuple[Message, int], list[_Form]] = {}
        self._asked: dict[str, bool] = {}

    def interpret(self, frame: CanFrame) -> Interpretation:
        """The interpretation of the next frame with the fewest points against it."""
        if not self._candidates.has_id(frame):
            kind = f"0x{frame.id:X}"
            return Interpretation(kind, (Reason(STRONG, kind, f"{kind} is not an id of this edition"),))
        data = int.from_bytes(frame.data, "little")
        forms = (form for message in self._candidates.of(frame) for form in self._forms_of(message, frame))
        interpretations = [(form, form.interpret(frame, data)) for form in forms]
        if not interpretations:
            start = frame.data[:1].hex().upper()
            kind = f"0x{frame.id:X} {start}"
            size = formatting.counted(len(frame.data), "byte")
            code = f" that starts with {start}" if start else ""
            return Interpretation(kind, (Reason(STRONG, kind, f"no frame of {size}{code} on 0x{frame.id:X}"),))
        return self._chosen(frame, interpretations)

    def _chosen(self, frame: CanFrame, interpretations: list[tuple[_Form, Interpretation]]) -> Interpretation:
        """The interpretation with the fewest points; a frame that follows a request and is none is a reply."""
        asking = any(form.is_request and not interpretation.reasons for form, interpretation in interpretations)
        asked = [form for form, _ in interpretations if self._asked.get(form.command)]
        for form, _ in interpretations:
            self._asked[form.command] = asking
        if asked and not asking:
            replies = [interpretation for form, interpretation in interpretations if not form.is_request]
            if not replies:
                kind = asked[0].kind
                text = f"0x{frame.id:X} has a reply of {asked[0].command}{asked[0].reply_id}"
                return Interpretation(kind, (Reason(STRONG, kind, text),))
            return min(replies, key=lambda interpretation: interpretation.points)
        return min(
            (interpretation for _, interpretation in interpretations), key=lambda interpretation: interpretation.points
        )

    def _forms_of(self, message: Message, frame: CanFrame) -> list[_Form]:
        """A form for each variant of the layout, cached by id."""
        known = (message, frame.id)
        if known not in self._forms:
            self._forms[known] = [_Form(self.edition, message, v, frame) for v in message.layout.variants]
        return self._forms[known]


class _Form:
    """A message under one variant of its layout; reads data as one little-endian integer."""

    def __init__(self, edition: Edition, message: Message, variant: Variant, frame: CanFrame) -> None:
        self.kind = message.name
        self.command = message.command
        self.is_request = message.direction is Direction.REQUEST
        keys = data_bits((key.space, key.segments) for key in message.keys)
        fields = data_bits((f.space, e.segments) for f in variant.fields for e in f.elements)
        self._reserved = ~(keys | fields)
        self.reply_id = _reply_id(edition, message, frame)
        self._where = f"{message.direction.value} of {message.command}" + (self.reply_id if self.is_request else "")
        self._per_byte = UNNAMED if self.is_request else WEAK
        self._checks = [check for field in variant.fields for check in self._checks_of(field)]
        self._clean = Interpretation(self.kind, ())

    def interpret(self, frame: CanFrame, data: int) -> Interpretation:
        """The frame as this message, with the reasons against it."""
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
        return Interpretation(self.kind, tuple(reasons)) if reasons else self._clean

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
        """The reason against the bits of a field; None without one."""
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
            return Reason(IMPLAUSIBLE, self.kind, f"{named} is outside the plausible range {limits}{unit}")
        if not _is_in_range(type_, raw):
            return Reason(WEAK, self.kind, f"{named} is out of range")
        return None


def _reply_id(edition: Edition, message: Message, frame: CanFrame) -> str:
    """The id of the reply to a request, as text; empty if both have the same id."""
    reply, node = edition.command(message.command).reply, node_of(message, frame)
    if reply is None or reply.id == message.id or reply.id.nodes is None or node is None:
        return ""
    return f"; expected replies on 0x{reply.id.base + node * reply.id.node_step:X}"


def _parts(element: Element) -> list[tuple[int, int, int]]:
    """Shift, mask and position in the raw integer; consecutive segments are joined."""
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
    """Whether a raw integer is in range under some parameter value; ranges with a number parameter are not checked."""
    spans = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    return any(s is None or not s.is_constant or s.low.constant <= raw <= s.high.constant for s in spans)
