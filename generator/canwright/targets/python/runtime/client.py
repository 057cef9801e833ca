"""A client on a python-can bus: sends requests to nodes, and returns only replies that are theirs.

`exchange.py` has the rules of one node. Here are the bus, the consent of the program, and the clocks.
"""

from __future__ import annotations

import errno
import math
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import TracebackType
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import can

from ._codec import CodecError, Message, Request, places
from .exchange import NO_REPLY, NOT_SENT, SILENT, UNPROVEN, Call, Copies, Counters, Frame, Line
from .nodes import Node, Numbering
from .python_can import frame_of, to_message

if TYPE_CHECKING:
    from typing_extensions import Self

R = TypeVar("R", bound=Message)
T = TypeVar("T")

MOTION = "motion"
KEPT = ("ram", "staged", "rom")
"""How long a node can keep a setting, the shortest first."""
TIMEOUT = 0.02
"""The time in seconds that adapter, driver and scheduler may add to the time of the reply."""
LISTEN = 0.1
"""The longest time in seconds that listening waits at once, so that an interrupt ends it on every system."""
STOP_TRIES = 3
ON_EXIT = {"stop": "stop", "off": "switch_off", "nothing": ""}
"""What ends the motion of a node at the end, by the argument `on_exit`."""
UNSOLICITED = 1 << 12
"""The most frames without a request that are stored."""


class ClientError(Exception):
    """A request has no reply."""


class NoReply(ClientError, TimeoutError):  # noqa: N818  the name reads well in an `except` clause
    """No reply came in time. Whether the node received the request is unknown."""


class Unproven(ClientError):  # noqa: N818
    """A frame equal to the request came back: the reply of the node, or a copy that the bus returned."""


class NotSent(ClientError):  # noqa: N818
    """The request was not sent."""


class NotWritten(ClientError):  # noqa: N818
    """A node has another value than the one that was written."""


class BusLost(ClientError, ConnectionError):  # noqa: N818
    """The bus does not work any more. `reopen` starts again."""


class ConsentError(ClientError, PermissionError):
    """The program did not allow an effect of the request, which was not sent."""

    reason = ""
    """What was not sent, and the effect."""
    consent = ""
    """What would allow it."""


FAILURES: Mapping[str, tuple[type[ClientError], str]] = {
    NO_REPLY: (NoReply, "no reply to {}"),
    NOT_SENT: (NotSent, "{} was not sent: the queue of the driver is full"),
    SILENT: (NotSent, "{} was not sent, because the node does not answer"),
    UNPROVEN: (
        Unproven,
        "{} has no proven reply: the same frame came back, and it is unknown whether the bus returns own frames",
    ),
}


@dataclass(frozen=True)
class Outcome(Generic[R]):
    """What became of a request: its replies, usually one, or the reason that there is none."""

    request: Request[R]
    replies: tuple[R, ...]
    error: ClientError | None
    at: float
    """When it ended, by `time.monotonic()`."""

    @property
    def reply(self) -> R | None:
        """The first reply; None without one."""
        return self.replies[0] if self.replies else None

    @property
    def age(self) -> float:
        """Seconds since the reply came."""
        return time.monotonic() - self.at

    def get(self) -> R:
        """The first reply. Raises the error if there is none."""
        if self.error is not None:
            raise self.error
        return self.replies[0]


