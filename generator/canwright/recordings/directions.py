"""The direction of each frame of a log: by its mark, its id, its content, or the request that it answers.

Requests and replies can share an id and a code. The rules are tried in this order:

- mark: the log marks the frames that its recorder sent. If no node of a bus has both sent and received frames, the recorder
  only listened, or sent all. If a node has only received frames, another host asks it, unless frames without a node
  are sent.
- id: only requests, or only replies, have it.
- log: the log lacks the requests, or the replies, of the bus.
- content: only one direction has this length, these keys and constants; or the frame sets bits that the request
  reserves and a reply does not, or has a value that the request does not allow: then it is a reply.
- pairing: a request opens an exchange on each channel on which it is answered, and a reply within the window closes it.
- retry: a frame with the bytes of an open request repeats it.

The first frames of a log show how each bus behaves. Where the recorder logs each request twice, the second is a copy of
the first. Where the host leaves old bytes in reserved bits, these do not decide. Where replies take longer than the spec
states, the window is longer. Where the log lacks requests or replies, all frames have the other direction.

Where both directions remain possible, a frame waits for the next frames of its exchange, at most for the window: a
reply follows its own request sooner than a repeated request follows the first.

Buses are independent of each other. A log can be divided by bus, and where a bus is silent for more than the longest window.
No exchange is split there, and the parts have the same results as the whole if they are given its `behaviours`.
"""

from __future__ import annotations

import functools
import itertools
import operator
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from enum import Enum
from types import MappingProxyType
from typing import NamedTuple

from ..model.edition import Edition
from ..model.message import Direction, Message
from ..semantics.decoder import Identified, Rejection, rejects_checked
from ..semantics.frame import CanFrame, node_of
from .bus_behaviour import COPIED_WITHIN, LOOKED_AHEAD, Behaviour
from .frame_classes import (
    IS_REGULAR,
    IS_REPLY,
    IS_REQUEST,
    MAX_CLASSES,
    Channel,
    DirectionRule,
    FrameClasses,
    Opened,
    bus_window,
    frame_classes,
)
from .log_frame import LogFrame, Mark, new_tuple
from .observed_behaviour import Observed, observe
from .two_recorders import repeated_after

_Marks = dict[tuple[str, int | None], set[Mark | None]]
"""The marks of the frames of each node of each bus."""
_WINDOWS = (None, 20_000_000, 200_000_000)
"""The windows in ns that are tried while the behaviour is learned."""
_LEARNED_AT = (64, 256, 1024)
"""The numbers of frames of a stream from which its behaviour is learned before LOOKED_AHEAD."""
_ROUNDS = 3
"""How often behaviour is learned: copies hide old bits, and these hide reply times."""
UNTIMED = 64
"""The number of frames on a bus that count as the window, if they or the frames before them have no time."""
MAX_OPEN = 16
"""The maximum number of open exchanges on a channel, and of frames that wait in one."""
MAX_WAITING = 4096
"""The maximum number of frames that wait for an earlier frame."""


class DecidedBy(str, Enum):
    """The rule that decided on a direction."""

    MARK = "mark"
    ID = "id"
    LOG = "log"
    """The log lacks the frames of the other direction."""
    CONTENT = "content"
    PAIRING = "pairing"
    RETRY = "retry"
    COPY = "copy"
    """The recorder logged a frame twice; the first one counts."""
    NONE = "none"
    """No message has the id, or none the content."""

    __hash__ = str.__hash__  # that of Enum takes longer


class DirectedFrame(NamedTuple):
    """A frame of a log, its direction, and the message that it is.

    `edition` is None for an id of no edition, `direction` if no message of either direction fits, `node` for a frame
    without a node, as a broadcast is. If `message` is None, `rejection` states why. `request` is the number of the
    frame that a reply answers, `latency` the time since then in ns, and `is_late` whether other replies come much sooner.
    """

    recorded: LogFrame
    number: int
    node: int | None
    edition: Edition | None
    direction: Direction | None
    decided_by: DecidedBy
    message: Message | None
    rejection: Rejection | None
    request: int | None = None
    latency: int | None = None
    is_late: bool = False


