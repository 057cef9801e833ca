"""The summary of a log by node: missing, late, unexpected and rejected frames."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from ..model.edition import Edition
from ..model.message import Command, Direction
from ..model.refusal import Refusal
from ..semantics.decoder import Rejection
from ..semantics.frame import CanFrame
from .directions import DecidedBy, DirectedFrame
from .rows import Cell, Row

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
    """The values of a field outside its plausible range, with the first of them."""

    example: Cell
    frame: CanFrame
    count: int = 0


@dataclass
class NodeSummary:
    """The frames of a node on a bus.

    `missing` are requests that were not answered, `late` replies long after most others, `unexpected` replies without a
    request, `copies` frames that were recorded again, `rejected` frames that are no message of their direction,
    `implausible` values by field. Latencies are in ns. `labels` name the editions that fit, `commands` those of the frames.
    """

    editions: dict[Edition, None] = field(default_factory=dict)
    labels: dict[str, None] = field(default_factory=dict)
    commands: dict[str, None] = field(default_factory=dict)
    requests: int = 0
    replies: int = 0
    missing: int = 0
    late: int = 0
    unexpected: int = 0
    copies: int = 0
    rejected: dict[Refusal, RejectedFrames] = field(default_factory=dict)
    implausible: dict[str, ImplausibleValues] = field(default_factory=dict)
    decided: Counter[DecidedBy] = field(default_factory=Counter)
    without: dict[str, None] = field(default_factory=dict)
    """Parameters that are not given, so that values are missing."""
    timed: int = 0
    latency: int = 0
    longest: int = 0

    @property
    def frames(self) -> int:
        return self.decided.total()

    @property
    def mean_latency(self) -> int | None:
        return self.latency // self.timed if self.timed else None


@dataclass
class _Waiting:
    """A request that waits for its replies."""

    bus: str
    node: int | None
    command: Command
    replied: set[int | None] = field(default_factory=set)


class Summary:
    """Counts rows. Memory does not grow with the log."""

    def __init__(self) -> None:
        self.nodes: dict[tuple[str, int | None], NodeSummary] = {}
        self.foreign: Counter[tuple[int, bool, bool]] = Counter()
        """Frames whose id has no message, by id; later ids of very many are counted as `other_foreign`.

        An id is a number, whether it has 29 bits, and whether the frame is remote."""
        self.other_foreign = 0
        self._waiting: dict[int, _Waiting] = {}

    @property
    def has_implausible(self) -> bool:
        """Whether values are outside the plausible ranges."""
        return any(node.implausible for node in self.nodes.values())

    def add(self, row: Row) -> None:
        """Counts a row."""
        judged = row.judged
        frame = judged.recorded.frame
        if judged.edition is None:
            id_ = frame.id, frame.extended, frame.remote
            if id_ in self.foreign or len(self.foreign) < _MAX_FOREIGN:
                self.foreign[id_] += 1
            else:
                self.other_foreign += 1
            return
        node = self._node(judged.recorded.bus, judged.node)
        node.editions[judged.edition] = None
        node.labels[row.edition] = None
        if judged.message is not None:
            node.commands[judged.edition.command(judged.message.command).spec_name] = None
        node.decided[judged.decided_by] += 1
        for name in row.missing:
            node.without[name] = None
        if judged.decided_by is DecidedBy.COPY:
            node.copies += 1
            return
        for cell in row.implausible:
            known_values = node.implausible.setdefault(cell.column.name, ImplausibleValues(cell, frame))
            known_values.count += 1
        node.requests += judged.direction is Direction.REQUEST
        node.replies += judged.direction is Direction.REPLY
        if judged.rejection is not None:
            reason = judged.rejection.reason
            known = node.rejected.setdefault(reason, RejectedFrames(judged.rejection, frame))
            known.count += 1
        elif judged.direction is Direction.REQUEST:
            self._request(judged, judged.edition)
        else:
            self._reply(node, judged, judged.edition)

    def finish(self) -> None:
        """Counts the requests that still wait as missing."""
        for waiting in self._waiting.values():
            self._count_missing(waiting)
        self._waiting.clear()

    def _node(self, bus: str, node: int | None) -> NodeSummary:
        known = self.nodes.get((bus, node))
        if known is None:
            known = self.nodes[bus, node] = NodeSummary()
        return known

    def _request(self, judged: DirectedFrame, edition: Edition) -> None:
        assert judged.message is not None
        command = edition.command(judged.message.command)
        if not command.replies:
            return
        self._waiting[judged.number] = _Waiting(judged.recorded.bus, judged.node, command)
        if len(self._waiting) > _MAX_WAITING:
            self._count_missing(self._waiting.pop(next(iter(self._waiting))))

    def _reply(self, node: NodeSummary, judged: DirectedFrame, edition: Edition) -> None:
        assert judged.message is not None
        if judged.request is None:
            node.unexpected += edition.command(judged.message.command).request is not None
            return
        waiting = self._waiting.get(judged.request)
        if waiting is not None:
            waiting.replied.add(judged.node)
            if len(waiting.replied) >= max(1, len(waiting.command.from_each)):
                del self._waiting[judged.request]
        node.late += judged.is_late
        if judged.latency is not None:
            node.timed += 1
            node.latency += judged.latency
            node.longest = max(node.longest, judged.latency)

    def _count_missing(self, waiting: _Waiting) -> None:
        """Of a broadcast, only nodes with frames in the log count."""
        if not waiting.command.from_each:
            self._node(waiting.bus, waiting.node).missing += not waiting.replied
            return
        for node in waiting.command.from_each:
            if (waiting.bus, node) in self.nodes and node not in waiting.replied:
                self.nodes[waiting.bus, node].missing += 1
