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
from collections.abc import Callable, Coroutine, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import can

from ._codec import CodecError, Message, Request, places
from .exchange import NO_REPLY, NOT_SENT, SILENT, UNPROVEN, Call, Copies, Counters, Frame, Line
from .nodes import Node, Numbering
from .python_can import decoded, frame_of, to_message

if TYPE_CHECKING:
    from typing_extensions import Self

R = TypeVar("R", bound=Message)
T = TypeVar("T")

MOTION = "motion"
TIMEOUT = 0.02
"""The time in seconds that adapter, driver and scheduler may add to the time of the reply."""
LISTEN = 0.1
"""The longest time in seconds that listening waits at once, so that an interrupt ends it on every system."""
BACKLOG = 0.2
"""The longest time in seconds after a deadline to read on, because a program that was held up finds its replies behind others."""
STOP_TRIES = 3
BUS_ERRORS = can.CanError, OSError, ValueError
"""What a bus raises that does not work; ValueError after it was closed."""
ON_EXIT = {"stop": "stop", "off": "switch_off", "nothing": ""}
"""What ends the motion of a node at the end, by the argument `on_exit`."""


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

    def __init__(self, request: object, effect: str, consent: str) -> None:
        self.reason = f"{request} was not sent. {effect}"
        """What was not sent, and the effect."""
        self.consent = consent
        """What would allow it."""
        where = "the client or the call" if consent == MOTION else "the call"
        super().__init__(f'{self.reason}. To allow this, give {where} allow="{consent}"')


FAILURES: Mapping[str, tuple[type[ClientError], str]] = {
    NO_REPLY: (NoReply, "no reply to {}"),
    NOT_SENT: (NotSent, "{} was not sent: the queue of the driver is full"),
    SILENT: (NotSent, "{} was not sent, because the node does not answer"),
    UNPROVEN: (Unproven, "no proven reply to {}: the same frame came back, which may be a copy that the bus returned"),
}


@dataclass
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
        raw: Any = request.raw().get(field)
        elements: Sequence[Any] = raw if hasattr(raw, "__iter__") else (raw,)
        exempt = [values.get(element, ()) for element in elements]
        names = tuple([name for name in names if not all(name in absent for absent in exempt)])
    return names


@dataclass(eq=False, kw_only=True)
class _Job(Call):
    """The call of a request to a node."""

    node: Node[Any, Any]
    request: Request[Any] | None = None
    moves: bool = False
    ends_motion: bool = False
    error: ClientError | None = None

    def outcome(self, now: float) -> Outcome[Any]:
        """What became of the request until now."""
        if self.failure and self.error is None:
            kind, text = FAILURES[self.failure]
            self.error = kind(text.format(self.request or "a read"))
        return Outcome(cast("Request[Any]", self.request), tuple(self.replies), self.error, self.at or now)


