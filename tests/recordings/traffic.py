"""Simulated traffic of one host and some nodes, with the true direction of each frame.

The host sends requests, and each node replies within the time of the spec. An exchange fails in a share of cases: either
the node does not receive the request, or its reply is damaged; the log then has the request only. The host waits, and
may repeat the request. Raw integers are at 0 in one case of ten, near 0 in three, and anywhere in the range otherwise.
"""

from __future__ import annotations

import heapq
import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Command, Direction, Message
from canwright.model.refusal import Refusal
from canwright.recordings import candump
from canwright.recordings.log_frame import Counts, LogFrame, Mark
from canwright.semantics.encoder import Encoder
from canwright.semantics.frame import CanFrame, Raw

FRAME = 111_000
"""The time of a frame of 8 bytes at 1 Mbit/s, in ns."""
TIMEOUT = (600_000, 1_800_000)
"""The time after which the host repeats a request or continues, in ns."""
RETRIES = 3
START = 1_700_000_000_000_000_000


def in_cycles(*cycles: str) -> list[LogFrame]:
    """The frames of cycles of 10 ms: each is an offset in microseconds, its text, and its mark."""
    lines = []
    for number, cycle in enumerate(cycles):
        for frame in cycle.split(", "):
            offset, *text = frame.split()
            lines.append(f"({1 + number // 100}.{number % 100 * 10_000 + int(offset):06}) can0 {' '.join(text)}\n")
    return list(candump.read(lines, Counts()))


class _Wanted(NamedTuple):
    """A frame and the earliest time at which it is sent."""

    time: int
    frame: CanFrame
    direction: Direction


class Sent(NamedTuple):
    """A frame as the log has it, with its true direction."""

    recorded: LogFrame
    direction: Direction


@dataclass(frozen=True)
class Loss:
    """The share of exchanges that fail, whether the host repeats them, and the share of frames that the log lacks."""

    failed: float = 0.0
    has_retries: bool = False
    not_recorded: float = 0.0


MIXES = ("control", "polling", "mixed")
"""Control: one command with a value to all nodes, again and again, and their replies. Polling: all commands without
a value to one node after the other. Mixed: any command to any node, broadcasts and parameter writes included."""


