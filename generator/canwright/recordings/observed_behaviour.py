"""Learns the behaviour on a bus from the directions that follow if nothing is known of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from ..model.message import Command, Direction, Message
from ..semantics.exchange import repeats_request
from ..semantics.frame import CanFrame
from .bus_behaviour import COPIED_WITHIN, Behaviour, OldBits
from .frame_classes import form_of

if TYPE_CHECKING:
    from .directions import DirectedFrame

_LONG = 1_000_000_000
"""A pause in ns before which nothing counts."""
_LEAST = 8
"""The number of cases from which a share is taken."""
_RESOLUTIONS = tuple(int(10**power) for power in range(8, -1, -1))
_RARE = 32
"""Reserved bits of a request are old if it is followed by its reply as if both were replies, once in so many or more."""


def observe(judged: Iterable[DirectedFrame]) -> dict[str, Observed]:
    """What the first frames of a log show of each bus."""
    buses: dict[str, Observed] = {}
    for directed in judged:
        if directed.edition is not None:
            bus = directed.recorded.bus
            if bus not in buses:
                buses[bus] = Observed()
            buses[bus].add(directed)
    return buses


def _is_share(count: int, of: int, numerator: int, denominator: int) -> bool:
    return of >= _LEAST and count * denominator >= of * numerator


class _Run(NamedTuple):
    """Equal frames of a node, one soon after the other."""

    frame: CanFrame
    direction: Direction | None
    time: int
    length: int


@dataclass
class _Copies:
    """Counts runs of equal frames, and how many have two frames for each."""

    runs: Counter[Direction] = field(default_factory=Counter)
    pairs: Counter[Direction] = field(default_factory=Counter)
    _open: dict[int | None, _Run] = field(default_factory=dict)

    def add(self, judged: DirectedFrame, time: int, command: Command | None) -> None:
        """Counts the next frame; a rejected one has no command: it can be the copy of a request that is marked as received."""
        run = self._open.pop(judged.node, None)
        frame = judged.recorded.frame
        if run is not None and run.frame == frame and 0 <= time - run.time <= COPIED_WITHIN:
            self._open[judged.node] = run._replace(time=time, length=run.length + 1)
            return
        if run is not None and run.direction is not None:
            self.runs[run.direction] += 1
            self.pairs[run.direction] += run.length % 2 == 0
        if command is not None and not repeats_request(command):
            self._open[judged.node] = _Run(frame, judged.direction, time, 1)

    def directions(self, *, is_marked: bool) -> frozenset[Direction]:
        """The directions in which frames are recorded twice, on a bus where marks decide on directions, or not."""
        request, reply = Direction.REQUEST, Direction.REPLY
        copied = set()
        # Requests with old bits look like replies without marks: then half of all runs are pairs.
        is_most = _is_share(self.pairs[request], self.runs[request], 3, 4)
        if is_most or (not is_marked and _is_share(self.pairs.total(), self.runs.total(), 3, 8)):
            copied.add(request)
        if _is_share(self.pairs[reply], self.runs[reply], 3, 4):
            copied.add(reply)
        return frozenset(copied)


class _Reply(NamedTuple):
    """A frame that looks like a reply: its time, the pause before it, its reserved bits, and whether it has no request."""

    time: int
    pause: int
    bits: int
    is_orphan: bool
    is_second: bool
    """Whether it is the second of a pair."""


@dataclass
class _Replies:
    """The frames of a command that look like replies, because they set bits that its request reserves.

    Those without a request are `orphans`, with their bits. Two in a row can be a request with old bits and its reply, which
    has other bits, or the same if it `is_echoed`. `changes` counts them by the bits of the first. Of `pairs`, the second
    follows soon, after one of `times`; `seconds` are its bits.
    """

    is_echoed: bool
    count: int = 0
    orphans: int = 0
    times: list[int] = field(default_factory=list)
    bits: Counter[int] = field(default_factory=Counter)
    changes: Counter[int] = field(default_factory=Counter)
    seconds: Counter[int] = field(default_factory=Counter)
    _last: dict[int | None, _Reply] = field(default_factory=dict)

    @property
    def pairs(self) -> int:
        return len(self.times)

    def add(self, node: int | None, time: int, bits: int, *, is_orphan: bool) -> None:
        before = self._last.get(node, _Reply(time - _LONG, 0, 0, False, False))
        pause = time - before.time
        self.count += 1
        self.orphans += is_orphan
        is_change = is_orphan and before.is_orphan and (bits == before.bits) is self.is_echoed
        if is_orphan:
            self.bits[bits] += 1
            self.changes[before.bits] += is_change
        is_second = is_change and not before.is_second and 0 < 2 * pause < before.pause
        if is_second:
            self.times.append(pause)
            self.seconds[bits] += 1
        self._last[node] = _Reply(time, pause, bits, is_orphan, is_second)


class Observed:
    """What the frames of a bus show so far. Of the `replies` to requests, `unexpected` ones have none in the log.

    `requests` have a reply that is no echo: an echo in a log without requests looks like a request.
    """

    def __init__(self) -> None:
        self.requests = 0
        self.replies = 0
        self.unexpected = 0
        self._certain = 0
        self._copies = _Copies()
        self._of_request: dict[Message, _Replies] = {}
        self._latencies: list[int] = []
        self._times = 0
        """The largest number of ns that divides all times."""
        self._masks: dict[tuple[Message, int], int] = {}

    @property
    def is_plausible(self) -> bool:
        """Whether few replies are unexpected."""
        return 16 * self.unexpected <= self.replies

    @property
    def only(self) -> Direction | None:
        """The direction of all frames, if the log lacks those of the other.

        Nearly all frames are replies without a request, and few follow another one soon as after a request with old bits;
        or most requests are not answered, and no frame can only be a reply.
        """
        answered = self.replies - self.unexpected
        if self.unexpected >= _LEAST and self.unexpected > 4 * max(self.requests, answered):
            pairs = sum(replies.pairs for replies in self._of_request.values())
            return Direction.REPLY if 3 * pairs < self.unexpected else None
        return (
            Direction.REQUEST
            if self.requests >= _LEAST and self.requests > 2 * answered and not self._certain
            else None
        )

    @property
    def resolution(self) -> int:
        """The resolution of the times: the largest power of ten that divides all, at most 0.1 s."""
        return next(power for power in _RESOLUTIONS if self._times % power == 0)

    def add(self, judged: DirectedFrame) -> None:
        """Counts the next frame."""
        assert judged.edition is not None
        if judged.decided_by == "copy":
            return
        time = judged.recorded.time
        command = None if judged.message is None else judged.edition.command(judged.message.command)
        self._copies.add(judged, 0 if time is None else time, command)
        if command is None:
            return
        is_certain = judged.decided_by in ("content", "id", "mark")
        if judged.direction is Direction.REQUEST:
            self.requests += command.reply is not None and not command.is_echoed
        else:
            self.replies += command.only_answers
            self.unexpected += command.only_answers and judged.request is None
            self._certain += is_certain
        if time is None:
            return
        self._times = math.gcd(self._times, time)
        if judged.direction is not Direction.REPLY:
            return
        is_single = not command.from_each and command.reply_frames <= 1
        if judged.latency is not None and is_certain and is_single and command.reply_within_ms is None:
            self._latencies.append(judged.latency)
        if judged.decided_by == "content" and command.request is not None:
            bits = self._reserved_bits(command.request, judged.recorded.frame)
            if command.request not in self._of_request:
                self._of_request[command.request] = _Replies(command.is_echoed)
            replies = self._of_request[command.request]
            replies.add(judged.node, time, bits, is_orphan=judged.request is None)

    def _reserved_bits(self, request: Message, frame: CanFrame) -> int:
        key = request, len(frame.data)
        if key not in self._masks:
            self._masks[key] = form_of(request, frame).reserved.mask
        return int.from_bytes(frame.data, "little") & self._masks[key]

    def behaviour(self, known: Behaviour) -> Behaviour:
        """The behaviour, with the copies and the constant old bits that are known already. Copies hide everything else."""
        copied = known.copied | self._copies.directions(is_marked=known.is_marked)
        known = known._replace(resolution=self.resolution)
        if copied != known.copied:
            return known._replace(copied=copied)
        old = [*(bits for bits in known.old_bits if bits.value is not None), *self._old_bits()]
        if self.only is Direction.REPLY and all(bits.value is None for bits in old):
            return known._replace(only=Direction.REPLY)
        ordered = sorted(self._latencies)
        for bits in old:
            if bits.value is None:
                ordered = sorted(ordered + self._of_request[bits.request].times)
        return known._replace(
            reply_time=ordered[len(ordered) * 9 // 10] if len(ordered) >= _LEAST else None,
            slowest=ordered[-1] if 0 < len(ordered) < _LEAST else None,
            old_bits=tuple(old),
            only=None if old else self.only,
        )

    def _old_bits(self) -> Iterable[OldBits]:
        """The requests with old bits: one that shows them, or all if the bus does."""
        is_bus = _is_paired(self._of_request.values())
        for request, replies in self._of_request.items():
            value = _constant(request, replies)
            if is_bus or _is_paired([replies]) or value is not None:
                yield OldBits(request, value)


def _is_paired(listed: Collection[_Replies]) -> bool:
    """Whether frames follow each other as requests with old bits and their replies do; a few replies happen to do so, too."""
    pairs = sum(replies.pairs for replies in listed)
    is_share = _is_share(pairs, sum(replies.count for replies in listed), 1, _RARE)
    return is_share and 6 * pairs >= sum(replies.orphans for replies in listed)


def _constant(request: Message, replies: _Replies) -> int | None:
    """The value of the reserved bits of all requests: half of the orphans have it, and other values follow it.

    The reply to a read can also be the same each time. Then the times show which of the two is the reply.
    """
    if replies.is_echoed or not _is_share(replies.orphans, replies.count, 1, 4):
        return None
    (value, count), (_, second) = [*replies.bits.most_common(2), (0, 0), (0, 0)][:2]
    is_usual = 3 * count >= replies.orphans and 2 * second < count and 2 * replies.changes[value] >= count
    is_request = bool(request.layout.fields) or 2 * replies.seconds[value] < count
    return value if is_usual and is_request else None
