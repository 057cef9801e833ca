"""Requests and replies of one node, without I/O and without a clock: the rules of every client.

`Line.open`, `feed`, `tick` and `not_sent` return the call to send next, if there is one. `Line.deadline` is when to call `tick`.
Times are seconds of any clock.

One request of a node is in flight; others wait for it. After a missing reply the line is uncertain: that reply may still come. Before the next
request, and before a second try, a read whose reply cannot be mistaken for an owed one has to answer. A node that answers in
order sends nothing older after that.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
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


class Line:
    """The exchanges with one node.

    `reads` are harmless. `alike` returns for two keys whether a frame can be the reply to both. `shares_ids` is True if
    requests and replies have the same ids. `timeout` is the usual one, `floor` the shortest time from a request to its reply.
    `claims` takes a frame that no request waits for, and returns whether the node sends such frames without a request.
    """

    def __init__(
        self,
        reads: Sequence[Call],
        alike: Callable[[Any, Any], bool],
        copies: Copies,
        counters: Counters,
        *,
        shares_ids: bool,
        in_order: bool,
        timeout: float,
        floor: float = 0.0,
        claims: Callable[[Frame], bool] = lambda frame: False,
    ) -> None:
        self.deadline = math.inf
        """Infinite if no request is open."""
        self.is_certain = False
        """Whether no older reply can come. It is unknown what an earlier program sent."""
        self._reads = reads
        self._alike = alike
        self._copies = copies if shares_ids else Copies(returned=False)
        self._counters = counters
        self._in_order = in_order
        self._timeout = timeout
        self._floor = floor
        self._claims = claims
        self._waiting: deque[Call] = deque()
        self._call: Call | None = None
        """The open request."""
        self._current: Call | None = None
        """The call whose reply is awaited: the open request, or a read before it."""
        self._is_sent = False
        """Whether the open request was sent."""
        self._owed: dict[Any, None] = {}
        self._sent_at = 0.0
        self._equal = self._fences = self._misses = 0
        self._quiet_until = -math.inf

    def open(self, call: Call, now: float) -> Call | None:
        """Starts a request, after those that are open."""
        self._waiting.append(call)
        return self._next(now)

    def feed(self, frame: Frame, now: float) -> Call | None:
        """A frame that may come from this node."""
        current = self._current
        if self._copies.take(frame):
            self._equal += 1
        elif current is None or now < self._sent_at + self._floor:
            self._unexpected(frame, now)
        elif self._copies.returned is None and frame == current.frame:
            self._equal += 1
        elif (reply := current.accept(frame)) is not None:
            self._counters.answered += 1
            self._misses = 0
            return self._answered(current, reply, now) or self._next(now)
        elif not self._claims(frame):
            self._counters.late += 1
        return None

    def tick(self, now: float) -> Call | None:
        """The deadline is reached."""
        current, call = self._current, self._call
        assert call is not None, "a request is open"
        if current is None:  # the time in which a copy of the read can come is over
            self._copies.learn(returned=self._equal > 0)
            return self._continue(call, now) or self._next(now)
        self._counters.missing += 1
        self._misses += 1
        if self._misses >= MISSES:
            self._rest(now, PAUSE)
        self._lose(current, now)
        if current is call and call.replies:
            self._close(now)
        elif current is call and self._equal and self._copies.returned is None:
            self._counters.unproven += 1
            self._close(now, UNPROVEN)
        elif current is not call or call.tries:
            return self._make_certain(call, now) or self._next(now)
        else:
            self._close(now, NO_REPLY)
        return self._next(now)

    def not_sent(self, now: float) -> Call | None:
        """The call that was returned last could not be sent."""
        if self._current is not None:
            self._copies.take(self._current.frame)
        self._counters.sent -= 1
        self._close(now, NOT_SENT)
        return self._next(now)

    def abort(self, now: float) -> None:
        """Ends all requests; the reply to the open one may still come."""
        self._waiting.clear()
        if self._current is not None:
            self._lose(self._current, now)
        if self._call is not None:
            self._close(now, ABORTED)

    def _next(self, now: float) -> Call | None:
        """Starts the next request if none is open."""
        sent = None
        while self._call is None and self._waiting:
            call = self._call = self._waiting.popleft()
            self._fences, self._is_sent = FENCES, False
            is_ready = call.at_once or (self.is_certain and not self._needs_proof())
            sent = self._request(call, now) if is_ready else self._make_certain(call, now)
        return sent

    def _request(self, call: Call, now: float) -> Call | None:
        if not call.frames:
            self._close(now)
            return None
        call.tries -= 1
        self._is_sent = True
        return self._send(call, now)

    def _send(self, call: Call, now: float) -> Call:
        self._current, self._sent_at, self.deadline, self._equal = call, now, now + call.timeout, 0
        self._counters.sent += 1
        self._copies.add(call.frame)
        return call

    def _needs_proof(self) -> bool:
        """Whether a read can show if the bus returns own frames, which is unknown."""
        return self._copies.returned is None and any(read.differs for read in self._reads)

    def _make_certain(self, call: Call, now: float) -> Call | None:
        """Sends a read whose reply is not owed, or the request if it is one."""
        if now < self._quiet_until:
            self._close(now, SILENT)
            return None
        if not self._in_order:
            self._owed.clear()
        if not self._reads:
            self.is_certain = True
            return self._request(call, now)
        needs_proof = self._needs_proof()
        usable = [read for read in (call, *self._reads) if read.is_read and (read.differs or not needs_proof)]
        read = next((read for read in usable if self._is_free(read)), None)
        if read is None:
            self._owed.clear()
            self._rest(now, QUIET)
        elif read is call:
            return self._request(call, now)
        elif self._fences:
            self._fences -= 1
            return self._send(read, now)
        self._close(now, NO_REPLY if self._is_sent else SILENT)
        return None

    def _is_free(self, read: Call) -> bool:
        return not any(read.key == owed or self._alike(read.key, owed) for owed in self._owed)

    def _answered(self, current: Call, reply: Any, now: float) -> Call | None:
        """The request or a read before it has a reply; after that of a read, nothing older comes any more."""
        call = self._call
        assert call is not None, "a request is open"
        if current is call:
            current.replies.append(reply)
            if len(current.replies) < current.frames:
                return None
            if not current.is_read or (self.is_certain and not self._needs_proof()):
                self._close(now)
                return None
        self._owed.clear()
        self.is_certain = True
        if self._copies.returned is None and current.differs:
            if not self._equal:
                self._current, self.deadline = None, now + LATER_COPY
                return None
            self._copies.learn(returned=True)
        return self._continue(call, now)

    def _continue(self, call: Call, now: float) -> Call | None:
        """Sends the request, unless it was the read that made the line certain."""
        if not call.replies:
            return self._request(call, now)
        self._close(now)
        return None

    def _lose(self, call: Call, now: float) -> None:
        self._owed[call.key] = None
        self.is_certain = False
        if not self._in_order or not self._reads:
            self._rest(now, QUIET)

    def _rest(self, now: float, timeouts: int) -> None:
        self._quiet_until = max(self._quiet_until, now + timeouts * self._timeout)

    def _close(self, now: float, failure: str = "") -> None:
        if self._call is not None:
            self._call.failure, self._call.at = failure, now
        self._call = self._current = None
        self.deadline = math.inf

    def _unexpected(self, frame: Frame, now: float) -> None:
        """A frame that no request waits for."""
        if self._claims(frame):
            return
        if self._current is not None:
            self._counters.early += 1
        elif self._owed or not self.is_certain:
            self._counters.late += 1
            if now < self._quiet_until:
                self._rest(now, QUIET)
        else:
            self._counters.foreign += 1
