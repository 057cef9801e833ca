"""Requests and replies of one node, without I/O and without a clock: the rules of every client.

`Line.open`, `feed`, `tick` and `not_sent` return the call to send next, if there is one. `Line.deadline` is when to call `tick`.
Times are seconds of any clock. `Line._exchange` has the steps of a request, in their order.

One request of a node is in flight; others wait for it. After a missing reply the line is uncertain: that reply may still come. Before the next
request, and before a second try, a read whose reply cannot be mistaken for an owed one has to answer. A node that answers in
order sends nothing older after that.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from typing import Any

Frame = tuple[int, bool, bool, bool, bytes]
"""Id, whether it has 29 bits, whether it is a remote frame, whether it is one of CAN FD, and data."""

QUIET = 50
"""A node that owes the reply to every read is left alone for this many time-outs."""
PAUSE = 10
"""A node that did not answer the last MISSES calls is left alone for this many time-outs."""
MISSES = 12
LATER_COPY = 0.05
"""The longest time from a reply to the copy of its request."""
FENCES = 2
"""The most reads that are sent to make a line certain before one request."""
MAX_COPIES = 1 << 12
"""The most frames that are expected to come back; more than the transmit queues of drivers contain."""

NO_REPLY, UNPROVEN, SILENT, NOT_SENT, ABORTED = "no_reply", "unproven", "silent", "not_sent", "aborted"


@dataclass(eq=False, kw_only=True)
class Call:
    """A request to send, and what became of it. One without replies is not sent; it only makes its line certain."""

    key: Any = None
    """What identifies its reply: calls with the same key have the same reply."""
    frame: Frame = (-1, False, False, False, b"")
    accept: Callable[[Frame], Any] = lambda frame: None
    """Finds its reply in a frame, or returns None."""
    timeout: float = 0.0
    frames: int = 0
    """The number of frames that answer it, at most."""
    is_read: bool = False
    """Whether it changes nothing in the node."""
    differs: bool = False
    """Whether its reply never equals its frame."""
    message: Any = None
    """What its program sends; None if it sends nothing, because another call has the same frame."""
    tries: int = 1
    at_once: bool = False
    """Whether it is sent on an uncertain line, too."""
    replies: list[Any] = field(default_factory=list)
    failure: str = ""
    """Why there is no reply."""
    at: float | None = None
    """When it ended."""


@dataclass
class Counters:
    """What happened on a bus since it was opened."""

    sent: int = 0
    answered: int = 0
    missing: int = 0
    """Requests and reads without a reply in time."""
    late: int = 0
    """Frames that came after their time-out, or that do not answer the open request."""
    early: int = 0
    """Replies that came sooner than two frames last."""
    foreign: int = 0
    """Frames of a node that owes none: those of another host, or duplicates."""
    unproven: int = 0
    """Frames that equal their request although it is unknown whether the bus returns own frames."""
    errors: int = 0
    """Error frames."""
    overruns: int = 0
    """Periods of `every` that were missed."""


@dataclass
class Copies:
    """The frames that a bus returns to their sender."""

    returned: bool | None = None
    """Whether it returns them; None if that is unknown."""
    expected: list[Frame] = field(default_factory=list)

    def add(self, frame: Frame) -> None:
        """A frame is sent."""
        if self.returned is not False and len(self.expected) < MAX_COPIES:
            self.expected.append(frame)

    def take(self, frame: Frame) -> bool:
        """Whether a frame is a copy that was expected; each counts once."""
        if frame in self.expected:
            self.expected.remove(frame)
            return True
        return False

    def learn(self, *, returned: bool) -> None:
        """A read has shown it, if that was unknown."""
        if self.returned is None:
            self.returned = returned
            if not returned:
                self.expected.clear()


@dataclass(eq=False, kw_only=True)
class Line:
    """The exchanges with one node."""

    reads: Sequence[Call]
    """Harmless requests."""
    alike: Callable[[Any, Any], bool]
    """Whether a frame can be the reply to the calls with both keys."""
    copies: Copies
    counters: Counters
    in_order: bool
    """Whether the node answers in the order of the requests."""
    timeout: float
    """The usual time-out."""
    floor: float = 0.0
    """The shortest time from a request to its reply."""
    claims: Callable[[Frame], bool] = lambda frame: False
    """Takes a frame that no request waits for, if the node sends such frames without a request."""
    is_certain: bool = False
    """Whether no older reply can come. At first it is unknown what an earlier program sent."""

    def __post_init__(self) -> None:
        self.deadline = math.inf
        """Infinite if no request is open."""
        self._waiting: deque[Call] = deque()
        self._call: Call | None = None
        """The open request."""
        self._steps: Generator[Call | None, bool | None, str]
        """The steps of the open request."""
        self._current: Call | None = None
        """The call whose reply is awaited: the open request, or a read before it."""
        self._owed: dict[Any, None] = {}
        """The keys of calls whose replies may still come."""
        self._now = self._sent_at = 0.0
        self._equal = self._misses = 0
        self._quiet_until = -math.inf

    def open(self, call: Call, now: float) -> Call | None:
        """Starts a request, after those that are open."""
        self._now = now
        self._waiting.append(call)
        return None if self._call else self._continue()

    def feed(self, frame: Frame, now: float) -> Call | None:
        """A frame that may come from this node."""
        self._now, current = now, self._current
        if self.copies.take(frame):
            self._equal += 1
        elif current is None or now < self._sent_at + self.floor:
            self._unexpected(frame)
        elif self.copies.returned is None and frame == current.frame:
            self._equal += 1
        elif (reply := current.accept(frame)) is not None:
            self.counters.answered += 1
            self._misses = 0
            if current is self._call:
                current.replies.append(reply)
                if len(current.replies) < current.frames:
                    return None
            return self._continue(is_answered=True)
        elif not self.claims(frame):
            self.counters.late += 1
        return None

    def tick(self, now: float) -> Call | None:
        """The deadline is reached."""
        self._now = now
        if self._current is not None:
            self.counters.missing += 1
            self._misses += 1
            if self._misses >= MISSES:
                self._rest(PAUSE)
            self._lose(self._current)
        return self._continue(is_answered=False)

    def not_sent(self, now: float) -> Call | None:
        """The call that was returned last could not be sent."""
        self._now = now
        if self._current is not None:
            self.copies.take(self._current.frame)
        self.counters.sent -= 1
        self._close(NOT_SENT)
        return self._continue()

    def abort(self, now: float) -> None:
        """Ends all requests; the reply to the open one may still come."""
        if self._call is not None:
            self._now = now
            self._waiting.clear()
            if self._current is not None:
                self._lose(self._current)
            self._close(ABORTED)

    def _continue(self, *, is_answered: bool | None = None) -> Call | None:
        """Takes the next step of the open request, or of those that wait if it ends; returns what to send."""
        while self._call is not None or self._waiting:
            if self._call is None:
                self._call = self._waiting.popleft()
                self._steps, is_answered = self._exchange(self._call), None
            try:
                self._current = self._steps.send(is_answered)
                return self._current
            except StopIteration as end:
                self._close(end.value)
        return None

    def _exchange(self, call: Call) -> Generator[Call | None, bool | None, str]:
        """The steps of a request: each yields a call to send, and receives whether it was answered in time.

        Returns why there is no reply.
        """
        reads, is_sent = FENCES, False
        while True:
            sent = call if call.at_once and not is_sent else self._next_call(call)
            if sent is None or (sent is not call and not reads):
                return NO_REPLY if is_sent else SILENT
            if sent is not call:
                reads -= 1
            elif call.frames:
                call.tries -= 1
                is_sent = True
            else:
                return ""
            self._sent_at, self.deadline, self._equal = self._now, self._now + sent.timeout, 0
            self.counters.sent += 1
            self.copies.add(sent.frame)
            if (yield sent) and sent.is_read:
                yield from self._make_certain(sent)
            if sent is call:
                if call.replies:
                    return ""
                if self._equal and self.copies.returned is None:
                    self.counters.unproven += 1
                    return UNPROVEN
                if not call.tries:
                    return NO_REPLY

    def _next_call(self, call: Call) -> Call | None:
        """A request if no older frame can be taken for its reply, else a read; None if the node has to be left alone."""
        needs_proof = self.copies.returned is None and any(read.differs for read in self.reads)
        if self.is_certain and not needs_proof:
            return call
        if self._now < self._quiet_until:
            return None
        if not self.in_order:
            self._owed.clear()
        if not self.reads:
            self.is_certain = True
            return call
        for read in (call, *self.reads):
            is_usable = read.is_read and (read.differs or not needs_proof)
            if is_usable and not any(self.alike(read.key, owed) for owed in self._owed):
                return read
        self._owed.clear()
        self._rest(QUIET)
        return None

    def _make_certain(self, read: Call) -> Generator[None, bool | None, None]:
        """A read is answered: nothing older comes any more, and it is known whether the bus returned the read."""
        self._owed.clear()
        self.is_certain = True
        if self.copies.returned is None and read.differs:
            if not self._equal:  # its copy may still come
                self.deadline = self._now + LATER_COPY
                yield None
            self.copies.learn(returned=self._equal > 0)

    def _lose(self, call: Call) -> None:
        self._owed[call.key] = None
        self.is_certain = False
        if not self.in_order or not self.reads:
            self._rest(QUIET)

    def _rest(self, timeouts: int) -> None:
        self._quiet_until = max(self._quiet_until, self._now + timeouts * self.timeout)

    def _close(self, failure: str) -> None:
        assert self._call is not None, "a request is open"
        self._call.failure, self._call.at = failure, self._now
        self._call = self._current = None
        self.deadline = math.inf

    def _unexpected(self, frame: Frame) -> None:
        """A frame that no request waits for."""
        if self.claims(frame):
            return
        if self._current is not None:
            self.counters.early += 1
        elif self._owed or not self.is_certain:
            self.counters.late += 1
            if self._now < self._quiet_until:
                self._rest(QUIET)
        else:
            self.counters.foreign += 1
