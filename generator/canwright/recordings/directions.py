"""The direction of each frame of a log: by its mark, its id, its content, or the request that it answers.

Requests and replies can share an id and a code. The rules are tried in this order:

- mark: the log marks the frames that its recorder sent. A log in which all frames are received is that of a listener.
- id: only requests, or only replies, have it.
- content: only one direction has this length, these keys and constants; or the frame sets bits that the request
  reserves, or has a value that the request does not allow: a reply.
- pairing: a request opens an exchange on each channel on which it is answered; a reply within a time closes it.
- retry: a frame with the bytes of an open request repeats the request.

Two buses are independent. Where no exchange is open, the frames after do not depend on the frames before: a log can be
divided there, and wherever a bus is silent for more than the window.
"""

from __future__ import annotations

import functools
import itertools
import operator
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from enum import Enum
from typing import NamedTuple

from ..model.edition import Edition
from ..model.message import Direction, Message
from ..semantics.decoder import Identified, Rejection, rejects_constants
from ..semantics.frame import CanFrame
from .frame_kinds import Channel, FrameKind, FrameKinds, Opened
from .recorded import Mark, Recorded

WINDOW = 2_000_000
"""The time in ns within which a request is answered, unless another is given."""
LOOKED_AHEAD = 4096
"""The number of frames at the start of a log that are searched for marks."""
UNTIMED = 64
"""An exchange without times closes after this number of frames on its bus."""
MAX_OPEN = 16
"""The maximum number of open exchanges on a channel."""
MAX_KINDS = 1 << 16
"""The maximum number of kinds of frames that are remembered for a bus."""


class DecidedBy(str, Enum):
    """The rule that decided on a direction."""

    MARK = "mark"
    ID = "id"
    CONTENT = "content"
    PAIRING = "pairing"
    RETRY = "retry"
    NONE = "none"
    """No message has the id, or none the content."""


class Judged(NamedTuple):
    """A frame of a log, its direction, and the message that it is.

    `edition` is None for an id of no edition, `direction` if no message of either direction fits, `node` for a frame
    without a node, as a broadcast is. If `message` is None, `rejection` states why. `request` is the number of the
    frame that a reply answers, and `latency` the time since then in ns.
    """

    recorded: Recorded
    number: int
    node: int | None
    edition: Edition | None
    direction: Direction | None
    decided_by: DecidedBy
    message: Message | None
    rejection: Rejection | None
    request: int | None
    latency: int | None


class _Exchange:
    """A request that waits for replies."""

    __slots__ = ("frame", "kind", "missing", "number", "since", "time")

    def __init__(self, kind: FrameKind, one: Recorded, number: int, since: int, missing: int) -> None:
        self.kind = kind
        self.frame = one.frame
        self.number = number
        self.time = one.time
        self.since = since
        self.missing = missing
        """The number of replies that it waits for."""


class _Answered(NamedTuple):
    """The exchange that a frame closes, and the reply that it is."""

    channel: Channel
    exchange: _Exchange
    reply: Identified


class _Line:
    """The frames of one id and length on a bus: the editions that have the id, and the kinds of frames.

    There are several editions if nodes of different editions obey one broadcast; the first decides on the direction.
    """

    __slots__ = ("editions", "key_bits", "kinds", "node")

    def __init__(self, editions: list[FrameKinds], frame: CanFrame, node: int | None) -> None:
        self.editions = editions
        self.node = node
        self.key_bits = functools.reduce(operator.or_, (kinds.key_bits(frame) for kinds in editions), 0)
        self.kinds: dict[int, list[FrameKind]] = {}


class _Bus:
    """The state of one bus: its clock, which never runs backwards, and the open exchanges."""

    __slots__ = ("clock", "count", "is_marked", "lines", "open", "time")

    def __init__(self, *, is_marked: bool) -> None:
        self.is_marked = is_marked
        self.clock = 0
        self.time: int | None = None
        self.lines: dict[tuple[int, bool, bool, int], _Line] = {}
        self.count = 0
        """The number of lines and kinds."""
        self.open: dict[Channel, list[_Exchange]] = {}


