"""The frames of a node, decoded under one edition as `decode` does, and what speaks against that edition."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..semantics.exchange import repeats_request
from ..semantics.frame import CanFrame, has_id_rule
from ..semantics.plan import MaskedBits, message_plan
from .directions import DecidedBy, DirectedFrame, Directions
from .frame_classes import frame_classes
from .log_frame import LogFrame
from .rows import MAX_FORMS, Row, RowForm, RowReader

WEAK = 1
"""Unusual: a reserved bit that is set, a name or a raw integer that the spec does not list."""
STRONG = 3
"""Not in this edition: an id, a code, a length, a constant; or a value that no working node reports."""


LEARNED = 1 << 9
"""The number of frames of a node from which the behaviour of its bus is learned."""


class Reason(NamedTuple):
    """A reason against an edition, with its points."""

    points: int
    text: str


class Reading(NamedTuple):
    """A frame under an edition; `name` is that of its message.

    What the host chose has no reasons: it leaves reserved bits uncleared, exceeds ranges, and nodes echo that.
    """

    name: str
    is_request: bool = False
    is_rejected: bool = False
    reasons: tuple[Reason, ...] = ()

    @property
    def points(self) -> int:
        return sum(points for points, _ in self.reasons)


class Readings(NamedTuple):
    """The frames of a node under an edition, in their order.

    `requests` are those that have a reply in this edition, with their commands, by position; `asked` has the position of
    the request by that of each reply.
    """

    frames: Sequence[Reading]
    requests: dict[int, str]
    asked: dict[int, int]


Check = Callable[[Row], Reason | None]


class EditionReader:
    """Reads the frames of nodes under an edition; `recorder` is the direction of frames that are marked as sent."""

    def __init__(
        self, edition: Edition, family: Sequence[Edition], recorder: Direction | None, window: int | None
    ) -> None:
        self.edition = edition
        self._family = family
        self._recorder = recorder
        self._window = window
        self._rows = RowReader(lambda bus, node: {})
        self._known: dict[RowForm, tuple[Reading, Sequence[Check]]] = {}
        self._rejected: dict[tuple[object, ...], Reading] = {}

    def read(self, runs: Sequence[Sequence[LogFrame]]) -> Readings:
        """The frames of a node; no frame is missing within a run."""
        frames: list[Reading] = []
        requests: dict[int, str] = {}
        asked: dict[int, int] = {}
        by_id: dict[int, Reason] = {}
        """Reasons against requests without a reply, if only requests have their ids: other editions have replies there."""
        echoes = unrequested = 0
        listed = [frame for run in runs for frame in run]
        for row in self._rows.rows(self._directed(runs, listed)):
            judged = row.judged
            frames.append(self._reading(row))
            if judged.message is None or judged.decided_by is DecidedBy.COPY:
                continue
            command = self.edition.command(judged.message.command)
            if judged.request is not None:
                is_equal = judged.recorded.frame == listed[judged.request].frame
                if not is_equal or repeats_request(command) or judged.decided_by is not DecidedBy.PAIRING:
                    asked[judged.number] = judged.request  # else it may be the request again
            elif judged.direction is Direction.REPLY:
                unrequested += command.only_answers
            elif command.reply is not None and (judged.node is not None or command.reply.id.nodes is None):
                requests[judged.number] = command.name
                echoes += command.is_echoed
                if judged.decided_by is DecidedBy.ID:
                    by_id[judged.number] = self._expecting(judged.message, command.reply)
        answered = set(asked.values())
        for at in by_id.keys() - answered:
            frames[at] = frames[at]._replace(reasons=(by_id[at],))
        if unrequested > max(len(answered), (len(requests) - echoes) // 2):
            # The recorder does not see requests: what can be a reply too is none.
            classes = frame_classes(self.edition)
            requests = {
                at: name for at, name in requests.items() if at in answered or not classes.of(listed[at].frame).replies
            }
        return Readings(frames, requests, asked)

    @staticmethod
    @functools.lru_cache(maxsize=1 << 10)
    def _expecting(request: Message, reply: Message) -> Reason:
        """The reason against a request without a reply, if its frame is a reply in other editions."""
        where, expected = formatting.id_rule(request.id), formatting.id_rule(reply.id)
        return Reason(STRONG, f"{where} has a reply of {request.command}; expected replies on {expected}")

    def _directed(self, runs: Sequence[Sequence[LogFrame]], listed: Sequence[LogFrame]) -> Iterator[DirectedFrame]:
        behaviours = Directions({}, self.edition, window=self._window, recorder=self._recorder).learn(listed[:LEARNED])
        slowest = max((own.slowest for own in behaviours.values() if own.slowest), default=None)
        directions = Directions(
            {}, self.edition, window=slowest or self._window, recorder=self._recorder, behaviours=behaviours
        )
        for run in runs:
            yield from directions.classify(run)
            directions.forget(run[0].bus)

    def _reading(self, row: Row) -> Reading:
        judged, form = row.judged, row.form
        if judged.message is None and judged.decided_by is not DecidedBy.COPY:
            return self._rejection(judged)
        if form not in self._known:
            if len(self._known) >= MAX_FORMS:
                self._known.clear()
            self._known[form] = self._form(form)
        reading, checks = self._known[form]
        reasons = tuple([reason for check in checks if (reason := check(row))])
        return reading._replace(reasons=reasons) if reasons else reading

    def _form(self, form: RowForm) -> tuple[Reading, Sequence[Check]]:
        """The reading of regular frames of a form, and the checks of others."""
        if (
            form.message is None or form.direction is Direction.REQUEST
        ):  # no message: a copy with a mark of the wrong direction
            return Reading(form.message.name if form.message else "", is_request=True), ()
        is_of_host = self.edition.command(form.message.command).is_echoed or form.decided_by is DecidedBy.COPY
        return Reading(form.message.name), [] if is_of_host else [*_checks(form)]

    def _rejection(self, judged: DirectedFrame) -> Reading:
        """The reading of a frame that is no message of this edition."""
        frame = judged.recorded.frame
        known = (*frame[:1], *frame[2:], frame.data[:1], len(frame.data), judged.direction, judged.rejection)
        if known not in self._rejected:
            if len(self._rejected) >= MAX_FORMS:
                self._rejected.clear()
            text = self._text(judged, frame)
            self._rejected[known] = Reading(text, is_rejected=True, reasons=(Reason(STRONG, text),))
        return self._rejected[known]

    def _text(self, judged: DirectedFrame, frame: CanFrame) -> str:
        messages = (message for edition in self._family for message in edition.all_messages())
        where = formatting.id_rule(next(message.id for message in messages if has_id_rule(message, frame)))
        if judged.edition is None:
            return f"{where} is not an id of this edition"
        if judged.rejection is not None and judged.rejection.reason not in (
            Refusal.UNKNOWN_CODE,
            Refusal.UNKNOWN_ID,
            Refusal.WRONG_LENGTH,
        ):
            return f"{where}: {judged.rejection.text}"
        kind = judged.direction.value if judged.direction else "frame"
        start = f" that starts with {frame.data[:1].hex().upper()}" if frame.data else ""
        return f"no {kind} of {formatting.counted(len(frame.data), 'byte')}{start} on {where}"


def _checks(form: RowForm) -> Iterator[Check]:
    """The checks of a reply."""
    assert form.message is not None
    where = f"reply of {form.message.command}"
    reserved = message_plan(form.message).reserved
    if reserved.mask:
        reason = Reason(WEAK, f"{where}: reserved bits are not 0")
        yield functools.partial(_with_reserved, reserved, reason)
    for at, column in enumerate(form.columns):
        type_ = column.field.type
        if type_.enum:
            reason = Reason(WEAK, f"{where}: `{column.name}` has a value without a name")
            yield functools.partial(_without_name, 2 * at + 1, reason)
        if type_.flags:
            named = sum(1 << flag.value for flag in type_.flags)
            reason = Reason(WEAK, f"{where}: `{column.name}` has bits without a name")
            yield functools.partial(_with_unnamed_bits, 2 * at, ~named, reason)
    if form.limits:
        yield functools.partial(_out_of_range, where)


def _with_reserved(reserved: MaskedBits, reason: Reason, row: Row) -> Reason | None:
    bits = int.from_bytes(row.judged.recorded.frame.data, "little") & reserved.mask
    return None if bits == reserved.value else reason


def _without_name(at: int, reason: Reason, row: Row) -> Reason | None:
    return reason if row.fields[at] is None else None


def _with_unnamed_bits(at: int, unnamed: int, reason: Reason, row: Row) -> Reason | None:
    return reason if row.fields[at] & unnamed else None


def _out_of_range(where: str, row: Row) -> Reason | None:
    """The strongest reason of the values that are outside a range of their type."""
    reasons = []
    for at, limits in row.implausible:
        column = row.form.columns[at]
        is_possible = column.field.type.is_plausible(row.fields[2 * at + 1])
        kind = "" if is_possible else "the plausible range "
        reasons.append(Reason(WEAK if is_possible else STRONG, f"{where}: `{column.name}` is outside {kind}{limits}"))
    return max(reasons, default=None)
