"""Nodes without hardware: they answer on a python-can bus as their edition says, and store what is written to them.

What a node does beyond that, such as moving, is a `Behaviour` that a program gives.
"""

from __future__ import annotations

import math
import random
import threading
import time
import warnings
from bisect import insort
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import can

from ._codec import ArrayType, CodecError, FieldType, Message, Refusal, Request, places
from .client import effects_of, value_of
from .exchange import Copies
from .nodes import Node, Numbering
from .python_can import frame_of, from_message, to_message

if TYPE_CHECKING:
    from typing_extensions import Self

POLL = 0.05
"""The longest time in seconds that a simulation waits for a frame before it looks whether it has to end."""


class Behaviour:
    """What a node does besides storing values. Override what you need; each node has an object of its own."""

    def command(self, node: SimulatedNode, request: Request[Any]) -> bool:
        """Executes a request, after its values are stored and before it is answered. False if the node does not answer.

        It is not called for a request with an effect that the state of the node prevents.
        """
        return True

    def step(self, node: SimulatedNode, seconds: float) -> None:
        """Changes `node.values` as time passes; called before each frame."""


@dataclass
class Faults:
    """How often, from 0 to 1, something goes wrong, and how. The same `seed` gives the same faults."""

    loss: float = 0.0
    """Frames that are lost: requests and replies."""
    late: float = 0.0
    """Replies that come `late_by` seconds later."""
    late_by: float = 0.05
    twice: float = 0.0
    """Replies that are sent twice."""
    corrupt: float = 0.0
    """Replies in which one bit of the data is wrong."""
    echo: float = 0.0
    """Requests that come back to their sender before the reply."""
    silence: float = 0.0
    """Requests after which the node is silent for `silent_for` seconds."""
    silent_for: float = 1.0
    power_loss: float = 0.0
    """Requests before which the node starts again, with the values that it had first."""
    seed: int = 1

    def __post_init__(self) -> None:
        for name, rate in vars(self).items():
            if name not in ("seed", "late_by", "silent_for") and not 0 <= rate <= 1:
                raise ValueError(f"{name}={rate!r} is no rate from 0 to 1")


