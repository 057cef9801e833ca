"""The frames of one node, in parts of one edition each: a drive can get another firmware while a log is recorded.

No edition explains all frames after a change. For each edition this keeps the points against it since the start of the
part, and those of the best division of the part in two that ends with this edition; a change is accepted once it saves
more than SWITCH points. Frames are examined in blocks: if one edition that explains the past is also the best for each
frame of a block, the block is added as a whole.
"""

from __future__ import annotations

import functools
import math
import operator
from collections import Counter
from collections.abc import Sequence

from ..model.edition import Edition
from .log_frame import LogFrame, Mark
from .results import Place
from .steps import Repetitions, State, Step
from .tally import Seen, Tally, merge

BLOCK = 64
"""The number of frames of a node that are examined at once."""
SWITCH = 8
"""The points that a change of the edition saves at least, in a log without corrupted frames."""
NEAR = 32
"""The number of frames of a log within which the next frame of a node is near."""

Arrival = tuple[Step, int, LogFrame]
"""A step, the number of its frame, and the frame."""


class _Division:
    """A division of a part in two: the points against it, the start of the second part, and its frames."""

    __slots__ = ("counts", "points", "start")

    def __init__(self) -> None:
        self.points = 0
        self.start: Place | None = None
        self.counts: dict[Step, Seen] = {}

    def restart(self, points: int) -> None:
        """Moves the division to the next frame."""
        self.points = points
        self.start = None
        self.counts = {}

    def add(self, counts: dict[Step, Seen], start: Place) -> None:
        """Adds frames to the second part."""
        self.start = self.start or start
        merge(self.counts, counts)


class NodeFrames:
    """The frames of a node of a bus: the parts of the log with one edition each, the last one still growing."""

    def __init__(self, bus: str, number: int | None, editions: Sequence[Edition], state: State) -> None:
        self.bus = bus
        self.number = number
        self.state = state
        self.marks: set[Mark] = set()
        self.repetitions = Repetitions()
        self.recent: list[Arrival] = []
        """Frames that are not examined yet."""
        self.tallies = [Tally(editions)]
        self.frames = 0
        """The number of frames that are examined."""
        self.near = 0
        """Frames that follow the one before soon, as replies and the requests of a cycle do."""
        self._last: int | None = None
        self._editions = editions
        self._before: Arrival | None = None
        """The last frame that is examined."""
        self._noise = 0
        self._points = [0] * len(editions)
        self._divisions = [_Division() for _ in editions]

    @property
    def total(self) -> int:
        """The number of all frames."""
        return self.frames + len(self.recent)

    def examine(self) -> None:
        """Counts the recent frames, and divides the log where the edition has changed."""
        if not self.recent:
            return
        steps, numbers, frames = zip(*self.recent)  # noqa: B905  # of tuples
        examples = dict(zip(steps[::-1], frames[::-1]))  # noqa: B905  # the first frame of each step
        counts = {step: Seen(count, examples[step].frame) for step, count in Counter(steps).items()}
        self._count(counts, numbers)
        best = functools.reduce(operator.and_, (step.best for step in counts))
        least = min(self._points)
        dominating = [i for i, points in enumerate(self._points) if points == least and best >> i & 1]
        if dominating:
            self._add_block(counts, Place(self.recent[0][1], self.recent[0][2].time))
        else:
            for arrival in self.recent:
                self._add_frame(arrival)
                self._before = arrival
        self._before = self.recent[-1]
        self.recent.clear()

    def _count(self, counts: dict[Step, Seen], numbers: Sequence[int]) -> None:
        self.frames += len(numbers)
        self._noise += sum(seen.frames for step, seen in counts.items() if step.is_unexplained)
        gaps = map(operator.sub, numbers, (numbers[0] - NEAR - 1 if self._last is None else self._last, *numbers))
        self.near += sum(map(NEAR.__ge__, gaps))
        self._last = numbers[-1]

    def _add_block(self, counts: dict[Step, Seen], start: Place) -> None:
        """Adds frames for each of which an edition that explains the past is among the best."""
        self.tallies[-1].add(counts)
        added = [0] * len(self._editions)
        for step, seen in counts.items():
            for i, points in enumerate(step.points):
                added[i] += points * seen.frames
        self._points = [points + more for points, more in zip(self._points, added, strict=True)]
        least = min(self._points)
        for division, more in zip(self._divisions, added, strict=True):
            division.points += more
            if division.points >= least:
                division.restart(least)
            else:
                division.add(counts, start)

    def _add_frame(self, arrival: Arrival) -> None:
        step, number, recorded = arrival
        starting = [division for division in self._divisions if division.start is None]
        self._add_block({step: Seen(1, recorded.frame)}, Place(number, recorded.time))
        for division in starting:
            if division.start is not None and self._before is not None and self._before[0].is_request:
                asked, number, recorded = self._before  # the request belongs to the part of its reply
                division.start = Place(number, recorded.time)
                merge(division.counts, {asked: Seen(1, recorded.frame)})
        divided = min(self._divisions, key=lambda division: division.points)
        if min(self._points) - divided.points > SWITCH * max(1, math.sqrt(self._noise)):
            self._divide(divided)

    def _divide(self, division: _Division) -> None:
        """Starts a new part with the second part of a division."""
        counts, start = division.counts, division.start
        self.tallies[-1].remove(counts)
        self.tallies.append(Tally(self._editions, start))
        self._points = [0] * len(self._editions)
        for each in self._divisions:
            each.restart(0)
        assert start is not None
        self._add_block(counts, start)
        for each in self._divisions:
            each.restart(min(self._points))