def differences(settings: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """The settings of two dumps that differ, each with both values; None where one of them does not have it."""
    pairs = {name: (settings.get(name), others.get(name)) for name in {**settings, **others}}
    return {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}


def variables_of(message: Message) -> dict[str, Any]:
    """The values of a message, by the variables of the node that they are. Raises CodecError without a parameter."""
    return {message.VARIABLES.get(field, field): value_of(message, field) for field in message.fields()}


def value_of(message: Message, field: str) -> Any:
    """The value of a field; the name where there is no value. Raises CodecError without a parameter."""
    value = getattr(message, field)
    return message.no_values().get(field) if value is None else value


def effects_of(request: Message) -> tuple[str, ...]:
    """The effects of a request with its values."""
    names: tuple[str, ...] = request.EFFECTS
    for field, values in request.EXEMPT.items():
        raw: Any = getattr(request, f"{field}_raw")
        elements: Sequence[int] = raw if hasattr(raw, "__iter__") else (raw,)
        for element in elements:
            absent: tuple[str, ...] = values.get(element, ())
            names = tuple([name for name in names if name not in absent])
    return names


@dataclass(eq=False)
class _Job:
    """A request on the line of a node; without one, the line is made certain."""

    line: Line
    request: Request[Any] | None = None
    call: Call | None = None
    tries: int = 1
    at_once: bool = False
    error: ClientError | None = None
    replies: tuple[Any, ...] = ()
    at: float = 0.0


class _Batch:
    """The requests of one call: those of a line wait for each other. `live` are the lines with an open request."""

    def __init__(self, client: ClientCore, jobs: Iterable[_Job]) -> None:
        self.live: dict[Line, _Job] = {}
        self._client = client
        self._waiting: dict[Line, deque[_Job]] = {}
        for job in jobs:
            self._waiting.setdefault(job.line, deque()).append(job)

    def start(self, now: float) -> None:
        for line in self._waiting:
            self._next(line, now)

    def step(self, frame: can.Message | None, now: float) -> None:
        """A frame came, or a deadline is reached."""
        if frame is not None:
            for line in self._client.lines_of(frame):
                call = line.feed(frame_of(frame), now)
                if line in self.live:
                    self._after(line, call, now)
        for line in [line for line in self.live if line.deadline <= now]:
            self._after(line, line.tick(now), now)

    def _next(self, line: Line, now: float) -> None:
        if self._waiting[line]:
            job = self.live[line] = self._waiting[line].popleft()
            self._after(line, line.open(job.call, now, job.tries, at_once=job.at_once), now)

    def _after(self, line: Line, call: Call | None, now: float) -> None:
        """Sends what a line asks for, and ends its request if it is over."""
        job = self.live[line]
        if call is not None and call.message is not None and not self._client.transmit(call.message):
            line.not_sent()
        if not line.is_open:
            del self.live[line]
            job.replies, job.at = tuple(line.replies), now
            if line.failure:
                kind, text = FAILURES[line.failure]
                job.error = kind(text.format(job.request or "a read"))
            self._next(line, now)


Steps = Generator[float, can.Message | None, T]
"""Steps that wait: they yield until when, and get the next frame, or None if none came until then."""


class ClientCore:
    """What clients with and without threads have in common; steps do the work, and a client waits for them."""

    def __init__(
        self,
        bus: can.BusABC,
        nodes: Iterable[Node[Any, Any]],
        *,
        allow: str | Mapping[int, str] = "",
        on_exit: str = "stop",
        timeout: float = TIMEOUT,
        bit_rate: int | None = None,
        own_frames: bool | None = None,
        notifier: can.Notifier | None = None,
    ) -> None:
        """A client for the nodes of a bus, which the caller opens and closes.

        `allow="motion"` permits requests that move the nodes; `allow={1: "motion"}` those of node 1. `on_exit` is sent to each
        node that was moved: `stop`, `off` or `nothing`. `timeout` in seconds is added to the reply time of the node.
        `bit_rate` in bit/s lets the client reject replies that come sooner than two frames last; omit it for a bus that is no CAN.
        `own_frames` states whether the bus returns own frames, if that is known and no read of the node can show it.
        `notifier` is one of python-can that already reads the bus; without it, no other program part may read.
        """
        allowed = (allow,) if isinstance(allow, str) else allow.values()
        if not {"", MOTION}.issuperset(allowed):
            raise ValueError(f"allow={allow!r} is not {MOTION}; give other consents with each request")
        if on_exit not in ON_EXIT:
            raise ValueError(f"on_exit={on_exit!r} is none of {', '.join(ON_EXIT)}")
        self.nodes: dict[int, Node[Any, Any]] = {}
        self.counters = Counters()
        self._numbering = Numbering()
        self.unsolicited: deque[Message] = deque(maxlen=UNSOLICITED)
        """Frames that nodes sent without a request, the oldest first."""
        self._allow = allow
        self._on_exit = on_exit
        self._timeout = timeout
        self._bit_rate = bit_rate
        self._own_frames = own_frames
        self._lost: BaseException | None
        self._moved: dict[int, None] = {}
        self._bits = 0
        for node in nodes:
            if node.node in self.nodes:
                raise ValueError(f"{self.nodes[node.node]!r} and {node!r} have the same number")
            self.nodes[node.node] = node
        self._lock = threading.RLock()
        self._notifier = notifier
        self._reader = can.BufferedReader() if notifier else None
        if notifier and self._reader:
            notifier.add_listener(self._reader)
        self._use(bus)

    def _use(self, bus: can.BusABC) -> None:
        """Nothing is known of the nodes, and of what the bus returns."""
        self.bus, self._lost = bus, None
        self._copies = Copies(self._own_frames)
        self._lines = {number: self._line(node) for number, node in self.nodes.items()}
        self._by_id: dict[tuple[int, bool], Line] = {}
        unlisted: dict[Line, None] = {}
        for number, node in self.nodes.items():
            line, ids = self._lines[number], [*node.ids_of("reply")]
            self._by_id |= {(can_id, extended): line for can_id, mask, extended, _ in ids if not mask}
            if not ids or any(mask for _, mask, _, _ in ids):  # the data or a part of the id decides
                unlisted[line] = None
        self._without_id = tuple(unlisted)

    def _line(self, node: Node[Any, Any]) -> Line:
        facts = node.edition.client_facts
        requests = (_decodable(node, read) for read in facts.reads)
        reads = [self._call(node, request, self._timeout) for request in requests if request is not None]
        sent, received = ({ids[::2] for ids in node.ids_of(direction)} for direction in ("request", "reply"))
        longest = 47 + 64  # bits of a frame with 8 bytes, without stuff bits
        return Line(
            reads,
            node.edition.share_a_reply,
            self._copies,
            self.counters,
            shares_ids=bool(sent & received) or not received,
            in_order=facts.answers_in_order,
            timeout=self._timeout,
            floor=2 * longest / self._bit_rate if self._bit_rate else 0.0,
            claims=lambda frame: self._claims(node, frame),
        )

    def _claims(self, node: Node[Any, Any], frame: Frame) -> bool:
        """Stores a frame that nodes send without a request."""
        try:
            message = node.decode_reply(frame[0], frame[4], extended=frame[1], remote=frame[2])
        except CodecError:
            return False
        if not message.TITLE and not {"cyclic", "on_change", "event"} & {*message.SENT}:
            return False
        self.unsolicited.append(message)
        return True

    def _call(self, node: Node[Any, Any], request: Request[Any], timeout: float | None) -> Call:
        edition, parameters, is_fd = node.edition, node.parameters, request.FD
        decode: Callable[..., Any] = edition.decode_answer
        within = request.REPLY_WITHIN_MS or edition.REPLY_WITHIN_MS or 0.0
        message = to_message(request)

        def accept(frame: Frame) -> Any:
            can_id, extended, remote, fd, data = frame
            try:
                reply = decode(request, can_id, data, parameters, extended=extended, remote=remote)
            except CodecError:
                return None
            return None if fd and not is_fd else reply

        return Call(
            key=type(request),
            frame=frame_of(message),
            accept=accept,
            timeout=timeout if timeout is not None else within / 1000 + self._timeout,
            replies=request.REPLIES // (len(request.REPLIERS) or 1),
            is_read=not effects_of(request) and bool(edition.client_facts.effects),
            differs=request.DIFFERS,
            message=message,
        )

    # Consent

    def _node_of(self, request: Message) -> Node[Any, Any]:
        """The node of a request; of one without a node the only one. Raises ValueError or TypeError."""
        number: int | None = request.node
        alone = len(self.nodes) == 1 and number is None
        node = next(iter(self.nodes.values())) if alone else self.nodes.get(-1 if number is None else number)
        if node is None:
            raise ValueError(f"{request} is for node {request.node}, which this client does not have")
        if type(request).__module__ != getattr(node.edition, "__name__", None):
            raise TypeError(f"{type(request).__module__}.{type(request).__name__} is of another edition than {node!r}")
        return node

    def _check_consent(self, node: Node[Any, Any], request: Message, allow: str) -> None:
        """Raises ConsentError if the program did not allow an effect of a request."""
        effects = node.edition.client_facts.effects
        for name in effects_of(request):
            title, consent, _, _ = effects[name]
            granted = allow.split()
            if consent == MOTION:
                granted += (self._allow if isinstance(self._allow, str) else self._allow.get(node.node, "")).split()
            if consent == "none" or consent in granted:
                continue
            where = f'Client(..., allow="{consent}") or ' if consent == MOTION else ""
            reason = f"{request} was not sent. {title}"
            error = ConsentError(f'{reason}. To allow this, write {where}request(..., allow="{consent}")')
            error.reason, error.consent = reason, consent
            raise error
        if request.ONLY and request.parameters != node.parameters:
            request.replace(parameters=node.parameters)  # rejected where the node lacks the command
        if type(request) not in node.edition.client_facts.ends_motion.values():
            _check_replies(node, type(request))

    def _check_tries(self, node: Node[Any, Any], request: Message, tries: int) -> None:
        effects = node.edition.client_facts.effects
        is_repeatable = all(effects[name][2] for name in effects_of(request))
        if not (is_repeatable if request.REPEAT is None else request.REPEAT):
            raise ValueError(f"{request} cannot be repeated safely; leave out tries={tries}")

    def _note(self, node: Node[Any, Any], request: Message) -> None:
        """Stores whether a node has to be stopped at the end."""
        if type(request) in node.edition.client_facts.ends_motion.values():
            self._moved.pop(node.node, None)
        elif any(node.edition.client_facts.effects[name][1] == MOTION for name in effects_of(request)):
            self._moved[node.node] = None

    # Steps

    def _receiver(self) -> Callable[[float], can.Message | None]:
        """What returns the next frame, or None if there is none for a time in seconds."""
        return self._reader.get_message if self._reader else self.bus.recv

    def _exchange(self, jobs: Sequence[_Job]) -> Steps[None]:
        """Exchanges with all nodes at once, and with one node one after the other."""
        batch, clock = _Batch(self, jobs), time.monotonic
        try:
            while (frame := (yield 0.0)) is not None:  # what came before is no reply
                self._idle(frame)
            batch.start(clock())
            while batch.live:
                frame = yield min(line.deadline for line in batch.live)
                batch.step(frame, clock())
        except BusLost as error:
            self._lost = error
            for job in jobs:
                if not job.at:
                    job.error, job.at = error, clock()
        finally:
            for line in batch.live:
                line.abort(clock())

    def _idle(self, frame: can.Message) -> None:
        """A frame while no request is open."""
        for line in self.lines_of(frame):
            line.feed(frame_of(frame), time.monotonic())

    def transmit(self, message: can.Message) -> bool:
        """Sends a frame; whether the queue of the driver had room for it. Raises BusLost."""
        self._bits += 2 * _bits(message)
        try:
            self.bus.send(message)
        except (can.CanError, OSError) as error:
            if _is_full(error):
                return False
            raise BusLost(f"the bus does not work: {error}") from error
        return True

    def lines_of(self, frame: can.Message) -> tuple[Line, ...]:
        """The lines that a frame may belong to."""
        if frame.is_error_frame:
            self.counters.errors += 1
            return ()
        line = self._by_id.get((frame.arbitration_id, frame.is_extended_id))
        return self._without_id if line is None else (line,)

    def _settle(self, lines: Iterable[Line], request: Message | None = None) -> Steps[None]:
        """Makes lines certain with a read each. Raises NotSent for a request that was to follow."""
        jobs = [_Job(line) for line in lines if not line.is_certain]
        yield from self._exchange(jobs)
        error = next((job.error for job in jobs if job.error), None)
        if request and error:
            raise NotSent(f"{request} was not sent, because a node does not answer") from error

    def _gather_steps(self, request: Request[R], allow: str, timeout: float | None) -> Steps[list[R]]:
        nodes = [self.nodes[number] for number in request.REPLIERS if number in self.nodes] or [self._node_of(request)]
        for node in nodes:
            self._check_consent(node, request, allow)
        self._check_bus()
        request = self._numbering.next(request)
        lines = [self._lines[node.node] for node in nodes]
        yield from self._settle(lines, request)
        jobs: list[_Job] = []
        for node, line in zip(nodes, lines, strict=True):
            self._note(node, request)
            call = self._call(node, request, timeout)
            jobs.append(_Job(line, request, replace(call, message=None) if jobs else call))
        yield from self._exchange(jobs)
        return [cast("R", reply) for job in jobs for reply in job.replies]

    def _send_steps(self, request: Request[Any], allow: str) -> Steps[None]:
        nodes = [*self.nodes.values()] if request.node is None else [self._node_of(request)]
        for node in nodes:
            self._check_consent(node, request, allow)
            self._note(node, request)
        self._check_bus()
        yield from self._settle((self._lines[node.node] for node in nodes), request)
        if not self.transmit(to_message(self._numbering.next(request))):
            raise NotSent(f"{request} was not sent: the queue of the driver is full")
        self.counters.sent += 1

    def _cycle_steps(
        self, requests: Sequence[Request[R]], allow: str, tries: int, timeout: float | None
    ) -> Steps[list[Outcome[R]]]:
        jobs: list[_Job] = []
        for request in requests:
            if not request.REPLIES or request.REPLIERS:
                number = "several" if request.REPLIES else "no"
                raise TypeError(f"{request} has {number} replies; use send or gather")
            node = self._node_of(request)
            if tries > 1:
                self._check_tries(node, request, tries)
            job = _Job(self._lines[node.node], request, None, tries)
            try:
                self._check_consent(node, request, allow)
                job.request = self._numbering.next(request)
                job.call = self._call(node, job.request, timeout)
                self._note(node, request)
            except ConsentError as error:
                job.error = error
            except CodecError as error:
                job.error = NotSent(f"{request} was not sent: {error}")
                job.error.__cause__ = error
            jobs.append(job)
        self._check_bus()
        yield from self._exchange([job for job in jobs if job.error is None])
        return [
            Outcome(request, job.replies, job.error, job.at or time.monotonic())
            for request, job in zip(requests, jobs, strict=True)
        ]

    def _periods(self, rate: float, start: float, bits: int) -> Iterator[tuple[int, float]]:
        """The number of each period after the first, and the time to wait for it; missed ones are left out and counted."""
        needed = (self._bits - bits) / self._bit_rate if self._bit_rate else 0.0
        if needed * rate > 1:
            text = f"need {needed * 1000:.2f} ms at {self._bit_rate} bit/s, more than {1000 / rate:.2f} ms"
            warnings.warn(f"the frames of a period {text}", stacklevel=3)
        number = 0
        while True:
            now = time.monotonic()
            due = max(number + 1, math.ceil((now - start) * rate))
            self.counters.overruns += due - number - 1
            number = due
            yield number, max(0.0, start + number / rate - now)

    # Settings

    def _known(self, node: int | None) -> Node[Any, Any]:
        """The node of a number; without one the only node. Raises ValueError."""
        if node is None and len(self.nodes) == 1:
            return next(iter(self.nodes.values()))
        if node is None or node not in self.nodes:
            raise ValueError(f"node={node} is none of this client; give one of {[*self.nodes]}")
        return self.nodes[node]

    def _dump_steps(self, number: int | None) -> Steps[dict[str, Any]]:
        node = self._known(number)
        settings = yield from self._read_steps(node, node.edition.client_facts.settings)
        return {name: value for values in settings.values() for name, value in values.items()}

    def _read_steps(
        self, node: Node[Any, Any], reads: Iterable[type[Request[Any]]]
    ) -> Steps[dict[type[Request[Any]], dict[str, Any]]]:
        """What each read returns of the settings that the node has. Raises ClientError."""
        settings = node.edition.client_facts.settings
        requests = [request for read in reads if (request := _made(node, read)) is not None]
        outcomes = yield from self._cycle_steps(requests, "", 1, None)
        return {
            type(outcome.request): {
                name: value
                for name, value in variables_of(outcome.get()).items()
                if any(name in write.VARIABLES.values() for write in settings[type(outcome.request)].values())
            }
            for outcome in outcomes
        }

    def _restore_steps(
        self, settings: Mapping[str, Any], number: int | None, kept: str, allow: str
    ) -> Steps[dict[str, tuple[Any, Any]]]:
        node = self._known(number)
        requests = node.edition.client_facts.settings
        present = yield from self._read_steps(node, requests)
        missing = settings.keys() - {name for values in present.values() for name in values}
        if missing:
            raise ValueError(f"{node!r} has no settings {', '.join(sorted(missing))}")
        writes: dict[type[Request[Any]], Request[Any]] = {}
        unread: set[type[Request[Any]]] = set()
        changed: dict[str, tuple[Any, Any]] = {}
        for read, values in present.items():
            wanted = values | {name: settings[name] for name in values if name in settings}
            differing = differences(values, wanted)
            if differing:
                how = next((how for how in ((kept,) if kept else KEPT) if how in requests[read]), None)
                if how is None:
                    raise ValueError(f"{node!r} has no request that writes {', '.join(differing)} with kept={kept!r}")
                write = requests[read][how]
                if how == "staged":  # no description states whether a read returns it
                    unread.add(read)
                request = node.make(write, **{field: wanted[name] for field, name in write.VARIABLES.items()})
                self._check_consent(node, request, allow)
                writes[read] = request
                changed |= differing
        outcomes = yield from self._cycle_steps([*writes.values()], allow, 1, None)
        replies = [variables_of(outcome.get()) for outcome in outcomes]
        replies += (yield from self._read_steps(node, writes.keys() - unread)).values()
        for values in replies:
            for name in changed.keys() & values.keys():
                if values[name] != changed[name][1]:
                    raise NotWritten(f"{name} of {node!r} is {values[name]!r} after {changed[name][1]!r} was written")
        return changed

    def _listen_steps(self, until: float) -> Steps[Message | None]:
        """The next frame that a node sent without a request; None if none came until then."""
        self._check_bus()
        while not self.unsolicited:
            now = time.monotonic()
            frame = yield min(until, now + LISTEN)
            if frame is not None:
                self._idle(frame)
            elif now >= until:
                return None
        return self.unsolicited.popleft()

    def _check_bus(self) -> None:
        if self._lost is not None:
            raise BusLost(f"{self._lost}; call reopen") from self._lost

    def _close_steps(self) -> Steps[None]:
        """Stops the nodes that were moved, and stops reading. Warns of each node that does not confirm it."""
        moved = [*self._moved] if self._on_exit != "nothing" else []
        jobs: dict[int, _Job] = {}
        for number in moved if self._lost is None else ():
            node = self.nodes[number]
            stop = node.edition.client_facts.ends_motion.get(ON_EXIT[self._on_exit])
            if stop is not None:
                request = node.make(stop)
                call = self._call(node, request, None)
                jobs[number] = _Job(self._lines[number], request, call, STOP_TRIES, at_once=True)
        if jobs:
            yield from self._exchange(list(jobs.values()))
        self._moved.clear()
        if self._notifier and self._reader:
            self._notifier.remove_listener(self._reader)
            self._reader = None
        unconfirmed = [number for number in moved if number not in jobs or jobs[number].error]
        if unconfirmed:
            text = f"nodes did not confirm {self._on_exit}, and may still move: {unconfirmed}"
            warnings.warn(text, stacklevel=2)


def _made(node: Node[Any, Any], read: type[Request[Any]]) -> Request[Any] | None:
    """A read for a node; None if the node does not have it."""
    try:
        return node.make(read)
    except CodecError:
        return None


def _check_replies(node: Node[Any, Any], request: type[Message]) -> None:
    """Raises CodecError if a reply cannot be decoded without a parameter that is unknown."""
    for kind in node.edition.replies_to(request):
        if kind.VARIANT_BY:
            places(kind, node.parameters)


def _decodable(node: Node[Any, Any], read: type[Request[Any]]) -> Request[Any] | None:
    """A read for a node; None if the node does not have it, or if its reply could not be decoded."""
    try:
        _check_replies(node, read)
    except CodecError:
        return None
    return _made(node, read)


def _bits(message: can.Message) -> int:
    """The bits of a classic frame, with the most stuff bits."""
    data = 0 if message.is_remote_frame else 8 * message.dlc
    stuffed = (54 if message.is_extended_id else 34) + data
    return stuffed + (stuffed - 1) // 4 + 13


def _is_full(error: Exception) -> bool:
    """Whether a frame was not sent only because the queue of the driver is full."""
    code = getattr(error, "error_code", None) or getattr(error, "errno", None)
    return isinstance(error, can.CanTimeoutError) or code in (errno.ENOBUFS, errno.EAGAIN)


class Client(ClientCore):
    """A client whose waiting thread reads the bus; several threads can use it.

    Leave it with `with`: then the nodes that were moved are stopped.
    """

    def _use(self, bus: can.BusABC) -> None:
        super()._use(bus)
        self._drive(self._settle(self._lines.values()))

    def _drive(self, steps: Steps[T]) -> T:
        """Waits for the bus between steps."""
        with self._lock:
            receive, clock = self._receiver(), time.monotonic
            try:
                until = next(steps)
                while True:
                    try:
                        message = receive(max(0.0, until - clock()))
                    except (can.CanError, OSError, ValueError) as error:
                        until = steps.throw(BusLost(f"the bus does not work: {error}"))
                    except BaseException as error:  # such as KeyboardInterrupt: open requests end
                        until = steps.throw(error)
                    else:
                        until = steps.send(message)
            except StopIteration as stop:
                return cast("T", stop.value)

    def request(self, request: Request[R], *, allow: str = "", tries: int = 1, timeout: float | None = None) -> R:
        """The reply to a request. Raises ClientError: NoReply, NotSent, Unproven, BusLost, ConsentError.

        `allow="wear"` or `"contact"` permits an effect of this request. `timeout` in seconds replaces the usual one.
        """
        return self.cycle((request,), allow=allow, tries=tries, timeout=timeout)[0].get()

    def cycle(
        self, requests: Sequence[Request[R]], *, allow: str = "", tries: int = 1, timeout: float | None = None
    ) -> list[Outcome[R]]:
        """Sends requests to all nodes at once and waits for all; the outcome of each, in the same order."""
        return self._drive(self._cycle_steps(requests, allow, tries, timeout))

    def gather(self, request: Request[R], *, allow: str = "", timeout: float | None = None) -> list[R]:
        """The replies of several nodes, or of several frames, to one request: those that came in time."""
        return self._drive(self._gather_steps(request, allow, timeout))

    def send(self, request: Request[Any], *, allow: str = "") -> None:
        """Sends a request that nodes do not answer. Raises ClientError."""
        self._drive(self._send_steps(request, allow))

    def dump(self, node: int | None = None) -> dict[str, Any]:
        """The settings of a node, by the names of its variables, in the units of their fields. Raises ClientError."""
        return self._drive(self._dump_steps(node))

    def restore(
        self, settings: Mapping[str, Any], node: int | None = None, *, kept: str = "", allow: str = ""
    ) -> dict[str, tuple[Any, Any]]:
        """Writes those settings of a dump that differ in a node, and reads them back; each with the value before and the new one.

        `kept` selects the requests that write: to `ram`, to `rom`, or `staged`, which another request has to save; without it,
        the first of `ram`, `staged` and `rom` that there is. Raises ValueError, ConsentError or CodecError before anything is
        written, and ClientError: NotWritten if the node has another value then.
        """
        return self._drive(self._restore_steps(settings, node, kept, allow))

    def every(self, rate: float) -> Iterator[int]:
        """The number of each period, `rate` times a second, at absolute times; missed periods are left out and counted.

        Warns if the frames of the first period need more time on the wire than there is.
        """
        periods = self._periods(rate, time.monotonic(), self._bits)
        yield 0
        for number, pause in periods:
            time.sleep(pause)
            yield number

    def receive(self, seconds: float = math.inf) -> Iterator[Message]:
        """The frames that nodes send without a request, as they come, for a time in seconds. Raises BusLost.

        Requests of other threads wait meanwhile; frames that come while a request is open are kept.
        """
        until = time.monotonic() + seconds
        while (message := self._drive(self._listen_steps(until))) is not None:
            yield message

    def reopen(self, bus: can.BusABC) -> None:
        """Starts again with another bus object, after BusLost. Nothing is known of the nodes."""
        with self._lock:
            self._use(bus)

    def close(self) -> None:
        """Stops the nodes that were moved, and stops reading. Warns of each node that does not confirm it."""
        self._drive(self._close_steps())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
