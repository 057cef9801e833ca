"""Independent pieces of work side by side, each in a process of its own."""

from __future__ import annotations

import os
import pickle
import sys
import threading
from collections.abc import Callable, Sequence
from typing import BinaryIO, Generic, TypeVar

Result = TypeVar("Result")


def side_by_side(work: Sequence[Callable[[], Result]]) -> list[Result]:
    """What each piece of work returns, in their order; a result has to be one that can be pickled.

    The first is done by this process itself. One after another where a process cannot split in two, or there is one
    processor. Raises what a piece raises.
    """
    if len(work) < 2 or not _can_split():
        return [piece() for piece in work]
    here, *others = work
    split = [_Split(piece) for piece in others]
    try:
        return [here(), *(one.result() for one in split)]
    finally:
        for one in split:
            one.close()


def _can_split() -> bool:
    """Whether `fork` is safe, which it is not with threads or with the libraries of macOS, and of use."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return False
    return len(os.sched_getaffinity(0)) > 1


class _Split(Generic[Result]):
    """A copy of this process, that does a piece of work and sends its result through a pipe."""

    def __init__(self, piece: Callable[[], Result]) -> None:
        self._piece = piece
        receiver, sender = os.pipe()
        self._process = os.fork()
        if not self._process:
            _send(piece, sender)
        os.close(sender)
        self._stream: BinaryIO = os.fdopen(receiver, "rb")

    def result(self) -> Result:
        """What the work returns. Where it failed there, it is done again here, to raise what it raised."""
        sent = self._stream.read()
        if self._end() != 0:
            return self._piece()
        found: Result = pickle.loads(sent)
        return found

    def close(self) -> None:
        """Ends a process whose result nobody waits for; it can write no more."""
        self._stream.close()
        self._end()

    def _end(self) -> int:
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
