"""A bounded part of a log, from which the editions of its nodes are identified: the first frames of each kind, and samples."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from .log_frame import LogFrame

MAX_KEPT = 1 << 14
"""The maximum number of frames of a log that are kept."""
MAX_STREAMED = 1 << 11
"""The maximum number of frames of a stream that are kept: it is read again and again."""
BLOCK = 128
"""The number of consecutive frames that are kept together, so that requests and their replies are."""


class Kind:
    """The frames of a node with the same id, length and keys, how many there are, and whether they can be a message."""

    __slots__ = ("count", "is_message", "node")

    def __init__(self, node: NodeFrames, *, is_message: bool) -> None:
        self.node = node
        self.is_message = is_message
        self.count = 0


class NodeFrames:
    """A node of a bus, and how many frames it has; `near` are those that follow the one before soon."""

    __slots__ = ("bus", "last", "near", "number", "total")

    def __init__(self, bus: str, number: int | None) -> None:
        self.bus = bus
        self.number = number
        self.total = 0
        self.near = 0
        self.last = -MAX_KEPT
        """The number of its last frame."""


class Arrival(NamedTuple):
    """A frame of a log, its number and its kind."""

    number: int
    recorded: LogFrame
    kind: Kind


class _Block(NamedTuple):
    """Consecutive frames; `rank` is the number of its kind of that frame which has the fewest before it."""

    number: int
    rank: int
    arrivals: list[Arrival]


class KeptFrames:
    """Keeps blocks with the first frames of a kind, and one of several other blocks; fewer as the log grows."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._kept: list[_Block] = []
        self._number = 0
        self._open: list[Arrival] = []
        self._rank = limit
        self._first = 32
        """A block with one of so many first frames of a kind is kept."""
        self._every = 1
        """One of so many blocks is kept in any case."""

    def add(self, arrival: Arrival) -> None:
        """The next frame of the log."""
        self._open.append(arrival)
        if arrival.kind.count < self._rank:
            self._rank = arrival.kind.count
        if len(self._open) >= BLOCK:
            self._close()

    def runs(self) -> Iterator[list[Arrival]]:
        """The kept frames, in lists without a gap."""
        run: list[Arrival] = []
        after = 0
        for number, _, arrivals in [*self._kept, _Block(self._number, 0, self._open)]:
            if number != after and run:
                yield run
                run = []
            run += arrivals
            after = number + 1
        yield run

    def _close(self) -> None:
        block = _Block(self._number, self._rank, self._open)
        if self._is_kept(block):
            self._kept.append(block)
        while len(self._kept) * BLOCK > self._limit:
            self._first //= 2
            self._every *= 2
            self._kept = [kept for kept in self._kept if self._is_kept(kept)]
        self._number += 1
        self._open = []
        self._rank = self._limit

    def _is_kept(self, block: _Block) -> bool:
        return block.rank <= self._first or block.number % self._every == 0
