"""Logs of two recorders of one bus in one file, whose clocks differ: each frame is there twice."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from ..semantics.frame import CanFrame
from .bus_behaviour import Behaviour
from .log_frame import LogFrame

_LEAST = 32
"""The number of frames of commands with different replies from which it is noticed."""
_SHARE = 0.95
"""The minimum share of the frames that have a repetition."""
_CONSTANT = 2
"""How many different frames a command has that always has the same reply."""
_ALIKE = 50_000
"""Times from a frame to its repetition differ by so many ns."""
_FURTHER = 8
"""How many equal frames after a frame can be its repetition."""
_CANDIDATES = 16
"""How many of the most frequent times are examined."""


def repeated_after(frames: Iterable[LogFrame]) -> int | None:
    """The time in ns after which nearly each frame of a bus is in the log again; None if there is none.

    Frames that are sent with a period are no repetitions: they have an equal frame before and another one after them. Where
    nothing changes, a host that asks twice in each cycle looks like two recorders.
    """
    times: dict[CanFrame, list[int]] = {}
    for recorded in frames:
        if recorded.time is not None:
            times.setdefault(recorded.frame, []).append(recorded.time)
    listed = [sorted(own) for own in times.values()]
    count = sum(map(len, listed))
    kinds = Counter((frame.id, frame.data[:1]) for frame in times)
    changing = sum(len(own) for frame, own in times.items() if kinds[frame.id, frame.data[:1]] > _CONSTANT)
    if changing < _LEAST:
        return None
    gaps = Counter(
        round((later - time) / _ALIKE)
        for own in listed
        for number, time in enumerate(own)
        for later in own[number + 1 : number + 1 + _FURTHER]
    )
    frequent = [gap for gap, number in gaps.most_common(_CANDIDATES) if gap and 8 * number >= count]
    best = max(frequent, key=lambda gap: _share(listed, gap * _ALIKE), default=0)
    return best * _ALIKE if _share(listed, best * _ALIKE) >= _SHARE else None


def two_recorders(behaviours: Mapping[str, Behaviour]) -> Iterator[str]:
    """A sentence for each bus whose frames are repeated."""
    for bus, behaviour in behaviours.items():
        if behaviour.repeated_after is not None:
            yield (
                f"{f'{bus}: ' if bus else ''}each frame is recorded twice, again after {behaviour.repeated_after / 1_000_000:g} "
                "ms, as by two recorders: replies can answer the wrong requests; keep the frames of one recorder"
            )


def _share(listed: Sequence[Sequence[int]], lag: int) -> float:
    """The share of the frames with an equal one so long before or after them, but not both; but for those at the ends."""
    start, end = min(own[0] for own in listed) + lag, max(own[-1] for own in listed) - lag
    single = [
        _has_near(own, time - lag) is not _has_near(own, time + lag)
        for own in listed
        for time in own
        if start <= time <= end
    ]
    return sum(single) / len(single) if len(single) >= _LEAST // 2 else 0


def _has_near(times: Sequence[int], time: int) -> bool:
    at = bisect_left(times, time - 2 * _ALIKE)
    return at < len(times) and times[at] <= time + 2 * _ALIKE