class ClientCore:
    """What clients with and without asyncio have in common. Its coroutines wait for the bus in `_next_frame` only.

    Here that blocks, so they never suspend; a client for asyncio replaces it.
    """

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
        self.nodes: dict[int, Node[Any, Any]] = {}
        for node in nodes:
            if node.node in self.nodes:
                raise ValueError(f"{self.nodes[node.node]!r} and {node!r} have the same number")
            self.nodes[node.node] = node
        self._allowed: Mapping[int, str] = dict.fromkeys(self.nodes, allow) if isinstance(allow, str) else allow
        if not {"", MOTION}.issuperset(self._allowed.values()):
            raise ValueError(f"allow={allow!r} is not {MOTION}; give other consents with each request")
        if on_exit not in ON_EXIT:
            raise ValueError(f"on_exit={on_exit!r} is none of {', '.join(ON_EXIT)}")
        self.counters = Counters()
        self.unsolicited: deque[Message] = deque(maxlen=4096)
        """Frames that nodes sent without a request, the oldest first; only the latest are kept."""
        self._numbering = Numbering()
        self._on_exit = on_exit
        self._timeout = timeout
        self._bit_rate = bit_rate
        self._own_frames = own_frames
        self._bits = 0
        """Of the frames sent, and of as many replies; 0 without a bit rate."""
        self._moved: set[int] = set()
        self._jobs: Callable[..., tuple[Sequence[tuple[str, str]], partial[_Job]]] = cache(self._jobs_of)
        self._lock = threading.RLock()
        self._notifier = notifier
        self._reader = can.BufferedReader()
        if notifier:
            notifier.add_listener(self._reader)
        self._use(bus)

    def _use(self, bus: can.BusABC) -> None:
        """Nothing is known of the nodes, and of what the bus returns."""
        self.bus = bus
        self._lost: BusLost | None = None
        self._until = math.inf
        """When the next deadline of a line is, or sooner."""
        self._lines: dict[int, Line] = {}
        self._lines_of_id: dict[tuple[int, bool], list[Line]] = {}
        self._lines_without_id: list[Line] = []
        """Those of nodes that the data or a part of the id decides on."""
        copies, no_copies = Copies(self._own_frames), Copies(returned=False)
        for number, node in self.nodes.items():
            reads: list[_Job] = []
            for read in node.edition.client_facts.reads:
                with suppress(CodecError):  # the node does not have it, or its reply could not be decoded
                    reads.append(self._job(node, node.make(read)))
            ids = [*node.ids_of("reply")]
            sent, received = ({each[::2] for each in those} for those in (node.ids_of("request"), ids))
            line = self._lines[number] = Line(
                reads=reads,
                alike=node.edition.share_a_reply,
                copies=copies if sent & received or not received else no_copies,
                counters=self.counters,
                in_order=node.edition.client_facts.answers_in_order,
                timeout=self._timeout,
                floor=2 * 111 / self._bit_rate if self._bit_rate else 0.0,  # bits with 8 bytes, without stuff bits
                claims=partial(self._claims, node),
            )
            self._lines_of_id |= {(can_id, extended): [line] for can_id, mask, extended, _ in ids if not mask}
            if not ids or any(mask for _, mask, _, _ in ids):
                self._lines_without_id.append(line)

    def _claims(self, node: Node[Any, Any], frame: Frame) -> bool:
        """Stores a frame that nodes send without a request."""
        message = decoded(node.decode_reply, frame)
        if message is None or not (message.TITLE or {"cyclic", "on_change", "event"} & {*message.SENT}):
            return False
        self.unsolicited.append(message)
        return True

    def _node(self, number: int | None) -> Node[Any, Any]:
        """The node of a number; without a number the only node. Raises ValueError."""
        if number is None and len(self.nodes) == 1:
            return next(iter(self.nodes.values()))
        if number is None or number not in self.nodes:
            raise ValueError(f"node={number} is none of this client; give one of {[*self.nodes]}")
        return self.nodes[number]

    def _jobs_of(
        self, node: Node[Any, Any], kind: type[Any], effects: Sequence[str]
    ) -> tuple[Sequence[tuple[str, str]], partial[_Job]]:
        """Of requests of a class with these effects: those that need more than the consent of the client, and their jobs.

        Raises TypeError for another edition, and CodecError if the node lacks the command or its reply could not be decoded.
        """
        edition, facts = node.edition, node.edition.client_facts
        node.check(kind)
        ends_motion = kind in facts.ends_motion.values()  # this needs no consent, and its reply does not matter
        for reply in () if ends_motion else edition.replies_to(kind):
            places(reply, node.parameters)
        consents = [facts.effects[name][:2] for name in effects]
        given = "none", self._allowed.get(node.node)
        return [pair for pair in consents if pair[1] not in given and not ends_motion], partial(
            _Job,
            key=kind,
            timeout=self._timeout + (kind.REPLY_WITHIN_MS or edition.REPLY_WITHIN_MS or 0.0) / 1000,
            frames=kind.REPLIES or 1,
            is_read=not effects and bool(facts.effects),
            differs=kind.DIFFERS,
            node=node,
            moves=any(consent == MOTION for _, consent in consents),
            ends_motion=ends_motion,
        )

    def _job(self, node: Node[Any, Any], request: Request[Any], timeout: float | None = None, allow: str = "") -> _Job:
        """The job of a request. Raises ConsentError, and TypeError and CodecError as `_jobs_of` does."""
        needed, job_of = self._jobs(node, type(request), effects_of(request))
        for title, consent in needed:
            if consent not in allow.split():
                raise ConsentError(request, title, consent)
        message = to_message(request)
        answer = partial(node.edition.decode_answer, request, parameters=node.parameters)
        job = job_of(frame=frame_of(message), accept=partial(decoded, answer), message=message, request=request)
        job.timeout = job.timeout if timeout is None else timeout
        return job

    # Frames

    async def _next_frame(self, until: float) -> can.Message | None:
        """The next frame; None if there is none until then, or if the wait ended before. Raises BusLost."""
        return self._receive(max(0.0, until - time.monotonic()))

    def _receive(self, seconds: float) -> can.Message | None:
        """The next frame; None if there is none for a time in seconds. Raises BusLost."""
        try:
            return self._reader.get_message(seconds) if self._notifier else self.bus.recv(seconds)
        except BUS_ERRORS as error:
            raise self._bus_lost(error) from error

    def _transmit(self, message: can.Message) -> bool:
        """Sends a frame; whether the queue of the driver had room for it. Raises BusLost."""
        if self._bit_rate:
            self._bits += 2 * _bits(message)
        try:
            self.bus.send(message)
        except (can.CanError, OSError) as error:
            code = getattr(error, "error_code", None) or getattr(error, "errno", None)
            if isinstance(error, can.CanTimeoutError) or code in (errno.ENOBUFS, errno.EAGAIN):
                return False
            raise self._bus_lost(error) from error
        return True

    def _bus_lost(self, error: Exception) -> BusLost:
        self._lost = BusLost(f"the bus does not work: {error}")
        return self._lost

    def _check_bus(self) -> None:
        if self._lost is not None:
            raise BusLost(f"{self._lost}; call reopen") from self._lost

    def _feed(self, message: can.Message, now: float) -> None:
        """Gives a frame to the lines that it may belong to."""
        if message.is_error_frame:
            self.counters.errors += 1
            return
        frame = frame_of(message)
        for line in self._lines_of_id.get(frame[:2], self._lines_without_id):
            self._send_calls(line, line.feed(frame, now), now)

    def _send_calls(self, line: Line, call: Call | None, now: float) -> None:
        """Sends what a line asks for, and keeps its deadline."""
        while call is not None and call.message is not None and not self._transmit(call.message):
            call = line.not_sent(now)
        self._until = min(self._until, line.deadline)

    def _tick(self, lines: Iterable[Line], now: float) -> None:
        """The next deadline is reached."""
        for line in lines:
            if now >= line.deadline:
                self._send_calls(line, line.tick(now), now)
        self._until = min([line.deadline for line in lines])

    # What the methods of both clients do

    async def _exchange(self, jobs: Sequence[_Job]) -> list[Outcome[Any]]:
        """Exchanges with all nodes at once, and with one node one after the other; jobs with an error are left out."""
        self._check_bus()
        clock = time.monotonic
        pending = [job for job in jobs if job.error is None]
        lines = dict.fromkeys([self._lines[job.node.node] for job in pending])
        self._until = math.inf
        try:
            while (frame := self._receive(0.0)) is not None:  # what came before is no reply
                self._feed(frame, clock())
            for job in pending:
                line, now = self._lines[job.node.node], clock()
                self._send_calls(line, line.open(job, now), now)
            for job in pending:
                while job.at is None:
                    frame = await self._next_frame(self._until)
                    now = clock()
                    if frame is not None:
                        self._feed(frame, now)
                    if now >= self._until + (BACKLOG if frame is not None else 0.0):
                        self._tick(lines, now)
        except BusLost as error:
            for job in pending:
                job.error = error if job.at is None else None
        finally:
            now = clock()
            for line in lines:
                line.abort(now)
            for job in pending:
                self._note_motion(job, is_ended=job.ends_motion and bool(job.replies))
        return [job.outcome(now) for job in jobs]

    def _note_motion(self, job: _Job, *, is_ended: bool) -> None:
        """Stores whether a node has to be stopped at the end."""
        if is_ended:
            self._moved.discard(job.node.node)
        elif job.moves:
            self._moved.add(job.node.node)

    async def _settle(self, nodes: Iterable[Node[Any, Any]]) -> ClientError | None:
        """Makes the lines of nodes certain with a read each. Returns the first error."""
        outcomes = await self._exchange([_Job(node=node) for node in nodes if not self._lines[node.node].is_certain])
        return next((outcome.error for outcome in outcomes if outcome.error), None)

    async def _cycle(
        self, requests: Sequence[Request[R]], allow: str = "", tries: int = 1, timeout: float | None = None
    ) -> list[Outcome[R]]:
        jobs: list[_Job] = []
        for request in requests:
            if not request.REPLIES or request.REPLIERS:
                number = "several" if request.REPLIES else "no"
                raise TypeError(f"{request} has {number} replies; use send or gather")
            node = self._node(request.node)
            if tries > 1 and not _is_repeatable(node, request):
                raise ValueError(f"{request} cannot be repeated safely; leave out tries={tries}")
            try:
                job = self._job(node, self._numbering.next(request), timeout, allow)
            except ConsentError as error:
                job = _Job(node=node, error=error)
            except CodecError as error:
                job = _Job(node=node, error=NotSent(f"{request} was not sent: {error}"))
            job.request, job.tries = request, tries
            jobs.append(job)
        return await self._exchange(jobs)

    async def _settled(
        self, nodes: Sequence[Node[Any, Any]], request: Request[Any], allow: str, timeout: float | None = None
    ) -> list[_Job]:
        """The jobs of one request to several nodes, whose lines are certain."""
        request = self._numbering.next(request)
        jobs = [self._job(node, request, timeout, allow) for node in nodes]
        if error := await self._settle(nodes):
            raise NotSent(f"{request} was not sent, because a node does not answer") from error
        return jobs

    async def _gather(self, request: Request[R], allow: str, timeout: float | None) -> list[R]:
        nodes = [self.nodes[number] for number in request.REPLIERS if number in self.nodes]
        jobs = await self._settled(nodes or [self._node(request.node)], request, allow, timeout)
        for job in jobs[1:]:
            job.message = None
        return [reply for outcome in await self._exchange(jobs) for reply in outcome.replies]

    async def _send(self, request: Request[Any], allow: str) -> None:
        nodes = [*self.nodes.values()] if request.node is None else [self._node(request.node)]
        jobs = await self._settled(nodes, request, allow)
        for job in jobs:
            self._note_motion(job, is_ended=job.ends_motion)
        if not self._transmit(jobs[0].message):
            raise NotSent(f"{request} was not sent: the queue of the driver is full")
        self.counters.sent += 1

    def _periods(self, rate: float) -> Iterator[tuple[int, float]]:
        """The number of each period, and the time to wait for it; missed ones are left out and counted."""
        start, bits, number = time.monotonic(), self._bits, 0
        yield number, 0.0
        needed = (self._bits - bits) / self._bit_rate if self._bit_rate else 0.0
        if needed * rate > 1:
            text = f"need {needed * 1000:.2f} ms at {self._bit_rate} bit/s, more than {1000 / rate:.2f} ms"
            warnings.warn(f"the frames of a period {text}", stacklevel=3)
        while True:
            now = time.monotonic()
            due = max(number + 1, math.ceil((now - start) * rate))
            self.counters.overruns += due - number - 1
            number = due
            yield number, max(0.0, start + number / rate - now)

    async def _dump(self, number: int | None) -> dict[str, Any]:
        node = self._node(number)
        return await self._read(node, node.edition.client_facts.settings)

    async def _read(self, node: Node[Any, Any], reads: Iterable[type[Request[Any]]]) -> dict[str, Any]:
        """The settings of a node that some reads return. Raises ClientError."""
        requests: list[Request[Any]] = []
        for read in reads:
            with suppress(CodecError):  # the node does not have it
                requests.append(node.make(read))
        settings: dict[str, Any] = {}
        for outcome in await self._cycle(requests):
            written = _variables(node.edition.client_facts.settings[type(outcome.request)].values())
            settings |= {name: value for name, value in variables_of(outcome.get()).items() if name in written}
        return settings

    async def _restore(
        self, settings: Mapping[str, Any], number: int | None, kept: str, allow: str
    ) -> dict[str, tuple[Any, Any]]:
        node = self._node(number)
        facts = node.edition.client_facts.settings
        present = await self._read(node, facts)
        if missing := settings.keys() - present.keys():
            raise ValueError(f"{node!r} has no settings {', '.join(sorted(missing))}")
        wanted = {**present, **settings}
        changes = differences(present, wanted)
        writes: list[_Job] = []
        readable: list[type[Request[Any]]] = []
        """The reads that return what is written; no description states it of what is staged."""
        for read, requests in facts.items():
            if not (differing := changes.keys() & _variables(requests.values())):
                continue
            how = next((how for how in ([kept] if kept else ["ram", "staged", "rom"]) if how in requests), None)
            if how is None:
                raise ValueError(
                    f"{node!r} has no request that writes {', '.join(sorted(differing))} with kept={kept!r}"
                )
            values = {field: wanted[name] for field, name in requests[how].VARIABLES.items()}
            writes.append(self._job(node, node.make(requests[how], **values), allow=allow))
            readable += [read] if how != "staged" else []
        replies = [variables_of(outcome.get()) for outcome in await self._exchange(writes)]
        for values in (*replies, await self._read(node, readable)):
            for name in changes.keys() & values.keys():
                if values[name] != wanted[name]:
                    raise NotWritten(f"{name} of {node!r} is {values[name]!r} after {wanted[name]!r} was written")
        return changes

    async def _listen(self, until: float) -> Message | None:
        """The next frame that a node sent without a request; None if none came until then."""
        self._check_bus()
        while not self.unsolicited:
            now = time.monotonic()
            frame = await self._next_frame(min(until, now + LISTEN))
            if frame is not None:
                self._feed(frame, time.monotonic())
            elif now >= until:
                return None
        return self.unsolicited.popleft()

    async def _close(self) -> None:
        """Stops the nodes that were moved, and stops reading. Warns of each node that does not confirm it, or cannot be stopped.

        A request without a reply needs no confirmation, only to be sent.
        """
        jobs: list[_Job] = []
        lacking: list[int] = []
        for node in [self.nodes[number] for number in sorted(self._moved)]:
            stop = node.edition.client_facts.ends_motion.get(ON_EXIT[self._on_exit])
            if stop is None:
                lacking.append(node.node)
            elif self._lost is None:
                jobs.append(self._job(node, node.make(stop)))
                jobs[-1].tries, jobs[-1].at_once = STOP_TRIES, True
        if jobs:
            await self._exchange(jobs)
            unanswered = [job for job in jobs if job.request is not None and not job.request.REPLIES]
            self._moved -= {job.node.node for job in unanswered if job.failure == NO_REPLY}
        if self._notifier:
            self._notifier.remove_listener(self._reader)
            self._notifier = None
        unconfirmed, self._moved = sorted(self._moved.difference(lacking)), set()
        if unconfirmed:
            warnings.warn(f"nodes did not confirm {self._on_exit}, and may still move: {unconfirmed}", stacklevel=2)
        if lacking and self._on_exit != "nothing":
            text = (
                f"no request ends the motion of nodes with on_exit={self._on_exit!r}, so they may still move: {lacking}"
            )
            warnings.warn(text, stacklevel=2)