class SimulatedNode:
    """One node, without a bus: `answer` returns its replies to a request.

    `values` are its variables: those that the specification names, table entries as `TABLE.ENTRY`, or `TABLE.ENTRY.FIELD` if
    they have several fields, and all other fields of replies by their names. A value is in the unit of the field, or the raw integer where it has none.
    `state` is one of the states of the edition.
    """

    def __init__(self, node: Node[Any, Any], behaviour: Behaviour | None = None, **values: Any) -> None:
        self.node = node
        self.behaviour = behaviour or Behaviour()
        self.silent_until = self.last_frame_at = -math.inf
        """Until when it does not send, and when it sends the last frame, by `time.monotonic()`."""
        self._kept = values
        self._numbering = Numbering()
        self.power_on()

    def __repr__(self) -> str:
        return f"SimulatedNode({self.node!r}, state={self.state!r}, values={self.values!r})"

    def start_with(self, values: Mapping[str, Any]) -> None:
        """Sets first values, which the node also has when it starts again."""
        self._kept |= values
        self.values |= values

    def power_on(self) -> None:
        """Starts again: with the first values and those that are kept after power-off, in the state after power-up."""
        self.values: dict[str, Any] = dict(self._kept)
        self._staged: dict[str, Any] = {}
        self.state = ""
        for state in [*self.node.edition.client_facts.states][:1]:
            self._enter(state)

    def _enter(self, state: str) -> None:
        self.state = state
        self.values |= self.node.edition.client_facts.states[state][2]

    def decode(self, frame: can.Message) -> Request[Any] | None:
        """The request to this node in a frame; None if it is none."""
        try:
            request: Request[Any] = from_message(frame, self.node.decode_request)
            self.node.check(type(request))
        except CodecError:
            return None
        is_asked = self.node.node in request.REPLIERS if request.REPLIERS else request.node in (None, self.node.node)
        return request if is_asked else None

    def answer(self, request: Request[Any]) -> list[Message]:
        """Executes a request, and returns the replies."""
        states = self.node.edition.client_facts.states
        prevented = states[self.state][1] if self.state else ()
        if not any(effect in prevented for effect in effects_of(request)):
            self._store(request)
            for state, (entering, _, _) in states.items():
                if type(request) in entering:
                    self._enter(state)
            if not self.behaviour.command(self, request):
                return []
        return self.frames(self.node.edition.replies_to(type(request)), request)[: request.REPLIES]

    def _store(self, request: Request[Any]) -> None:
        written: dict[str, Any] = {}
        for name, raw in request.raw().items():
            if name in request.VARIABLES and raw not in request.EXEMPT.get(name, {}):
                try:
                    written[request.VARIABLES[name]] = value_of(request, name)
                except CodecError:  # it has no scale
                    written[request.VARIABLES[name]] = raw
        self.values |= written
        effects = self.node.edition.client_facts.effects
        kept = {effects[name][3] for name in effects_of(request)}
        if "staged" in kept:
            self._staged |= written
        if "rom" in kept:
            self._kept |= written
        if "saved" in kept:
            self._kept |= self._staged

    def frames(self, kinds: Iterable[type[Message]], request: Request[Any] | None = None) -> list[Message]:
        """The frames of replies of some classes; none, with a warning, if the parameters of the node do not suffice."""
        frames: list[Message] = []
        try:
            for kind in kinds:
                numbers, part = getattr(kind, "FRAMES", range(1)), getattr(kind, "FRAME_FIELD", "")
                for number in numbers:
                    reply = self._reply(kind, request)
                    frames.append(self._numbering.next(reply.replace(**{part: number}) if part else reply))
        except CodecError as error:
            warnings.warn(f"{self.node!r} does not answer {request}: {error}", stacklevel=2)
            return []
        return frames

    def _reply(self, kind: type[Message], request: Request[Any] | None) -> Message:
        node, parameters = self.node.node, self.node.parameters
        raws = {name: self._raw(kind, name, request) for name in places(kind, parameters) if name is not None}
        if kind.NODE_FIELD:
            raws[kind.NODE_FIELD] = node & kind.NODE_MASK
        return kind.from_raw(node=node if hasattr(kind, "NODES") else None, parameters=parameters, **raws)

    def _raw(self, kind: type[Message], name: str, request: Request[Any] | None) -> Any:
        """The raw integer of a field: of its variable, of the same field of the request, or one that is valid."""
        type_, parameters = kind.TYPES[name], self.node.parameters
        variable = kind.VARIABLES.get(name, name)
        if variable in self.values:
            return _nearest_raw(type_, self.values[variable], parameters, name)
        if request is not None and request.TYPES.get(name) is type_ and name in request.fields():
            return request.raw()[name]
        return _valid_raw(type_, kind.PLAUSIBLE.get(name), parameters, name)


def _nearest_raw(type_: FieldType, value: Any, parameters: Any, name: str) -> Any:
    """The raw integer of a value; of one out of range the nearest limit. Raises CodecError, TypeError."""
    try:
        return type_.raw(value, parameters, name)
    except CodecError as error:
        if error.refusal in (Refusal.NO_SCALE, Refusal.MISSING_PARAMETER):
            return type_.check(value, parameters, name)
        if error.refusal is not Refusal.OUT_OF_RANGE or hasattr(value, "__iter__"):
            raise
        low, high = type_.value_range(parameters)
        return type_.raw_range(parameters)[0 if abs(value - low) < abs(value - high) else 1]


def _valid_raw(type_: FieldType, raw: int | None, parameters: Any, name: str) -> Any:
    """A valid raw integer, the given one if possible, or that of the value nearest to 0; of an array one for each element."""
    if isinstance(type_, ArrayType):
        return (_valid_raw(type_.type, raw, parameters, name),) * type_.count
    low, high = type_.raw_range(parameters)
    try:
        wanted = _nearest_raw(type_, 0, parameters, name) if raw is None else raw
    except (CodecError, TypeError):  # it is no number
        wanted = 0
    try:
        return type_.check(min(max(wanted, low), high), parameters, name)
    except CodecError:
        return low