class Change(NamedTuple):
    """Another edition of a node; None if it has none that is known."""

    bus: str
    node: int | None
    edition: Edition | None


class _Known(NamedTuple):
    """The rule for a class of frames, and what it opens as a request: in each edition, on each channel of its nodes."""

    rule: DirectionRule
    opens: Sequence[tuple[DirectionRule, Opened]]


class _IdState:
    """The frames of one id and length on a bus: the editions that have the id, and the rules for the classes of frames.

    There are several editions if nodes of different editions obey one broadcast; the first decides on the direction.
    """

    __slots__ = ("editions", "is_marked", "key_bits", "known", "node")

    def __init__(
        self, editions: Sequence[FrameClasses], frame: CanFrame, node: int | None, behaviour: Behaviour
    ) -> None:
        self.editions = editions
        self.node = node
        self.is_marked = behaviour.is_marked and node not in behaviour.unmarked
        self.key_bits = functools.reduce(operator.or_, (each.id_class(frame).key_bits for each in editions), 0)
        self.known: dict[int, _Known] = {}


class PendingFrame:
    """A frame at its time on the clock of its bus; `directed` is None while it waits for later frames."""

    __slots__ = ("bus", "clock", "directed", "exchange", "known", "line", "number", "recorded")

    def __init__(self, bus: _Bus, recorded: LogFrame, number: int, line: _IdState, known: _Known) -> None:
        self.bus = bus
        self.clock = bus.clock
        self.recorded = recorded
        self.number = number
        self.line = line
        self.known = known
        self.directed: DirectedFrame | None = None
        self.exchange: _Exchange | None = None
        """The exchange in which it waits."""


class _Exchange:
    """A request that waits for replies on a channel, and the frames after it that can be replies or requests."""

    __slots__ = ("channel", "expected", "missing", "request", "rule", "settled", "until", "waiting")

    def __init__(self, rule: DirectionRule, request: PendingFrame, opened: Opened) -> None:
        self.rule = rule
        self.request = request
        self.channel, self.expected = opened
        self.missing = self.expected
        """The number of replies that it waits for."""
        self.until = request.clock + rule.window
        self.waiting: list[PendingFrame] = []
        self.settled = 0
        """The time after which it is too late to decide on waiting frames by the next one."""

    @property
    def last(self) -> PendingFrame:
        return self.waiting[-1] if self.waiting else self.request


_SETTLED = operator.attrgetter("settled")


class _Answered(NamedTuple):
    """The exchange that a frame can close, and the reply that it is."""

    exchange: _Exchange
    reply: Identified


class _Bus:
    """The state of one bus: its clock, which never runs backwards, and the open exchanges."""

    __slots__ = (*("behaviour", "clock", "count", "latest", "lines", "open", "time", "until", "waiting", "window"),)

    def __init__(self, behaviour: Behaviour, window: int) -> None:
        self.behaviour = behaviour
        self.window = window
        self.clock = 0
        self.time: int | None = None
        self.lines: dict[tuple[int, bool, bool, int], _IdState] = {}
        self.count = 0
        """The number of ids and classes."""
        self.open: dict[Channel, list[_Exchange]] = {}
        self.until = 0
        """The time at which the last exchange ends."""
        self.waiting: list[_Exchange] = []
        """The exchanges with waiting frames."""
        self.latest: dict[int | None, PendingFrame] = {}
        """The last frame of each node, if frames are recorded twice and it can have a copy."""

    def forget_classes(self) -> None:
        """Forgets the ids and classes of frames: what they are has changed, or there are too many."""
        self.lines.clear()
        self.count = 0


