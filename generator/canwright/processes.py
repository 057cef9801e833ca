"""Independent pieces of work side by side, each in a process of its own."""

from __future__ import annotations

import os
import pickle
import sys
import threading
from collections.abc import Callable, Sequence
from functools import partial
from typing import BinaryIO, Generic, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def for_each(work: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """What `work` returns for each item, in their order, as `side_by_side`: each processor takes an equal share."""
    shares = [items[first::count] for first in range(count)] if (count := min(len(items), _processors())) else []
    results = side_by_side([partial(_every, work, share) for share in shares])
    return [results[i % count][i // count] for i in range(len(items))]


def _every(work: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    return [work(item) for item in items]


def side_by_side(work: Sequence[Callable[[], Result]]) -> list[Result]:
    """What each piece of work returns, in their order; a result has to be one that can be pickled.

    The first is done by this process itself. One after another where a process cannot split in two, or there is one
    processor. Raises what a piece raises.
    """
    if len(work) < 2 or _processors() < 2:
        return [piece() for piece in work]
    here, *others = work
    split = [_Split(piece) for piece in others]
    try:
        return [here(), *(one.result() for one in split)]
    finally:
        for one in split:
            one.close()
        for one in split:
            one.end()


def _processors() -> int:
    """How many there are to use; one where `fork` is not safe, as with threads or with the libraries of macOS."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return 1
    return len(os.sched_getaffinity(0))


class _Split(Generic[Result]):
    """A copy of this process, that does a piece of work and sends its result through a pipe."""

    def __init__(self, piece: Callable[[], Result]) -> None:
        self._piece = piece
        receiver, sender = os.pipe()
        self._process = os.fork()
        if not self._process:
            os.close(receiver)
            _send(piece, sender)
        os.close(sender)
        self._stream: BinaryIO = os.fdopen(receiver, "rb")

    def result(self) -> Result:
        """What the work returns. Where it failed there, it is done again here, to raise what it raised."""
        sent = self._stream.read()
        if self.end() != 0:
            return self._piece()
        found: Result = pickle.loads(sent)
        return found

    def close(self) -> None:
        """Takes no more of the result: the process can write no further, once no other holds its pipe."""
        self._stream.close()

    def end(self) -> int:
        """Waits for the process; its status, or 0 where it has ended before."""
        process, self._process = self._process, 0
        return os.waitpid(process, 0)[1] if process else 0


def _send(piece: Callable[[], object], sender: int) -> None:
    """Does the work and leaves at once: what is open or buffered belongs to the process this one is a copy of."""
    status = 1
    try:
        with os.fdopen(sender, "wb") as stream:
            pickle.dump(piece(), stream, pickle.HIGHEST_PROTOCOL)
        status = 0
    finally:
        os._exit(status)
