"""How the host, the nodes and the recorder of a bus behave, as far as the first frames of a log show it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from ..model.message import Command, Direction, Message
from ..semantics.frame import CanFrame


if TYPE_CHECKING:
    from .directions import Judged

LOOKED_AHEAD = 1 << 14
"""The number of frames at the start of a log from which the behaviour is learned."""
LONGEST = 100_000_000
"""The maximum time in ns after which a reply is searched for while the reply time of a log is learned."""
COPIED_WITHIN = 3_000_000
"""The maximum time in ns from a frame to its copy: the host hands it to the driver, and later it is on the bus."""
_LEAST = 8
"""The number of cases from which a share is taken."""
_CARELESS = 32
"""A host is careless if one frame in so many, or more, looks like a reply and is followed soon by one without a request."""


class Behaviour(NamedTuple):
    """The behaviour on a bus.

    `is_marked` if marks distinguish requests and replies; `copied` are the directions in which each frame is recorded
    twice; `careless` the requests whose reserved bits the host does not clear; `reply_time` the time in ns within which
    nine of ten replies come, None if unknown.
    """

    is_marked: bool = False
    copied: frozenset[Direction] = frozenset()
    careless: frozenset[Message] = frozenset()
    reply_time: int | None = None


def observe(judged: Iterable[Judged], known: Mapping[str, Behaviour]) -> dict[str, Behaviour]:
    """The behaviour on each bus, by the results for the first frames that follow from what is known of it."""
    buses: dict[str, _Observed] = {}
    for one in judged:
        if one.edition is not None:
            buses.setdefault(one.recorded.bus, _Observed()).add(one)
    return {bus: observed.behaviour(known.get(bus, Behaviour())) for bus, observed in buses.items()}


class _Run(NamedTuple):
    """Equal frames of a node, one soon after the other."""

    frame: CanFrame
    direction: Direction | None
    time: int
    length: int


class _Orphan(NamedTuple):
    """The last reply of a command of a node: the pause before it, and whether it answers no request."""

    time: int
    pause: int
    is_orphan: bool


@dataclass
class _Observed:
    """What the frames of a bus show so far."""

    runs: Counter[Direction] = field(default_factory=Counter)
    pairs: Counter[Direction] = field(default_factory=Counter)
    """Of the runs, those with two frames for each."""
    replies: Counter[Message] = field(default_factory=Counter)
    """Replies by content, by the request of the command."""
    careless: Counter[Message] = field(default_factory=Counter)
    """Of them, those that follow another soon, neither with a request: the first is a request."""
    latencies: list[int] = field(default_factory=list)
    _open: dict[int | None, _Run] = field(default_factory=dict)
    _last: dict[tuple[int | None, Message], _Orphan] = field(default_factory=dict)

    def add(self, judged: Judged) -> None:
        """Counts the next frame."""
        assert judged.edition is not None
        time = judged.recorded.time
        if time is None or judged.message is None:
            self._open.pop(judged.node, None)
            return
        command = judged.edition.command(judged.message.command)
        if judged.decided_by != "copy":
            self._extend_run(judged, time, command)
            if judged.direction is Direction.REPLY:
                self._add_reply(judged, time, command)

    def _extend_run(self, judged: Judged, time: int, command: Command) -> None:
        run = self._open.pop(judged.node, None)
        frame = judged.recorded.frame
        is_same = run is not None and run.frame == frame and 0 <= time - run.time <= COPIED_WITHIN
        if run is not None and is_same:
            self._open[judged.node] = run._replace(time=time, length=run.length + 1)
            return
        if run is not None and run.direction is not None:
            self.runs[run.direction] += 1
            self.pairs[run.direction] += run.length % 2 == 0
        if not command.is_echoed:
            self._open[judged.node] = _Run(frame, judged.direction, time, 1)

    def _add_reply(self, judged: Judged, time: int, command: Command) -> None:
        is_certain = judged.decided_by in ("content", "id", "mark") and not command.from_each
        if judged.latency is not None and is_certain and command.reply_within_ms is None:
            self.latencies.append(judged.latency)
        if judged.decided_by != "content" or command.request is None:
            return
        key = judged.node, command.request
        before = self._last.get(key, _Orphan(time - LONGEST, 0, False))
        pause, is_orphan = time - before.time, judged.request is None
        self.replies[command.request] += 1
        if is_orphan and before.is_orphan and 0 < 2 * pause < before.pause:
            self.careless[command.request] += 1
            self.latencies.append(pause)
            is_orphan = False
        self._last[key] = _Orphan(time, pause, is_orphan)

    def behaviour(self, known: Behaviour) -> Behaviour:
        """The behaviour, with everything known before."""
        return known._replace(
            copied=known.copied | self._copied(), careless=known.careless | self._careless(), reply_time=self._reply_time()
        )

    def _copied(self) -> frozenset[Direction]:
        request, reply = Direction.REQUEST, Direction.REPLY
        found = set()
        # Of a careless host, requests look like replies: then half of all runs are pairs.
        if _is_share(self.pairs[request], self.runs[request], 1, 2) or _is_share(
            self.pairs.total(), self.runs.total(), 1, 4
        ):
            found.add(request)
        if _is_share(self.pairs[reply], self.runs[reply], 3, 4):
            found.add(reply)
        return frozenset(found)

    def _careless(self) -> frozenset[Message]:
        """A request with few frames counts as the others of its bus."""
        is_bus = _is_share(self.careless.total(), self.replies.total(), 1, _CARELESS)
        return frozenset(
            request
            for request, count in self.replies.items()
            if (_is_share(self.careless[request], count, 1, _CARELESS) if count >= _LEAST else is_bus)
        )

    def _reply_time(self) -> int | None:
        ordered = sorted(self.latencies)
        return ordered[len(ordered) * 9 // 10] if len(ordered) >= _LEAST else None


def _is_share(count: int, of: int, numerator: int, denominator: int) -> bool:
    return of >= _LEAST and count * denominator >= of * numerator


