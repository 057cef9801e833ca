"""Interpretations of recorded frames in several editions, and the reasons against them.

Frames with the same candidates and the same results of all checks are one observation: logs are long, and a million
frames have a few hundred of them.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from dataclasses import dataclass

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Variant
from ..model.message import Direction, IdRule, Message
from ..semantics.bits import data_bits
from ..semantics.candidates import Candidates
from ..semantics.frame import CanFrame, bits_at, has_id, read_bits
from ..semantics.plan import message_plan
from .checks import STRONG, WEAK, Check, Reason, field_checks, reserved_check
from .probes import Probes

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
        rest = sum(reason.points for reason in reasons if reason.byte is None)
        self.points = min(rest + (min(reserved, WEAK) if is_of_host else reserved), STRONG)


@dataclass(frozen=True, eq=False)
class Observation:
    """Equal frames, as far as any edition distinguishes them: the interpretations in each edition, replies first."""

    kind: ScoredClass
    by_edition: tuple[tuple[Interpretation, ...], ...]


class ScoredClass:
    """The frames with the same candidates in all editions: the same id rule, length and keys."""

    def __init__(self, forms: Sequence[Sequence[ScoredForm]], nothing: Sequence[Reason], length: int) -> None:
        self._forms = forms
        self._nothing = nothing
        distinct = [*dict.fromkeys(form for own in forms for form in own)]
        used = functools.reduce(operator.or_, (form.used for form in distinct), 0)
        self._free = used and ~used & (1 << 8 * length) - 1
        """The bits that are reserved in every message."""
        probes = Probes((form.checks for form in distinct), length)
        self._unpack, self._results, self._others = probes.unpack, probes.results, probes.others
        self._known: dict[tuple[object, ...], Observation] = {}
        self._observations: dict[tuple[object, ...], Observation] = {}

    def is_same(self, frame: CanFrame, before: CanFrame) -> bool:
        """Whether a frame and one before it differ at most in bits that are reserved in every message."""
        if frame == before or not self._free or len(frame.data) != len(before.data):
            return frame == before
        changed = int.from_bytes(frame.data, "little") ^ int.from_bytes(before.data, "little")
        return not changed & ~self._free and frame._replace(data=b"") == before._replace(data=b"")

    def observation(self, id_: int, data: bytes) -> Observation:
        """The observation of a frame with this id and data."""
        results: tuple[object, ...] = tuple(map(operator.getitem, self._results, self._unpack(data)))
        if self._others:
            results += tuple([probe.result_of(id_, data) for probe in self._others])
        return self._known.get(results) or self._new(results, id_, data)

    def _new(self, results: tuple[object, ...], id_: int, data: bytes) -> Observation:
        """The observation of a frame; frames with equal reasons have the same."""
        by_edition = self.interpretations(id_, data)
        reasons = tuple(interpretation.reasons for own in by_edition for interpretation in own)
        observation = self._observations.get(reasons) or Observation(self, by_edition)
        if len(self._observations) < MAX_KNOWN:
            self._observations[reasons] = observation
        if len(self._known) < MAX_KNOWN:
            self._known[results] = observation
        return observation

    def interpretations(self, id_: int, data: bytes) -> tuple[tuple[Interpretation, ...], ...]:
        """The interpretations of a frame in each edition."""
        number = int.from_bytes(data, "little")
        return tuple(
            tuple(form.interpret(id_, number) for form in own) or (Interpretation(nothing.text, None, (nothing,)),)
            for own, nothing in zip(self._forms, self._nothing, strict=True)
        )


class ScoredClasses:
    """The kinds of frames of several editions."""

    def __init__(self, editions: Sequence[Edition]) -> None:
        self._candidates = [Candidates(edition) for edition in editions]
        self._editions = editions
        self._forms: dict[tuple[int, Message], list[ScoredForm]] = {}
        self._kinds: dict[tuple[object, ...], ScoredClass] = {}
        self._messages: dict[tuple[int, bool, bool], tuple[Message, ...]] = {}
        self._first_keys: dict[tuple[Message, ...], slice[int, int, None]] = {}
        self._further_bits: dict[tuple[tuple[Message, ...], bytes], int] = {}

    def messages(self, frame: CanFrame) -> tuple[Message, ...]:
        """The messages of all editions with the id of a frame."""
        id_ = frame.id, frame.extended, frame.remote
        known = self._messages.get(id_)
        if known is None:
            known = tuple(m for edition in self._editions for m in edition.all_messages() if has_id(m, frame))
            if len(self._messages) < MAX_KNOWN:
                self._messages[id_] = known
        return known

    def first_key(self, frame: CanFrame) -> slice[int, int, None]:
        """The bytes of the first keys of all messages with the id of a frame; empty if these are not whole bytes."""
        messages = self.messages(frame)
        if messages not in self._first_keys:
            bits = data_bits((key.space, key.segments) for message in messages for key in message.keys[:1])
            start, end = (bits & -bits).bit_length() // 8, bits.bit_length() // 8
            is_whole = bits == (1 << 8 * end) - (1 << 8 * start)
            self._first_keys[messages] = slice(start, end) if is_whole else slice(0, 0)
        return self._first_keys[messages]

    def further_bits(self, frame: CanFrame) -> int:
        """The data bits that identify a frame beside `first_key`: other keys, and the node if the id has none."""
        messages, first = self.messages(frame), self.first_key(frame)
        known = messages, frame.data[first]
        if known not in self._further_bits:
            if len(self._further_bits) >= MAX_KNOWN:
                self._further_bits.clear()
            self._further_bits[known] = self._further(messages, first, frame)
        return self._further_bits[known]

    @staticmethod
    def _further(messages: Sequence[Message], first: slice[int, int, None], frame: CanFrame) -> int:
        having = [
            message
            for message in messages
            if first == slice(0, 0)
            or not message.keys
            or read_bits(message.keys[0], frame) in message_plan(message).keys[0].values
        ]
        nodes = (message.node_bits for message in messages if message.id.nodes is None)
        runs = [*(key for message in having for key in message.keys), *(bits for bits in nodes if bits)]
        return data_bits((run.space, run.segments) for run in runs) & ~((1 << 8 * first.stop) - (1 << 8 * first.start))

    def candidates(self, frame: CanFrame) -> list[Message]:
        """The messages that a frame can be in any edition."""
        return [message for candidates in self._candidates for message in candidates.of(frame)]

    def kind(self, frame: CanFrame, rule: IdRule) -> ScoredClass:
        """The kind of a frame with an id of `rule`."""
        candidates_of = [
            tuple(candidates.of(frame)) if candidates.has_id(frame) else None for candidates in self._candidates
        ]
        code = frame.data[:1] if self.first_key(frame) == slice(0, 1) else b""
        known = (rule, len(frame.data), code, *candidates_of)
        if known not in self._kinds:
            where = formatting.id_rule(rule)
            start = f" that starts with {code.hex().upper()}" if code else ""
            unknown = f"no frame of {formatting.counted(len(frame.data), 'byte')}{start} on {where}"
            nothing = [
                Reason(STRONG, f"{where} is not an id of this edition" if messages is None else unknown)
                for messages in candidates_of
            ]
            forms = [
                [f for m in messages or () for f in self._forms_of(i, m)] for i, messages in enumerate(candidates_of)
            ]
            self._kinds[known] = ScoredClass(forms, nothing, len(frame.data))
        return self._kinds[known]

    def _forms_of(self, edition: int, message: Message) -> list[ScoredForm]:
        """A form for each variant of the layout."""
        if (edition, message) not in self._forms:
            own = [ScoredForm(self._editions[edition], message, variant) for variant in message.layout.variants]
            self._forms[edition, message] = own
        return self._forms[edition, message]


class ScoredForm:
    """A message under one variant of its layout."""

    def __init__(self, edition: Edition, message: Message, variant: Variant) -> None:
        self.checks: list[Check] = []
        self._message = message
        keys = data_bits((key.space, key.segments) for key in message.keys)
        fields = data_bits((f.space, e.segments) for f in variant.fields for e in f.elements)
        self.used = keys | fields
        is_request = message.direction is Direction.REQUEST
        self._is_of_host = is_request or edition.command(message.command).is_echoed
        where = f"{message.direction.value} of {message.command}" + (reply_rule(edition, message) if is_request else "")
        for at in range(message.dlc):
            mask = ~(keys | fields) >> at * 8 & 0xFF
            if mask:
                self.checks.append(reserved_check(at, mask, where))
        for field in variant.fields:
            self.checks += field_checks(field, where, is_request=is_request)

    def interpret(self, id_: int, data: int) -> Interpretation:
        """A frame as this message, with the reasons against it."""
        checked = (check.reason(bits_at(check.parts, id_ if check.in_id else data)) for check in self.checks)
        reasons = tuple(reason for reason in checked if reason)
        return Interpretation(self._message.name, self._message, reasons, is_of_host=self._is_of_host)


def reply_rule(edition: Edition, message: Message) -> str:
    """The id rule of the reply to a request, as text; empty if both have the same ids."""
    reply = edition.command(message.command).reply
    if reply is None or reply.id == message.id or reply.id.nodes is None:
        return ""
    return f"; expected replies on {formatting.id_rule(reply.id)}"
