"""A bus in virtual time for the client: nodes answer in order, and faults happen by rate and seed."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import can

Answer = Callable[[can.Message], Iterable[can.Message]]


@dataclass
class Clock:
    """Stands in for the module `time`."""

    now: float = 1000.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@dataclass
class VirtualTimeBus:
    """The host's side. `loss` is the share of lost frames, `late` that of replies after a stall, `twice` that of duplicates."""

    clock: Clock
    answer: Answer
    returned: bool = False
    round_trip: float = 0.0005
    """Seconds from a request to its reply."""
    loss: float = 0.0
    late: float = 0.0
    twice: float = 0.0
    seed: int = 1
    sent: list[can.Message] = field(default_factory=list)
    send_error: Exception | None = None
    recv_error: BaseException | None = None

    def __post_init__(self) -> None:
        self._arriving: deque[tuple[float, can.Message]] = deque()
        self._last = 0.0
        self._random = random.Random(self.seed)

    def send(self, message: can.Message) -> None:
        if self.send_error is not None:
            raise self.send_error
        self.clock.now += 0.00001
        self.sent.append(message)
        if self.returned:
            self._arrive(self.clock.now, message)
        chance = self._random.random
        if chance() < self.loss:
            return
        for reply in self.answer(message):
            if chance() < self.loss:
                continue
            at = self.clock.now + self.round_trip
            if chance() < self.late:
                at += self._random.expovariate(1 / 0.02)
            self._arrive(at, reply)
            if chance() < self.twice:
                self._arrive(at + 0.00013, reply)

    def put(self, message: can.Message) -> None:
        """A frame of another sender."""
        self._arrive(self.clock.now, message)

    def recv(self, timeout: float) -> can.Message | None:
        if self.recv_error is not None:
            raise self.recv_error
        until = self.clock.now + timeout
        if self._arriving and self._arriving[0][0] <= until:
            at, message = self._arriving.popleft()
            self.clock.now = max(self.clock.now, at)
            return message
        self.clock.now = until
        return None

    def _arrive(self, at: float, message: can.Message) -> None:
        """The order is kept: a frame behind a late one is late, too."""
        self._last = max(at, self._last)
        self._arriving.append((self._last, message))
