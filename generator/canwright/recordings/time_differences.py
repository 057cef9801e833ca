"""Times of `candump -td`, which are since the line before, as times since the first one."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, islice

from .log_frame import Counts, LogFrame


def since_start(frames: Iterator[LogFrame], counts: Counts, ahead: int, *, are_differences: bool) -> Iterator[LogFrame]:
    """Adds the times up if they are known to be differences, or if the first is 0 and one of the next `ahead` frames is earlier than
    the one before.
    """
    start: list[LogFrame] = []
    try:
        counts.has_differences = are_differences or _has_differences(frames, start, ahead)
    except Exception:  # what a damaged log has before its end is read
        yield from start
        raise
    time = 0
    for recorded in chain(start, frames):
        if not counts.has_differences or recorded.time is None:
            yield recorded
        else:
            time += recorded.time
            yield recorded._replace(time=time)


def _has_differences(frames: Iterator[LogFrame], start: list[LogFrame], ahead: int) -> bool:
    """Whether the first time is 0 and a later one decreases, but not to 0, as in a second recording.

    `start` gets the frames that were read for this.
    """
    last = None
    for recorded in islice(frames, ahead):
        start.append(recorded)
        time = recorded.time
        if last is None and time != 0:
            return False
        if time is not None:
            if last is not None and 0 < time < last:
                return True
            last = time
    return False
