"""The summary of a log by node: missing, late, unexpected and rejected frames."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

from ..model.edition import Edition
from ..model.message import Command, Direction, Message
from ..model.refusal import Refusal
from ..semantics.decoder import Rejection
from ..semantics.exchange import repeats_request
from ..semantics.frame import CanFrame
from .directions import DecidedBy, DirectedFrame
from .effects import FormEffects, NodeEffects, form_effects
from .frame_classes import SOON
from .gaps import CounterGaps, Periods
from .log_frame import new_tuple
from .rows import MAX_FORMS, Cell, Row, RowForm

_MAX_WAITING = 1 << 16
"""The maximum number of requests that wait for their replies; more than ever have an open exchange."""
_MAX_FOREIGN = 1 << 10
"""The maximum number of foreign ids that are listed."""


@dataclass
class RejectedFrames:
    """The frames that were rejected for one reason, with the first of them."""

    rejection: Rejection
    example: CanFrame
    count: int = 0


@dataclass
class ImplausibleValues:
    """The values of a field outside its plausible or its raw range, with the first of them."""

    limits: str
    example: Cell
    frame: CanFrame
    count: int = 0


@dataclass
class NodeSummary:
    """The frames of a node on a bus.

    `missing` are requests that were not answered, `repeated` those that have the bytes of the request before, also without a
    reply, and can be its reply, `late` replies long after most others, `unexpected` replies without a request, `paired` those of them
    that follow another one as soon as a reply follows its request, `answered_by_others` replies of other nodes to its requests, `copies` frames that were recorded again, `rejected` frames that are no message of their direction,
    `implausible` values by field and range. Latencies are in ns. `labels` name the editions that fit, `commands` those of the frames.
    """

    editions: dict[Edition, None] = field(default_factory=dict)
    labels: dict[str, None] = field(default_factory=dict)
    commands: dict[str, None] = field(default_factory=dict)
    requests: int = 0
    replies: int = 0
    missing: int = 0
    repeated: int = 0
    late: int = 0
    unexpected: int = 0
    paired: int = 0
    answered_by_others: int = 0
    rejected: dict[Refusal, RejectedFrames] = field(default_factory=dict)
    implausible: dict[tuple[str, str], ImplausibleValues] = field(default_factory=dict)
    decided: Counter[DecidedBy] = field(default_factory=Counter)
    without: dict[str, None] = field(default_factory=dict)
    """Parameters that are not given, so that values are missing."""
    periods: dict[Message, Periods] = field(default_factory=dict)
    """The gaps between frames that have a period or a time-out, by message."""
    counters: dict[tuple[Message, str], CounterGaps] = field(default_factory=dict)
    """The gaps between the values of counters, by message and column."""
    asked: DirectedFrame | None = None
    """The last request; None if it repeats the one before."""
    unasked: DirectedFrame | None = None
    """The last reply without a request; None if it is paired."""
    timed: int = 0
    latency: int = 0
    longest: int = 0

    @property
    def frames(self) -> int:
        return self.decided.total()

    @property
    def copies(self) -> int:
        return self.decided[DecidedBy.COPY]

    @property
    def mean_latency(self) -> int | None:
        return self.latency // self.timed if self.timed else None


class _Counted:
    """The frames of one form of rows, counted, and the node, the command and the effects that they belong to."""

    __slots__ = ("command", "count", "effects", "node")

    def __init__(self, node: NodeSummary, command: Command | None, effects: FormEffects | None) -> None:
        self.node = node
        self.command = command
        self.effects = effects
        self.count = 0


class _Waiting(NamedTuple):
    """A request that waits for its replies, the nodes that have replied, and whether it repeats one without a reply."""

    request: _Counted
    bus: str
    replied: set[int | None]
    is_repeated: bool


class Summary:
    """Counts rows. Memory does not grow with the log."""

    def __init__(self) -> None:
        self.nodes: dict[tuple[str, int | None], NodeSummary] = {}
        self.effects: dict[tuple[str, int | None], NodeEffects] = {}
        """The effects of requests, also on nodes without frames in the log."""
        self.foreign: Counter[tuple[int, bool, bool]] = Counter()
        """Frames whose id has no message, by id; later ids of very many are counted as `other_foreign`.

        An id is a number, whether it has 29 bits, and whether the frame is remote."""
        self.other_foreign = 0
        self.foreign_examples: dict[tuple[int, bool, bool], CanFrame] = {}
        """The first foreign frame of each listed id."""
        self._forms: dict[RowForm, _Counted] = {}
        self._waiting: dict[int, _Waiting] = {}
        self._end: dict[str, int] = {}
        """The time of the last frame of each bus."""

    @property
    def has_implausible(self) -> bool:
        """Whether values are outside the plausible ranges."""
        return any(node.implausible for node in self.nodes.values())

    def add(self, row: Row) -> None:
        """Counts a row."""
        judged, form, _, implausible = row
        time, bus, frame, _ = judged.recorded
        if time is not None:
            self._end[bus] = time
        if form.edition is None:
            self._add_foreign(frame)
            return
        counted = self._forms.get(form) or self._counted(form, form.edition)
        counted.count += 1
        if form.decided_by is DecidedBy.COPY:
            return
        node, message = counted.node, form.message
        if message is None:
            if judged.rejection is not None:
                known = node.rejected.setdefault(judged.rejection.reason, RejectedFrames(judged.rejection, frame))
                known.count += 1
            return
        sending = message.sending
        if time is not None and sending is not None and (sending.every_ms or sending.timeout_ms):
            node.periods.setdefault(message, Periods(sending)).add(judged.number, time)
        for at, role in form.counters:
            node.counters.setdefault((message, form.columns[at].name), CounterGaps(role)).add(row.fields[2 * at])
        if implausible:
            self._add_implausible(node, row)
        if form.direction is Direction.REQUEST:
            self._request(counted, judged)
            if counted.effects is not None:
                self._add_effects(counted.effects, row)
        else:
            self._reply(counted, judged)

    def _add_foreign(self, frame: CanFrame) -> None:
        id_ = frame.id, frame.extended, frame.remote
        if id_ in self.foreign or len(self.foreign) < _MAX_FOREIGN:
            self.foreign[id_] += 1
            self.foreign_examples.setdefault(id_, frame)
        else:
            self.other_foreign += 1

    def _counted(self, form: RowForm, edition: Edition) -> _Counted:
        """The count of a form of rows; its node has an edition and a command from its first frame on."""
        if len(self._forms) >= MAX_FORMS:
            self._add_counts()
        node = self._node(form.bus, form.node)
        node.editions[edition] = None
        node.labels[form.label] = None
        command = edition.command(form.message.command) if form.message else None
        if command is not None:
            node.commands[command.spec_name] = None
        for name in form.missing:
            node.without[name] = None
        counted = self._forms[form] = _Counted(node, command, form_effects(form, command))
        return counted

    def _add_counts(self) -> None:
        """Adds the counts of forms to their nodes."""
        for form, counted in self._forms.items():
            counted.node.decided[form.decided_by] += counted.count
            if form.decided_by is not DecidedBy.COPY:
                counted.node.requests += counted.count * (form.direction is Direction.REQUEST)
                counted.node.replies += counted.count * (form.direction is Direction.REPLY)
        self._forms.clear()

    def finish(self) -> None:
        """Completes the counts: requests that still wait are missing, and messages are silent until the end of the log."""
        self._add_counts()
        for (bus, _), node in self.nodes.items():
            for periods in node.periods.values():
                periods.add(None, self._end[bus])
        for waiting in self._waiting.values():
            self._count_missing(waiting)
        self._waiting.clear()

    def _node(self, bus: str, node: int | None) -> NodeSummary:
        known = self.nodes.get((bus, node))
        if known is None:
            known = self.nodes[bus, node] = NodeSummary()
        return known

    def _add_implausible(self, node: NodeSummary, row: Row) -> None:
        cells, frame = [*row.cells], row.judged.recorded.frame
        for at, limits in row.implausible:
            key = cells[at].column.name, limits
            known = node.implausible.setdefault(key, ImplausibleValues(limits, cells[at], frame))
            known.count += 1

    def _add_effects(self, effects: FormEffects, row: Row) -> None:
        """Of a broadcast, the effects are those on each node that replies to it."""
        for node in effects.command.from_each or (row.form.node,):
            place = row.form.bus, node
            if place not in self.effects:
                self.effects[place] = NodeEffects()
            self.effects[place].add(effects, row.fields, row.judged.number)

    def _request(self, counted: _Counted, judged: DirectedFrame) -> None:
        assert counted.command is not None
        if not counted.command.replies:
            return
        node, before = counted.node, counted.node.asked
        is_repeated = (
            before is not None
            and before.number in self._waiting
            and before.recorded.frame == judged.recorded.frame
            and repeats_request(counted.command)
        )
        node.asked = None if is_repeated else judged
        self._waiting[judged.number] = new_tuple(_Waiting, (counted, judged.recorded.bus, set(), is_repeated))
        if len(self._waiting) > _MAX_WAITING:
            self._count_missing(self._waiting.pop(next(iter(self._waiting))))

    def _reply(self, counted: _Counted, judged: DirectedFrame) -> None:
        assert counted.command is not None
        node = counted.node
        if judged.request is None:
            node.unexpected += counted.command.only_answers
            is_paired = node.unasked is not None and _is_soon(node.unasked, judged)
            node.paired += is_paired
            node.unasked = None if is_paired else judged
            return
        waiting = self._waiting.get(judged.request)
        if waiting is not None:
            assert waiting.request.command is not None
            waiting.replied.add(judged.node)
            waiting.request.node.answered_by_others += bool(waiting.request.command.from_each)
            if len(waiting.replied) >= max(1, len(waiting.request.command.from_each)):
                del self._waiting[judged.request]
        node.late += judged.is_late
        if judged.latency is not None:
            node.timed += 1
            node.latency += judged.latency
            node.longest = max(node.longest, judged.latency)

    def _count_missing(self, waiting: _Waiting) -> None:
        """Of a broadcast, only nodes with frames in the log count."""
        assert waiting.request.command is not None
        if not waiting.request.command.from_each:
            waiting.request.node.missing += not waiting.replied
            waiting.request.node.repeated += waiting.is_repeated and not waiting.replied
            return
        for node in waiting.request.command.from_each:
            if (waiting.bus, node) in self.nodes and node not in waiting.replied:
                self.nodes[waiting.bus, node].missing += 1


def _is_soon(before: DirectedFrame, judged: DirectedFrame) -> bool:
    """Whether a frame follows another one of its message as soon as a reply follows its request."""
    start, end = before.recorded.time, judged.recorded.time
    if start is None or end is None or before.message is not judged.message:
        return False
    return 0 <= end - start < SOON