def _variables(writes: Iterable[type[Message]]) -> set[str]:
    """The variables of a node that some requests write."""
    return {name for write in writes for name in write.VARIABLES.values()}


def _is_repeatable(node: Node[Any, Any], request: Message) -> bool:
    """Whether a request can be sent again if no reply came."""
    effects = node.edition.client_facts.effects
    return all(effects[name][2] for name in effects_of(request)) if request.REPEAT is None else request.REPEAT


def _bits(message: can.Message) -> int:
    """The bits of a classic frame, with the most stuff bits."""
    data = 0 if message.is_remote_frame else 8 * message.dlc
    stuffed = (54 if message.is_extended_id else 34) + data
    return stuffed + (stuffed - 1) // 4 + 13


class Client(ClientCore):
    """A client whose waiting thread reads the bus; several threads can use it.

    Leave it with `with`: then the nodes that were moved are stopped.
    """

    def _use(self, bus: can.BusABC) -> None:
        super()._use(bus)
        self._run(self._settle(self.nodes.values()))

    def _run(self, steps: Coroutine[Any, Any, T]) -> T:
        """What the steps of a method return; they never suspend."""
        with self._lock:
            try:
                steps.send(None)
            except StopIteration as stop:
                return cast("T", stop.value)
        raise RuntimeError("the steps wait for more than the bus")

    def request(self, request: Request[R], *, allow: str = "", tries: int = 1, timeout: float | None = None) -> R:
        """The reply to a request. Raises ClientError: NoReply, NotSent, Unproven, BusLost, ConsentError.

        `allow="wear"` or `"contact"` permits an effect of this request. `timeout` in seconds replaces the usual one.
        """
        return self.cycle((request,), allow=allow, tries=tries, timeout=timeout)[0].get()

    def cycle(
        self, requests: Sequence[Request[R]], *, allow: str = "", tries: int = 1, timeout: float | None = None
    ) -> list[Outcome[R]]:
        """Sends requests to all nodes at once and waits for all; the outcome of each, in the same order."""
        return self._run(self._cycle(requests, allow, tries, timeout))

    def gather(self, request: Request[R], *, allow: str = "", timeout: float | None = None) -> list[R]:
        """The replies of several nodes, or of several frames, to one request: those that came in time."""
        return self._run(self._gather(request, allow, timeout))

    def send(self, request: Request[Any], *, allow: str = "") -> None:
        """Sends a request that nodes do not answer. Raises ClientError."""
        self._run(self._send(request, allow))

    def dump(self, node: int | None = None) -> dict[str, Any]:
        """The settings of a node, by the names of its variables, in the units of their fields. Raises ClientError."""
        return self._run(self._dump(node))

    def restore(
        self, settings: Mapping[str, Any], node: int | None = None, *, kept: str = "", allow: str = ""
    ) -> dict[str, tuple[Any, Any]]:
        """Writes those settings of a dump that differ in a node, and reads them back; each with the value before and the new one.

        `kept` selects the requests that write: to `ram`, to `rom`, or `staged`, which another request has to save; without it,
        the first of `ram`, `staged` and `rom` that there is. Raises ValueError, ConsentError or CodecError before anything is
        written, and ClientError: NotWritten if the node has another value then.
        """
        return self._run(self._restore(settings, node, kept, allow))

    def every(self, rate: float) -> Iterator[int]:
        """The number of each period, `rate` times a second, at absolute times; missed periods are left out and counted.

        Warns if the frames of the first period need more time on the wire than there is.
        """
        for number, pause in self._periods(rate):
            time.sleep(pause)
            yield number

    def receive(self, seconds: float = math.inf) -> Iterator[Message]:
        """The frames that nodes send without a request, as they come, for a time in seconds. Raises BusLost.

        Requests of other threads wait meanwhile; frames that come while a request is open are kept.
        """
        until = time.monotonic() + seconds
        while (message := self._run(self._listen(until))) is not None:
            yield message

    def reopen(self, bus: can.BusABC) -> None:
        """Starts again with another bus object, after BusLost. Nothing is known of the nodes."""
        with self._lock:
            self._use(bus)

    def close(self) -> None:
        """Stops the nodes that were moved, and stops reading. Warns of each node that does not confirm it."""
        self._run(self._close())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