class Simulation:
    """Nodes on a python-can bus, which the caller opens and closes.

    `behaviour` makes the behaviour of each node. Further arguments are first values of all nodes, by variable, such as
    `voltage=48`; those of one node are `simulation[1].values`. `delay` is the time in seconds from a request to its reply.
    `own_frames` states whether the bus object returns the frames that it sends.

    `with simulation:` answers in a thread until the end of the block, which raises what ended the thread before; `run` answers
    without one. Give the nodes of the client another bus object of the same channel.
    """

    def __init__(
        self,
        bus: can.BusABC,
        nodes: Iterable[Node[Any, Any]],
        behaviour: Callable[[], Behaviour] = Behaviour,
        *,
        delay: float = 0.0,
        faults: Faults | None = None,
        own_frames: bool = False,
        **values: Any,
    ) -> None:
        self.bus = bus
        self.nodes = {node.node: SimulatedNode(node, behaviour(), **values) for node in nodes}
        self.faults = faults or Faults()
        self.received = 0
        """Frames of hosts."""
        self.answered = 0
        """Replies that were sent."""
        self.rejected = 0
        """Frames that are no request to any of the nodes."""
        self._delay = delay
        self._copies = Copies(own_frames)
        self._random = random.Random(self.faults.seed)
        self._due: list[tuple[float, can.Message]] = []
        """What is sent, and when, in this order."""
        self._stepped = time.monotonic()
        self._cycles = {
            (node, kind): self._stepped
            for node in self.nodes.values()
            for kind in node.node.edition.client_facts.cyclic
        }
        self._is_ending = threading.Event()

    def __getitem__(self, number: int) -> SimulatedNode:
        return self.nodes[number]

    def run(self, seconds: float | None = None) -> None:
        """Answers for a time in seconds, or until an interrupt. Raises what the bus raises."""
        until = math.inf if seconds is None else time.monotonic() + seconds
        while not self._is_ending.is_set() and (now := time.monotonic()) < until:
            due = [*(at for at, _ in self._due[:1]), *self._cycles.values()]
            frame = self.bus.recv(max(0.0, min([POLL, until - now, *(at - now for at in due)])))
            now = time.monotonic()
            self.step(now)
            if frame is not None and not frame.is_error_frame and not self._copies.take(frame_of(frame)):
                self.receive(frame, now)
            self.flush(time.monotonic())

    def step(self, now: float) -> None:
        """Lets the time of all nodes pass, and sends the frames that they send without a request."""
        seconds, self._stepped = now - self._stepped, now
        for node in self.nodes.values():
            node.behaviour.step(node, seconds)
        for (node, kind), due in self._cycles.items():
            if due <= now:
                self._cycles[node, kind] = max(due + (kind.EVERY_MS or 0) / 1000, now)
                if node.silent_until <= now:
                    self._send(node, node.frames((kind,)), now)

    def receive(self, frame: can.Message, now: float) -> None:
        """Lets the nodes answer a frame."""
        self.received += 1
        faults, chance = self.faults, self._random.random
        asked = [(node, request) for node in self.nodes.values() if (request := node.decode(frame))]
        self.rejected += not asked
        if chance() < faults.loss:
            return
        for node, request in asked:
            if node.silent_until > now:
                continue
            if chance() < faults.power_loss:
                node.power_on()
            if chance() < faults.echo:
                self._queue(node, now, frame)
            self._send(node, node.answer(request), now)
            if chance() < faults.silence:
                node.silent_until = now + faults.silent_for

    def _send(self, node: SimulatedNode, replies: Iterable[Message], now: float) -> None:
        """Sends the replies of a node in their order, with faults."""
        faults, chance = self.faults, self._random.random
        for reply in map(to_message, replies):
            if chance() < faults.loss:
                continue
            if chance() < faults.corrupt and reply.data:
                bit = self._random.randrange(8 * len(reply.data))
                reply.data[bit // 8] ^= 1 << bit % 8
            at = now + self._delay + (faults.late_by if chance() < faults.late else 0.0)
            self._queue(node, at, reply)
            if chance() < faults.twice:
                self._queue(node, at, reply)

    def _queue(self, node: SimulatedNode, at: float, frame: can.Message) -> None:
        """A node answers in order: what comes after a late frame is late, too."""
        at = node.last_frame_at = max(at, node.last_frame_at)
        insort(self._due, (at, frame), key=itemgetter(0))

    def flush(self, now: float) -> None:
        """Sends the frames that are due. Raises what the bus raises."""
        while self._due and self._due[0][0] <= now:
            _, frame = self._due.pop(0)
            self._copies.add(frame_of(frame))
            self.answered += 1
            self.bus.send(frame)

    def __enter__(self) -> Self:
        self._is_ending.clear()
        self._running = ThreadPoolExecutor(1, "canwright simulation").submit(self.run)
        return self

    def __exit__(self, *_: object) -> None:
        self._is_ending.set()
        self._running.result()