class Directions:
    """Decides on the direction of each frame of a log. Memory does not grow with the log.

    `editions` are the editions of the nodes by bus and node, `default` that of all others. A request is answered within
    `window` ns; None for the time that suits the editions and the log. `recorder` is the direction of the frames that are
    marked as sent; None if marks do not count. `behaviours` are those of the buses; None if the first frames of the log
    show them. If the log `is_stream`, no frame waits for these: what they show counts for later frames. Before the
    frames with the numbers of `changes`, nodes get other editions, which are among `further`.
    """

    def __init__(
        self,
        editions: Mapping[tuple[str, int | None], Edition],
        default: Edition | None = None,
        *,
        window: int | None = None,
        recorder: Direction | None = Direction.REQUEST,
        behaviours: Mapping[str, Behaviour] | None = None,
        is_stream: bool = False,
        further: Iterable[Edition] = (),
        changes: Mapping[int, Sequence[Change]] = MappingProxyType({}),
    ) -> None:
        self._editions = editions
        self._changed: dict[tuple[str, int | None], Edition | None] = {}
        self._default = default
        self._changes = changes
        used = dict.fromkeys([*editions.values(), *([default] if default else []), *further])
        self._classes = [frame_classes(edition) for edition in used]
        self._window = window
        self._recorder = recorder
        opposite = Direction.REPLY if recorder is Direction.REQUEST else Direction.REQUEST
        self._of_mark = {Mark.SENT: recorder, Mark.RECEIVED: opposite} if recorder else {}
        self.behaviours = behaviours
        self._is_stream = is_stream
        self._number = 0
        self._buses: dict[str, _Bus] = {}
        self._held: deque[PendingFrame | DirectedFrame] = deque()
        """Frames that wait, and those after them."""

    def classify(self, recorded: Iterable[LogFrame]) -> Iterator[DirectedFrame]:
        """The frames of a log in their order, with their directions."""
        iterator = iter(recorded)
        if self.behaviours is None and self._is_stream:
            iterator = self._learning(iterator)
        elif self.behaviours is None:
            start = list(itertools.islice(iterator, LOOKED_AHEAD))
            self.behaviours = self.learn(start)
            iterator = itertools.chain(start, iterator)
        held = self._held
        for frame in iterator:
            judged = self.accept(frame)
            if isinstance(judged, DirectedFrame) and not held:
                yield judged
                continue
            held.append(judged)
            if len(held) > MAX_WAITING and isinstance(held[0], PendingFrame) and held[0].exchange is not None:
                self._decide_pending(held[0].exchange)
            yield from _released(held)
        for bus in self._buses:
            self.decide_pending(bus)
        yield from _released(held)

    def paused(self, duration: int) -> Iterator[DirectedFrame]:
        """The frames that need not wait any more after a pause of a stream, in ns."""
        for bus in self._buses.values():
            for exchange in [*bus.waiting]:
                if exchange.settled < bus.clock + duration:
                    self._decide_pending(exchange)
        return _released(self._held)

    def _learning(self, recorded: Iterable[LogFrame]) -> Iterator[LogFrame]:
        """The frames of a stream; the behaviour is learned while they pass, and marks count where a node first has both.

        Before, of each node only the mark of its first frame counts, if that is sent.
        """
        start: list[LogFrame] = []
        iterator = iter(recorded)
        marks: _Marks = {}
        for frame in itertools.islice(iterator, LOOKED_AHEAD):
            start.append(frame)
            count = len(marks)
            is_complete = self._completes_marks(frame, marks)
            if len(start) in _LEARNED_AT:
                self._behave(self.learn(start))
            learned = self.behaviours or {}
            known = learned.get(frame.bus, Behaviour())
            is_first = frame.mark is Mark.SENT and len(marks) > count and not known.is_marked
            if is_complete or is_first:
                marked = known._replace(is_marked=True, unmarked=_unmarked(marks, frame.bus))
                self._behave({**learned, frame.bus: marked})
            yield frame
            if is_first and not is_complete:
                self._behave(learned)
        self._behave(self.learn(start))
        yield from iterator

    def _behave(self, behaviours: Mapping[str, Behaviour]) -> None:
        """Decides on later frames by other behaviours of the buses."""
        self.behaviours = behaviours
        for name, behaviour in behaviours.items():
            if name in self._buses:
                bus = self._buses[name]
                bus.behaviour, bus.window = behaviour, self._bus_window(behaviour)
                bus.forget_classes()

    def _bus_window(self, behaviour: Behaviour) -> int:
        windows = (bus_window(classes.edition, behaviour, self._window) for classes in self._classes)
        return max(windows, default=0)

    def learn(self, start: Sequence[LogFrame], marked: Collection[str] | None = None) -> dict[str, Behaviour]:
        """The behaviour of the buses in the first frames of a log, decided as if nothing were known of them.

        `marked` are the buses with marks; None if the frames show them.
        """
        known = self._marked(start) if marked is None else {bus: Behaviour(is_marked=True) for bus in marked}
        learned: dict[str, Behaviour] = {}
        for _ in range(_ROUNDS):
            observed = self._observed(start, known)
            learned = {bus: own.behaviour(known.get(bus, Behaviour())) for bus, own in observed.items()}
            certain = {bus: own.certain for bus, own in learned.items()}
            if all(own == known.get(bus, Behaviour()) for bus, own in certain.items()):
                break
            known = certain
        for bus, own in learned.items():
            repeated = None
            if len(own.copied) < len(Direction):
                repeated = repeated_after(f for f in start if f.bus == bus)
            slowest = own.slowest if own.slowest and own.slowest > self._bus_window(own) else None
            learned[bus] = own._replace(repeated_after=repeated, slowest=slowest)
        return learned

    def _observed(self, start: Sequence[LogFrame], known: Mapping[str, Behaviour]) -> dict[str, Observed]:
        """What the first frames show of each bus with the shortest window in which most replies have requests."""
        # A request with old bits looks like a reply, and its copy like one of a reply.
        every = frozenset(Direction)
        tried = {bus: own._replace(copied=every if own.copied else own.copied) for bus, own in known.items()}
        best: dict[str, Observed] = {}
        for window in _WINDOWS if self._window is None else [self._window]:
            trial = Directions(self._editions, self._default, window=window, recorder=self._recorder, behaviours=tried)
            for bus, own in observe(trial.classify(start)).items():
                if bus not in best or 2 * own.unexpected < best[bus].unexpected:
                    best[bus] = own
            if all(own.is_plausible for own in best.values()):
                break
        return best

    def _marked(self, start: Iterable[LogFrame]) -> dict[str, Behaviour]:
        """The buses on which marks count."""
        marks: _Marks = {}
        buses = {frame.bus for frame in start if self._completes_marks(frame, marks)}
        return {bus: Behaviour(is_marked=True, unmarked=_unmarked(marks, bus)) for bus in buses}

    def _completes_marks(self, frame: LogFrame, marks: _Marks) -> bool:
        """Adds the mark of a frame to those of the nodes of its id; returns whether one now has both."""
        if not frame.mark or not self._of_mark:
            return False
        is_complete = False
        for node in {node for each in self._classes for node in each.id_class(frame.frame).nodes}:
            own = marks.setdefault((frame.bus, node), set())
            is_complete |= {*own, frame.mark} > own and bool(own)
            own.add(frame.mark)
        return is_complete

    def decide_pending(self, bus: str, time: int | None = None) -> None:
        """Decides on the frames of a bus that wait: of those for which it is too late at a time, or of all."""
        state = self._buses[bus]
        if time is not None:
            self._advance(state, time)
            return
        for exchange in [*state.waiting]:
            self._decide_pending(exchange)

    def is_idle(self, bus: str) -> bool:
        """Whether no exchange is open on a bus, and no frame can have a copy."""
        state = self._buses[bus]
        return not (state.open or state.waiting or state.latest)

    def forget(self, bus: str) -> Sequence[int]:
        """Forgets the exchanges of a bus; returns the numbers of the requests of those that are open."""
        state = self._buses[bus]
        requests = [exchange.request.number for open_ in state.open.values() for exchange in open_]
        for frames in (state.open, state.waiting, state.latest):
            frames.clear()
        return requests

    def accept(self, recorded: LogFrame) -> DirectedFrame | PendingFrame:
        """The result for the next frame of the log; the frame itself if it has to wait."""
        number = self._number
        self._number = number + 1
        if number in self._changes:
            self._change(self._changes[number])
        bus = self._buses.get(recorded.bus)
        if bus is None:
            behaviour = (self.behaviours or {}).get(recorded.bus, Behaviour())
            bus = self._buses[recorded.bus] = _Bus(behaviour, self._bus_window(behaviour))
        self._advance(bus, recorded.time)
        frame = recorded.frame
        if bus.count >= MAX_CLASSES:
            bus.forget_classes()
        line = bus.lines.get((frame.id, frame.extended, frame.remote, len(frame.data))) or self._line(bus, recorded)
        if not line.editions:
            return DirectedFrame(recorded, number, None, None, None, DecidedBy.NONE, None, None)
        data = int.from_bytes(frame.data, "little")
        known = line.known.get(data & line.key_bits) or self._known(bus, line, recorded, data)
        arrived = PendingFrame(bus, recorded, number, line, known)
        return self._with_copies(arrived, data) if bus.behaviour.copied else self._decide(arrived, data)

    def _with_copies(self, arrived: PendingFrame, data: int) -> DirectedFrame | PendingFrame:
        """The result on a bus where frames are recorded twice."""
        bus, node = arrived.bus, arrived.line.node
        latest = bus.latest.pop(node, None)
        if latest is not None and latest.recorded.frame == arrived.recorded.frame:
            first = self._first(latest)
            # A copy of a request can be marked as received, as the adapter returns it.
            mark = arrived.recorded.mark if arrived.line.is_marked and first.direction is Direction.REPLY else None
            if first.direction in bus.behaviour.copied and (mark is None or self._of_mark[mark] is first.direction):
                return first._replace(
                    recorded=arrived.recorded,
                    number=arrived.number,
                    decided_by=DecidedBy.COPY,
                    request=None,
                    latency=None,
                    is_late=False,
                )
        result = self._decide(arrived, data)
        if isinstance(result, DirectedFrame):
            arrived.directed = result
        if arrived.directed is None or arrived.directed.direction in bus.behaviour.copied:
            bus.latest[node] = arrived
        return result

    def _first(self, latest: PendingFrame) -> DirectedFrame:
        """The result for a frame that is recorded again; one that waits has the direction that is recorded twice."""
        if latest.exchange is not None and latest.directed is None:
            settle = self._decide_pending if Direction.REPLY in latest.bus.behaviour.copied else self._repeat
            settle(latest.exchange)
        assert latest.directed is not None
        return latest.directed

    def _decide(self, arrived: PendingFrame, data: int) -> DirectedFrame | PendingFrame:
        """The result by the mark, the id, the content or the exchange; the frame itself if it has to wait."""
        recorded, known = arrived.recorded, arrived.known
        if recorded.mark is not None and arrived.line.is_marked:
            direction: Direction | None = self._of_mark[recorded.mark]
            decided_by = DecidedBy.MARK
        else:
            decided = direction_by_content(known.rule, known.rule.content(data))
            if decided is None:
                return self._by_exchange(arrived)
            direction, decided_by = decided
        if direction is Direction.REQUEST:
            return self._request(arrived, decided_by)
        if direction is Direction.REPLY:
            return self._reply(arrived, decided_by, self._answered(arrived, replies_only=True))
        rejection = known.rule.frame_class.rejection(Direction.REQUEST, recorded.frame)
        return _directed(arrived, None, decided_by, arrived.line.node, None, rejection)

    def _by_exchange(self, arrived: PendingFrame) -> DirectedFrame | PendingFrame:
        """The result for a frame that can be a request or a reply; the frame itself if it has to wait."""
        answered = self._answered(arrived)
        if answered is None:
            return self._request(arrived, DecidedBy.PAIRING)
        exchange = answered.exchange
        is_soon = arrived.clock - exchange.last.clock <= exchange.rule.within
        if exchange.rule.frame_class.is_echoed and is_soon:
            self._repeat(exchange)
            return self._reply(arrived, DecidedBy.PAIRING, self._answered(arrived))
        if exchange.rule.frame_class.is_echoed or (is_soon and not exchange.waiting):
            return self._wait(arrived, exchange)
        if exchange.waiting:
            self._decide_pending(exchange)
            return self._by_exchange(arrived)
        return self._request(arrived, self._repeated(exchange, arrived))

    def _wait(self, arrived: PendingFrame, exchange: _Exchange) -> DirectedFrame | PendingFrame:
        if len(exchange.waiting) >= MAX_OPEN:
            self._decide_pending(exchange)
            return self._by_exchange(arrived)
        bus = arrived.bus
        if not exchange.waiting:
            bus.waiting.append(exchange)
        exchange.waiting.append(arrived)
        exchange.settled = arrived.clock + bus.window
        exchange.until = max(exchange.until, exchange.settled)
        bus.until = max(bus.until, exchange.until)
        arrived.exchange = exchange
        return arrived

    def _repeat(self, exchange: _Exchange) -> None:
        """Decides that the waiting frames of an exchange are requests: only the last one is answered."""
        for arrived in self._take_waiting(exchange):
            arrived.directed = self._request(arrived, self._repeated(exchange, arrived))

    def _decide_pending(self, exchange: _Exchange) -> None:
        """Decides on the waiting frames of an exchange in which no reply follows soon: replies and requests alternate."""
        answered: _Answered | None = None
        for arrived in self._take_waiting(exchange):
            answered = None if answered else self._answered(arrived)
            if answered is None:
                arrived.directed = self._request(arrived, self._repeated(exchange, arrived))
            else:
                arrived.directed = self._reply(arrived, DecidedBy.PAIRING, answered)

    def _take_waiting(self, exchange: _Exchange) -> Sequence[PendingFrame]:
        waiting = exchange.waiting
        if waiting:
            exchange.waiting = []
            waiting[0].bus.waiting.remove(exchange)
        return waiting

    def _repeated(self, exchange: _Exchange, arrived: PendingFrame) -> DecidedBy:
        is_same = arrived.recorded.frame == exchange.request.recorded.frame
        return DecidedBy.RETRY if is_same else DecidedBy.PAIRING

    def _answered(self, arrived: PendingFrame, *, replies_only: bool = False) -> _Answered | None:
        """The oldest open exchange that a frame can close."""
        open_, own, frame = arrived.bus.open, arrived.known.rule.frame_class, arrived.recorded.frame
        if not open_:
            return None
        for channel in own.of_id.answers:
            for exchange in open_.get(channel, ()):
                if exchange.until >= arrived.clock:
                    asked = exchange.request.recorded.frame
                    reply = own.reply_to(exchange.rule.frame_class, asked, frame)
                    if reply is not None and replies_only and exchange.waiting:
                        self._repeat(exchange)
                        return self._answered(arrived)
                    if reply is not None:
                        return new_tuple(_Answered, (exchange, reply))
        return None

    def _request(self, arrived: PendingFrame, decided_by: DecidedBy) -> DirectedFrame:
        own = arrived.known.rule.frame_class
        rejection = own.rejection(Direction.REQUEST, arrived.recorded.frame)
        if rejection is not None or own.request is None:
            return _directed(arrived, Direction.REQUEST, decided_by, arrived.line.node, None, rejection)
        for asking, opened in arrived.known.opens:
            self._open(_Exchange(asking, arrived, opened))
        return _directed(arrived, Direction.REQUEST, decided_by, own.request.node, own.request.message)

    def _open(self, exchange: _Exchange) -> None:
        """Opens an exchange; it replaces earlier ones of the command, unless they wait for an echo of other bytes, or a reply
        could not come so soon: then a host asks again without waiting, and both are answered.
        """
        bus, own, frame = exchange.request.bus, exchange.rule.frame_class, exchange.request.recorded.frame
        before = bus.open.get(exchange.channel)
        if before:
            replaced = [
                earlier
                for earlier in before
                if earlier.rule.frame_class.command is own.command
                and (not own.is_echoed or earlier.request.recorded.frame == frame)
                and not self._is_further(exchange, earlier)
            ]
            for earlier in replaced:
                self._decide_pending(earlier)
            kept = [o for o in before if o not in replaced and o.until >= exchange.request.clock]
            for earlier in kept[: 1 - MAX_OPEN]:
                self._decide_pending(earlier)
            bus.open[exchange.channel] = [*kept[1 - MAX_OPEN :], exchange]
        else:
            bus.open[exchange.channel] = [exchange]
        bus.until = max(bus.until, exchange.until)

    @staticmethod
    def _is_further(exchange: _Exchange, earlier: _Exchange) -> bool:
        """Whether a request follows another one so soon that it does not repeat it. Without times, none is known to."""
        pause = exchange.request.clock - earlier.request.clock
        is_timed = exchange.request.recorded.time is not None
        return is_timed and not earlier.waiting and pause < earlier.rule.within // 2

    def _reply(self, arrived: PendingFrame, decided_by: DecidedBy, answered: _Answered | None) -> DirectedFrame:
        own, recorded = arrived.known.rule.frame_class, arrived.recorded
        if answered is None:
            identified = own.identified[Direction.REPLY]
            rejection = own.rejection(Direction.REPLY, recorded.frame)
            node = (
                arrived.line.node if isinstance(identified, Rejection) else node_of(identified.message, recorded.frame)
            )
            message = None if isinstance(identified, Rejection) or rejection else identified.message
            return _directed(arrived, Direction.REPLY, decided_by, node, message, rejection)
        exchange, (message, node) = answered
        self._close(exchange, message)
        if node is None and exchange.rule.request is not None:
            node = exchange.rule.request.node
        rejection = rejects_checked(message, recorded.frame, {}) if message in own.with_checks else None
        asked = exchange.request
        latency = None
        if recorded.time is not None and asked.recorded.time is not None and recorded.time >= asked.recorded.time:
            latency = recorded.time - asked.recorded.time
        is_late = latency is not None and _is_late(exchange, latency, node)
        known = None if rejection else message
        return _directed(arrived, Direction.REPLY, decided_by, node, known, rejection, (asked.number, latency, is_late))

    def _close(self, exchange: _Exchange, reply: Message) -> None:
        """Counts a reply; the last one closes the exchange, and so does one that is sent instead of others."""
        exchange.missing = 0 if reply in exchange.rule.frame_class.alternatives else exchange.missing - 1
        open_ = exchange.request.bus.open
        channel = open_.get(exchange.channel)
        if not exchange.missing and channel and exchange in channel:
            channel.remove(exchange)
            if not channel:
                del open_[exchange.channel]

    def _advance(self, bus: _Bus, time: int | None) -> None:
        """Advances the clock of a bus by the time since the last frame; a jump backwards counts as no time.

        The clock depends on pairs of neighbouring frames only, so that it does not matter where a log begins.
        """
        if time is None or bus.time is None:
            bus.clock += bus.window // UNTIMED
        elif time > bus.time:
            bus.clock += time - bus.time
        bus.time = time
        for exchange in sorted(bus.waiting, key=_SETTLED) if bus.waiting else ():
            if exchange.settled < bus.clock:
                self._decide_pending(exchange)
        if bus.latest:
            bus.latest = {
                node: latest for node, latest in bus.latest.items() if bus.clock - latest.clock <= COPIED_WITHIN
            }
        if bus.open and bus.until < bus.clock:
            bus.open.clear()

    def _change(self, changes: Iterable[Change]) -> None:
        """Gives nodes other editions, so that frames have other classes."""
        for bus, node, edition in changes:
            self._changed[bus, node] = edition
            if bus in self._buses:
                self._buses[bus].forget_classes()

    def _known(self, bus: _Bus, line: _IdState, recorded: LogFrame, data: int) -> _Known:
        """The kind of a frame of a known id and length."""
        rules = [DirectionRule(each.of(recorded.frame), bus.behaviour, self._window) for each in line.editions]
        opens = [
            (rule, opened)
            for rule in rules
            for opened in rule.frame_class.opens
            if self._is_of(recorded.bus, rule.frame_class.edition, opened.channel.node)
        ]
        known = line.known[data & line.key_bits] = _Known(rules[0], opens)
        bus.count += 1
        return known

    def _line(self, bus: _Bus, recorded: LogFrame) -> _IdState:
        """The frames of the id and the length of a frame."""
        frame = recorded.frame
        having = [
            (classes, node)
            for classes in self._classes
            for node in classes.id_class(frame).nodes
            if self._is_of(recorded.bus, classes.edition, node)
        ]
        node = having[0][1] if having else None
        editions = [classes for classes, sender in having if sender == node]
        line = bus.lines[frame.id, frame.extended, frame.remote, len(frame.data)] = _IdState(
            editions, frame, node, bus.behaviour
        )
        bus.count += 1
        return line

    def _is_of(self, bus: str, edition: Edition, node: int | None) -> bool:
        """Whether an edition is that of a node on a bus; for frames without a node, that of any node on the bus."""
        known = self._editions.get((bus, node), self._default if node is not None else None)
        if self._changed:
            known = self._changed.get((bus, node), known)
        if known is not None or node is not None:
            return known is edition
        return edition is self._default or any(
            each is edition and where == bus for (where, _), each in (*self._editions.items(), *self._changed.items())
        )


