"""Independent pieces of work side by side, in as many processes as there are processors."""

from __future__ import annotations

import os
import pickle
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import BinaryIO, Generic, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST = 1 << 12
"""How many pieces are shared out; their numbers have to fit into a pipe."""

_NUMBER = 4
"""Bytes of a piece's number."""


def for_each(work: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """What `work` returns for each item, in their order, as `side_by_side`."""
    return side_by_side([partial(work, item) for item in items])


def side_by_side(work: Sequence[Callable[[], Result]]) -> list[Result]:
    """What each piece of work returns, in their order; a result has to be one that can be pickled.

    Whichever process is free takes the next piece, so that which takes longest should come first; that is always done
    by this process itself. All is done here, one after another, where a process cannot split, there is one processor,
    or this is itself part of a piece. Raises what a piece raises.
    """
    processes = min(len(work), _processors())
    if processes < 2 or len(work) > MOST or _busy:
        return [piece() for piece in work]
    with _all_busy():
        return _split(work, processes)


_busy = False
"""Whether this process leaves other processors alone: they have work already."""


@contextmanager
def _all_busy() -> Iterator[None]:
    global _busy
    _busy = True
    try:
        yield
    finally:
        _busy = False


def _split(work: Sequence[Callable[[], Result]], processes: int) -> list[Result]:
    queue = _queue(range(1, len(work)))
    others = [_Split(work, queue) for _ in range(processes - 1)]
    try:
        done = {0: work[0](), **_worked(work, queue)}
        for other in others:
            done.update(other.results())
        return [done[number] if number in done else piece() for number, piece in enumerate(work)]
    finally:
        os.close(queue)
        for other in others:
            other.close()
        for other in others:
            other.end()


@contextmanager
def meanwhile(work: Callable[[], Result]) -> Iterator[Callable[[], Result]]:
    """Another process does the work while this one goes on; yields what waits for it and returns its result.

    The result has to be one that can be pickled. Where no other process is free, this one does it when it is asked for.
    """
    if _busy or _processors() < 2:
        yield work
        return
    queue = _queue(range(1))
    other = _Split([work], queue)
    os.close(queue)

    def result() -> Result:
        found = other.results()
        return found[0] if found else work()

    try:
        yield result
    finally:
        other.close()
        other.end()


def _processors() -> int:
    """How many there are to use; one where `fork` is not safe, as with threads or with the libraries of macOS."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return 1
    return len(os.sched_getaffinity(0))


def _queue(numbers: Sequence[int]) -> int:
    """Where every process takes the number of its next piece from."""
    queue, sender = os.pipe()
    os.write(sender, b"".join(number.to_bytes(_NUMBER, "big") for number in numbers))
    os.close(sender)
    return queue


def _taken(queue: int) -> Iterator[int]:
    while number := os.read(queue, _NUMBER):
        yield int.from_bytes(number, "big")


def _worked(work: Sequence[Callable[[], Result]], queue: int) -> dict[int, Result]:
    return {number: work[number]() for number in _taken(queue)}


class _Split(Generic[Result]):
    """A copy of this process, that works as long as there is a piece left and sends its results through a pipe."""

    def __init__(self, work: Sequence[Callable[[], Result]], queue: int) -> None:
        receiver, sender = os.pipe()
        self._process = os.fork()
        if not self._process:
            os.close(receiver)
            with _all_busy():
                _send(partial(_worked, work, queue), sender)
        os.close(sender)
        self._stream: BinaryIO = os.fdopen(receiver, "rb")

    def results(self) -> dict[int, Result]:
        """By their numbers. None where a piece failed: whoever does it again finds out how."""
        sent = self._stream.read()
        if self.end() != 0:
            return {}
        found: dict[int, Result] = pickle.loads(sent)
        return found

    def close(self) -> None:
        """Takes no more of the results: the process can write no further, once no other holds its pipe."""
        self._stream.close()

    def end(self) -> int:
        """Waits for the process; its status, or 0 where it has ended before."""
        process, self._process = self._process, 0
        return os.waitpid(process, 0)[1] if process else 0


def _send(work: Callable[[], object], sender: int) -> None:
    """Works and leaves at once: what is open or buffered belongs to the process this one is a copy of."""
    status = 1
    try:
        with os.fdopen(sender, "wb") as stream:
            pickle.dump(work(), stream, pickle.HIGHEST_PROTOCOL)
        status = 0
    finally:
        os._exit(status)