class Directions:
    """Decides on the direction of each frame of a log. Memory does not grow with the log.

    `editions` are the editions of the nodes by bus and node, `default` that of all others. A request is answered within
    `window` ns. `recorder` is the direction of the frames that are marked as sent. `marked` are the buses with marks;
    None if the first frames of the log decide. `first` is the number of the first frame.
    """

    def __init__(
        self,
        editions: Mapping[tuple[str, int | None], Edition],
        default: Edition | None = None,
        *,
        window: int = WINDOW,
        recorder: Direction = Direction.REQUEST,
        marked: Collection[str] | None = None,
        first: int = 0,
    ) -> None:
        self._editions = editions
        self._default = default
        used = dict.fromkeys([*editions.values(), *([default] if default else [])])
        self._kinds = [FrameKinds(edition, number) for number, edition in enumerate(used)]
        self._window = window
        other = Direction.REPLY if recorder is Direction.REQUEST else Direction.REQUEST
        self._of_mark = {Mark.SENT: recorder, Mark.RECEIVED: other}
        self._marked = marked
        self._number = first
        self._buses: dict[str, _Bus] = {}

    def judge(self, recorded: Iterable[Recorded]) -> Iterator[Judged]:
        """The frames of a log in their order, with their directions."""
        iterator = iter(recorded)
        if self._marked is None:
            start = list(itertools.islice(iterator, LOOKED_AHEAD))
            self._marked = {one.bus for one in start if one.mark is Mark.SENT and self._has_id(one)}
            iterator = itertools.chain(start, iterator)
        for one in iterator:
            yield self._judge(one)

    def is_idle(self, bus: str) -> bool:
        """Whether no exchange is open on a bus, so that its log can be divided after the frames so far."""
        known = self._buses.get(bus)
        return known is None or not any(
            exchange.since + self._window >= known.clock for open_ in known.open.values() for exchange in open_
        )

    def _has_id(self, one: Recorded) -> bool:
        return any(kinds.nodes(one.frame) for kinds in self._kinds)

    def _judge(self, one: Recorded) -> Judged:
        number = self._number
        self._number += 1
        bus = self._buses.get(one.bus)
        if bus is None:
            bus = self._buses[one.bus] = _Bus(is_marked=one.bus in (self._marked or ()))
        self._advance(bus, one.time)
        frame = one.frame
        id_ = (frame.id, frame.extended, frame.remote, len(frame.data))
        line = bus.lines.get(id_) or self._line(bus, one)
        if not line.editions:
            return Judged(one, number, None, None, None, DecidedBy.NONE, None, None, None, None)
        data = int.from_bytes(frame.data, "little")
        kinds = line.kinds.get(data & line.key_bits)
        if kinds is None:
            kinds = line.kinds[data & line.key_bits] = [each.kind(frame) for each in line.editions]
            bus.count += 1
        kind = kinds[0]
        answered = self._answered(bus, kind, frame) if bus.open and kind.answers else None
        if one.mark is not None and bus.is_marked:
            direction: Direction | None = self._of_mark[one.mark]
            decided_by = DecidedBy.MARK
        else:
            direction, decided_by = _by_content(kind, data, frame) or self._by_exchange(bus, kind, frame, answered)
        if direction is Direction.REPLY:
            return self._reply(bus, line, kind, one, number, decided_by, answered)
        if direction is Direction.REQUEST:
            return self._request(bus, line, kinds, one, number, decided_by)
        rejection = kind.rejection(Direction.REQUEST, frame)
        return Judged(one, number, line.node, kind.edition, None, decided_by, None, rejection, None, None)

    def _by_exchange(
        self, bus: _Bus, kind: FrameKind, frame: CanFrame, answered: _Answered | None
    ) -> tuple[Direction, DecidedBy]:
        """The direction of a frame that can be a request and a reply."""
        if answered is None:
            return Direction.REQUEST, DecidedBy.PAIRING
        exchange = answered.exchange
        if exchange.kind.is_echoed or bus.clock - exchange.since <= _reply_within(kind.edition, self._window):
            return Direction.REPLY, DecidedBy.PAIRING
        if exchange.frame.data == frame.data and exchange.frame.id == frame.id:
            return Direction.REQUEST, DecidedBy.RETRY
        return (Direction.REQUEST if kind.is_distinct else Direction.REPLY), DecidedBy.PAIRING

    def _answered(self, bus: _Bus, kind: FrameKind, frame: CanFrame) -> _Answered | None:
        """The oldest open exchange that a frame can close."""
        for channel in kind.answers:
            for exchange in bus.open.get(channel, ()):
                if exchange.since + self._window >= bus.clock:
                    reply = kind.reply_to(exchange.kind, exchange.frame, frame)
                    if reply is not None:
                        return _Answered(channel, exchange, reply)
        return None

    def _request(
        self, bus: _Bus, line: _Line, kinds: Sequence[FrameKind], one: Recorded, number: int, decided_by: DecidedBy
    ) -> Judged:
        kind, frame = kinds[0], one.frame
        rejection = kind.rejection(Direction.REQUEST, frame)
        if rejection is not None or kind.request is None:
            return Judged(
                one, number, line.node, kind.edition, Direction.REQUEST, decided_by, None, rejection, None, None
            )
        for each in kinds:
            for opened in each.opens:
                if self._is_of(one.bus, each.edition, opened.channel.node):
                    self._open(bus, opened, _Exchange(each, one, number, bus.clock, opened.replies))
        request = kind.request
        return Judged(
            one, number, request.node, kind.edition, Direction.REQUEST, decided_by, request.message, None, None, None
        )

    def _reply(
        self,
        bus: _Bus,
        line: _Line,
        kind: FrameKind,
        one: Recorded,
        number: int,
        decided_by: DecidedBy,
        answered: _Answered | None,
    ) -> Judged:
        if answered is None:
            rejection = kind.rejection(Direction.REPLY, one.frame)
            identified = kind.identified[Direction.REPLY]
            message, node = (None, line.node) if isinstance(identified, Rejection) else identified
            if rejection is not None:
                message = None
            return Judged(one, number, node, kind.edition, Direction.REPLY, decided_by, message, rejection, None, None)
        exchange = answered.exchange
        exchange.missing -= 1
        if not exchange.missing:
            bus.open[answered.channel].remove(exchange)
            if not bus.open[answered.channel]:
                del bus.open[answered.channel]
        latency = None if one.time is None or exchange.time is None else one.time - exchange.time
        message, node = answered.reply
        invalid = rejects_constants(message, one.frame, {})
        return Judged(
            one,
            number,
            node,
            kind.edition,
            Direction.REPLY,
            decided_by,
            None if invalid else message,
            invalid,
            exchange.number,
            latency,
        )

    def _open(self, bus: _Bus, opened: Opened, exchange: _Exchange) -> None:
        """Opens an exchange; it replaces earlier ones of the command, except echoes of other bytes, and expired ones."""
        kind, data = exchange.kind, exchange.frame.data
        others = [
            other
            for other in bus.open.get(opened.channel, ())
            if other.since + self._window >= bus.clock
            and (other.kind.request is not kind.request or (kind.is_echoed and other.frame.data != data))
        ]
        bus.open[opened.channel] = [*others[1 - MAX_OPEN :], exchange]

    def _advance(self, bus: _Bus, time: int | None) -> None:
        """Advances the clock of a bus by the time since the last frame; a time that jumps back counts as the same."""
        if time is None:
            bus.clock += self._window // UNTIMED
        elif bus.time is not None and time > bus.time:
            bus.clock += time - bus.time
        if time is not None:
            bus.time = time

    def _line(self, bus: _Bus, one: Recorded) -> _Line:
        """The frames of the id and the length of a frame."""
        if bus.count >= MAX_KINDS:
            bus.lines.clear()
            bus.count = 0
            self._kinds = [FrameKinds(kinds.edition, kinds.number) for kinds in self._kinds]
        frame = one.frame
        having = [
            (kinds, node)
            for kinds in self._kinds
            for node in kinds.nodes(frame)
            if self._is_of(one.bus, kinds.edition, node)
        ]
        node = having[0][1] if having else None
        editions = [kinds for kinds, other in having if other == node]
        line = bus.lines[frame.id, frame.extended, frame.remote, len(frame.data)] = _Line(editions, frame, node)
        bus.count += 1
        return line

    def _is_of(self, bus: str, edition: Edition, node: int | None) -> bool:
        """Whether an edition is that of a node on a bus; for frames without a node, that of any node on the bus."""
        known = self._editions.get((bus, node), self._default if node is not None else None)
        if known is not None or node is not None:
            return known is edition
        return edition is self._default or any(
            other is edition and where == bus for (where, _), other in self._editions.items()
        )


def _by_content(kind: FrameKind, data: int, frame: CanFrame) -> tuple[Direction | None, DecidedBy] | None:
    """The direction of a frame by its id and content; None if both directions are possible."""
    if kind.only is not None:
        return kind.only, DecidedBy.ID
    request = kind.request is not None and kind.request.has_constants(data)
    reply = any(form.has_constants(data) for form in kind.replies)
    if request and reply:
        assert kind.request is not None
        return None if kind.request.is_regular(data, frame) else (Direction.REPLY, DecidedBy.CONTENT)
    if request or reply:
        return (Direction.REQUEST if request else Direction.REPLY), DecidedBy.CONTENT
    return None, DecidedBy.NONE


def _reply_within(edition: Edition, window: int) -> int:
    """The time in ns within which nodes reply, by the spec; the window if it is not given."""
    within = edition.bus.reply_within_ms
    return window if within is None else min(window, int(within * 1_000_000))
