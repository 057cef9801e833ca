"""Interpretations of recorded frames in several editions, and the reasons against them.

Frames with the same candidates and the same results of all checks are one observation: logs are long, and a million
frames have a few hundred of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import getitem

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Variant
from ..model.message import Direction, IdRule, Message
from ..semantics.bits import data_bits
from ..semantics.candidates import Candidates
from ..semantics.frame import CanFrame, bits_at, has_id, read_bits
from .checks import STRONG, WEAK, Check, FieldCheck, Reason, ReservedCheck
from .probes import probes_of, unpackers

MAX_KNOWN = 1 << 12
"""The maximum number of observations of one kind of frame that are remembered."""


class Interpretation:
    """A possible meaning of a frame in an edition, and the reasons against it; `message` is None without one.

    If `is_of_host`, the host has chosen the data: those of a request, or of its echo.
    """

    __slots__ = ("is_careless", "is_request", "kind", "message", "points", "reasons")

    def __init__(
        self, kind: str, message: Message | None, reasons: tuple[Reason, ...], *, is_of_host: bool = False
    ) -> None:
        self.kind = kind
        self.message = message
        self.reasons = reasons
        self.is_request = message is not None and message.direction is Direction.REQUEST
        self.is_careless = is_of_host and all(reason.points <= WEAK for reason in reasons)
        """Whether a host can have sent this: it left reserved bytes uncleared, or exceeded a range."""
        reserved = sum(reason.points for reason in reasons if reason.byte is not None)
        others = sum(reason.points for reason in reasons if reason.byte is None)
        self.points = min(others + (min(reserved, WEAK) if is_of_host else reserved), STRONG)


@dataclass(frozen=True, eq=False)
class Observation:
    """Equal frames, as far as any edition distinguishes them: the interpretations in each edition, replies first."""

    kind: Kind
    by_edition: tuple[tuple[Interpretation, ...], ...]


class Kind:
    """The frames with the same candidates in all editions: the same id rule, length and keys."""

    def __init__(self, forms: Sequence[Sequence[Form]], nothing: Sequence[Reason], length: int) -> None:
        self._forms = forms
        self._nothing = nothing
        self._probes = probes_of(form.checks for form in dict.fromkeys(form for own in forms for form in own))
        unpacked = [probe for probe in self._probes if probe.is_integer and probe.end <= length]
        (self._unpack, self._results), *self._more = unpackers(unpacked, length)
        self._others = [probe for probe in self._probes if probe not in unpacked]
        self._known: dict[tuple[object, ...], Observation] = {}
        self._observations: dict[tuple[int, ...], Observation] = {}

    def observation(self, id_: int, data: bytes) -> Observation:
        """The observation of a frame with this id and data."""
        found: tuple[object, ...] = tuple(map(getitem, self._results, self._unpack(data)))
        for unpack, results in self._more:
            found += tuple(map(getitem, results, unpack(data)))
        if self._others:
            found += tuple([probe.result_of(id_, data) for probe in self._others])
        return self._known.get(found) or self._new(found, id_, data)

    def _new(self, found: tuple[object, ...], id_: int, data: bytes) -> Observation:
        """The observation of a frame; frames with equal results of all checks have the same."""
        results = tuple(probe.result_of(id_, data) for probe in self._probes)
        observation = self._observations.get(results)
        if observation is None:
            observation = Observation(self, self.interpretations(id_, data))
            if len(self._observations) < MAX_KNOWN:
                self._observations[results] = observation
        if len(self._known) < MAX_KNOWN:
            self._known[found] = observation
        return observation

    def interpretations(self, id_: int, data: bytes) -> tuple[tuple[Interpretation, ...], ...]:
        """The interpretations of a frame in each edition."""
        number = int.from_bytes(data, "little")
        return tuple(
            tuple(form.interpret(id_, number) for form in own) or (Interpretation(nothing.text, None, (nothing,)),)
            for own, nothing in zip(self._forms, self._nothing, strict=True)
        )


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

    def first_key(self, frame: CanFrame) -> slice[int, int, None]:
        """The bytes of the first keys of all messages with the id of a frame; empty if these are not whole bytes."""
        bits = data_bits((key.space, key.segments) for message in self.messages(frame) for key in message.keys[:1])
        start, end = (bits & -bits).bit_length() // 8, bits.bit_length() // 8
        return slice(start, end) if bits == (1 << 8 * end) - (1 << 8 * start) else slice(0, 0)

    def key_bits(self, frame: CanFrame) -> int:
        """The data bits, without those of `first_key`, of all keys of the messages with that key and the id of a frame."""
        first = self.first_key(frame)
        bits = data_bits(
            (key.space, key.segments)
            for message in self.messages(frame)
            if first == slice(0, 0)
            or not message.keys
            or read_bits(message.keys[0], frame) in (*message.accepted_codes, *message.identifying_codes)
            for key in message.keys
        )
        return bits & ~((1 << 8 * first.stop) - (1 << 8 * first.start))

    def all_key_bits(self, frame: CanFrame) -> int:
        """The data bits of all keys of the messages with the id of a frame."""
        return data_bits((key.space, key.segments) for message in self.messages(frame) for key in message.keys)

    def candidates(self, frame: CanFrame) -> list[Message]:
        """The messages that a frame can be in any edition."""
        return [message for candidates in self._candidates for message in candidates.of(frame)]

    def kind(self, frame: CanFrame, rule: IdRule) -> Kind:
        """The kind of a frame with an id of `rule`."""
        found = [tuple(candidates.of(frame)) if candidates.has_id(frame) else None for candidates in self._candidates]
        code = frame.data[:1] if self.first_key(frame) == slice(0, 1) else b""
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
            self._kinds[known] = Kind(forms, nothing, len(frame.data))
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
        self._is_of_host = is_request or edition.command(message.command).is_echoed
        where = f"{message.direction.value} of {message.command}" + (reply_rule(edition, message) if is_request else "")
        for at in range(message.dlc):
            mask = ~(keys | fields) >> at * 8 & 0xFF
            if mask:
                self.checks.append(ReservedCheck(at, mask, where))
        for field in variant.fields:
            self.checks += FieldCheck.of(field, where, is_request=is_request)

    def interpret(self, id_: int, data: int) -> Interpretation:
        """A frame as this message, with the reasons against it."""
        found = (check.reason(bits_at(check.parts, id_ if check.in_id else data)) for check in self.checks)
        reasons = tuple(reason for reason in found if reason)
        return Interpretation(self._message.name, self._message, reasons, is_of_host=self._is_of_host)


def reply_rule(edition: Edition, message: Message) -> str:
    """The id rule of the reply to a request, as text; empty if both have the same ids."""
    reply = edition.command(message.command).reply
    if reply is None or reply.id == message.id or reply.id.nodes is None:
        return ""
    return f"; expected replies on {formatting.id_rule(reply.id)}"