def _unmarked(marks: _Marks, bus: str) -> frozenset[int | None]:
    """The nodes to which nothing is sent, though each sent frame is for one node."""
    own = {node: of_node for (of, node), of_node in marks.items() if of == bus}
    to_all = Mark.SENT in own.get(None, ())
    return frozenset(node for node, of_node in own.items() if Mark.SENT not in of_node and not to_all)


def _released(held: deque[PendingFrame | DirectedFrame]) -> Iterator[DirectedFrame]:
    """Takes the frames from the left that do not wait."""
    while held:
        judged = held[0].directed if isinstance(held[0], PendingFrame) else held[0]
        if judged is None:
            return
        held.popleft()
        yield judged


def _directed(
    arrived: PendingFrame,
    direction: Direction | None,
    decided_by: DecidedBy,
    node: int | None,
    message: Message | None,
    rejection: Rejection | None = None,
    answer: tuple[int | None, int | None, bool] = (None, None, False),
) -> DirectedFrame:
    """The result for a frame; `answer` is the number of the request, the latency, and whether it is late."""
    edition = arrived.known.rule.frame_class.edition
    known = arrived.recorded, arrived.number, node, edition, direction, decided_by, message, rejection
    return new_tuple(DirectedFrame, known + answer)


def _is_late(exchange: _Exchange, latency: int, node: int | None) -> bool:
    """Whether a reply is certainly late. Several frames, and the nodes that answer one broadcast, come one after the other."""
    from_each = exchange.rule.frame_class.command.from_each
    after = exchange.rule.late_after
    position = from_each.index(node) if node in from_each else exchange.expected - exchange.missing - 1
    return after is not None and latency - exchange.rule.behaviour.resolution >= after * (position + 1)


def direction_by_content(rule: DirectionRule, content: int) -> tuple[Direction | None, DecidedBy] | None:
    """The direction of a frame by its id, its log or its content; None if both directions are possible."""
    if rule.only is not None:
        return rule.only, DecidedBy.LOG if rule.by_log else DecidedBy.ID
    if content & IS_REQUEST and content & IS_REPLY:
        return None if content & IS_REGULAR else (Direction.REPLY, DecidedBy.CONTENT)
    if content & (IS_REQUEST | IS_REPLY):
        return Direction.REQUEST if content & IS_REQUEST else Direction.REPLY, DecidedBy.CONTENT
    return None, DecidedBy.NONE