class Traffic:
    """Traffic on one bus. Equal seeds give equal traffic."""

    def __init__(
        self, edition: Edition, mix: str, seed: int, *, loss: Loss = Loss(), nodes: int = 8, bus: str = "can0"
    ) -> None:
        self._edition, self._mix, self._loss, self._bus = edition, mix, loss, bus
        self._chance = random.Random(seed)
        self._encoder = Encoder(
            {p.name: p.values[-1].name if p.values else str(p.minimum or 1) for p in edition.parameters}
        )
        within = edition.bus.reply_within_ms
        self._within = 400_000 if within is None else int(within * 1_000_000)
        self._count = nodes
        self._commands = self._of_mix(mix)
        self._clock = START
        self._turns = 0

    def frames(self, exchanges: int) -> list[Sent]:
        """The frames of some exchanges, in the order of the bus."""
        wanted: list[_Wanted] = []
        while exchanges > 0:
            wanted += self._turn()
            exchanges -= self._count if self._mix == "control" else 1
        free, sent = 0, []
        for time, frame, direction in sorted(wanted, key=lambda entry: entry.time):
            free = max(time, free + FRAME)
            if self._chance.random() >= self._loss.not_recorded:
                sent.append(Sent(LogFrame(free, self._bus, frame, None), direction))
        return sent

    def _turn(self) -> Iterator[_Wanted]:
        """The frames until the host sends the next requests: one exchange, or one with each node."""
        end = self._clock
        count = self._count if self._mix == "control" else 1
        for number in range(count):
            turn, self._turns = self._turns, self._turns + 1
            command = self._chance.choice(self._commands)
            node = turn % self._count
            if self._mix == "polling":
                command = self._commands[turn % len(self._commands)]
                node = turn // len(self._commands) % self._count
            exchange = list(self._exchange(command, node, self._clock + number * FRAME))
            end = max(end, exchange[-1].time)
            yield from exchange
        self._clock = end + self._chance.randint(10_000, 300_000)

    def _exchange(self, command: Command, index: int, time: int) -> Iterator[_Wanted]:
        """The frames of a request to one of the nodes and of its replies, with repeated requests."""
        if command.request is None:
            if command.reply is not None:
                yield _Wanted(time, self._frame(command.reply, index, index), Direction.REPLY)
            return
        request = self._frame(command.request, index, index)
        for _ in range(1 + RETRIES * self._loss.has_retries):
            yield _Wanted(time, request, Direction.REQUEST)
            replies = list(self._replies(command, request, index, time))
            yield from replies
            if replies or command.reply is None:
                return
            time += self._chance.randint(*TIMEOUT)

    def _replies(self, command: Command, request: CanFrame, index: int, time: int) -> Iterator[_Wanted]:
        reply = command.reply
        for node in command.from_each or (None,) if reply else ():
            time += self._chance.randint(20_000, self._within)
            if reply is not None and self._chance.random() >= self._loss.failed:
                frame = self._frame(reply, index, index, node)
                frame = frame._replace(data=request.data) if command.is_echoed else frame
                yield _Wanted(time, frame, Direction.REPLY)

    def _frame(self, message: Message, index: int, reported: int, node: int | None = None) -> CanFrame:
        """A frame of a message with random raw integers, to or from one of the first nodes."""
        nodes = message.id.nodes
        to = (nodes[index % len(nodes)] if node is None else node) if nodes is not None else None
        about = message.node_bits
        while True:
            raws: dict[str, Raw] = {}
            for name, field in (self._encoder.fields(message) or {}).items():
                each = [self._raw(field) for _ in field.elements]
                raws[name] = each if field.is_array else each[0]
            if about is not None:
                raws[about.name] = reported if node is None else node
            frame = self._encoder.encode_raws(message, to, raws)
            if isinstance(frame, CanFrame):
                return frame
            assert frame.reason is Refusal.WRONG_MESSAGE, frame

    def _raw(self, field: Field) -> int:
        type_, chance = field.type, self._chance
        low, high = type_.raw_limits
        span, draw = type_.raw_range.at(self._encoder.assignment), chance.random()
        if type_.plausible is not None:
            ends = [
                self._encoder.nearest_raw(field, end.constant) for end in (type_.plausible.low, type_.plausible.high)
            ]
            low, high = (end if isinstance(end, int) else limit for end, limit in zip(ends, (low, high), strict=True))
        elif type_.enum:
            return chance.choice(type_.enum).value
        elif type_.flags:
            return 1 << chance.choice(type_.flags).value if draw < 0.1 else 0
        elif span is not None and span.is_constant:
            low, high = math.ceil(span.low.constant), math.floor(span.high.constant)
        if draw < 0.4:
            low, high = max(low, -99 if draw < 0.3 else 0), min(high, 99 if draw < 0.3 else 0)
        raw = chance.randint(low, max(low, high))
        return next(candidate for candidate in (raw, 0, 1) if self._encoder.rejects_raw(field, candidate) is None)

    def _of_mix(self, mix: str) -> list[Command]:
        commands = [c for c in self._edition.commands if c.available(self._encoder.assignment)]
        answered = [c for c in commands if c.request is not None and c.reply is not None]
        if mix == "control":
            valued = [c for c in answered if not c.is_echoed and c.request and c.request.layout.fields]
            return (valued or answered or commands)[:1]
        if mix == "polling":
            return [c for c in answered if c.request and not c.request.layout.fields] or commands
        return commands


def together(logs: Sequence[Sequence[Sent]]) -> list[Sent]:
    """Several logs as one, in the order of their times."""
    return list(heapq.merge(*logs, key=lambda sent: sent.recorded.time or 0))


def with_clock_jumps(log: Sequence[Sent], seed: int, every: int = 1000) -> list[Sent]:
    """A log whose clock jumps by up to 10 s forwards or backwards, once in about `every` frames."""
    chance, offset, jumped = random.Random(seed), 0, []
    for sent in log:
        if chance.random() * every < 1:
            offset += chance.choice((-1, 1)) * int(10 ** chance.uniform(5, 10))
        time = None if sent.recorded.time is None else sent.recorded.time + offset
        jumped.append(sent._replace(recorded=sent.recorded._replace(time=time)))
    return jumped


def with_marks(log: Sequence[Sent]) -> list[Sent]:
    """A log with the marks of a recorder on the host."""
    marks = {Direction.REQUEST: Mark.SENT, Direction.REPLY: Mark.RECEIVED}
    return [sent._replace(recorded=sent.recorded._replace(mark=marks[sent.direction])) for sent in log]
