"""The frames of a node, in parts of one edition each, and what follows from what each edition explains of a part."""

from __future__ import annotations

import functools
import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction

from ..compare import Impact, compare
from ..model.edition import Edition
from ..model.message import Command
from ..semantics.frame import CanFrame
from .kept_frames import Arrival, Kind, NodeFrames
from .readings import STRONG, EditionReader, Reading, Readings, Reason
from .results import JUDGED, EditionScore, Evidence, NodeResult, Place

SHARE = Fraction(1, 20)
"""The minimum share of the frames of a message; evidence from fewer frames is not listed first."""
SWITCH = 8
"""The points that a change of the edition saves at least, in a log without corrupted frames."""
MAX_DIVISIONS = 4
"""How often a part of a log is divided in two at most."""

Runs = Sequence[Sequence[Arrival]]
"""Frames of a node, and those for all nodes of its bus; within a run none is missing."""


def results(
    node: NodeFrames,
    runs: Runs,
    readers: Sequence[EditionReader],
    divisions: int = MAX_DIVISIONS,
    start: Place | None = None,
) -> Iterator[NodeResult]:
    """The result of each part of the frames of a node."""
    part = _Part(node, runs, readers)
    at = part.change() if divisions else None
    if at is None:
        yield part.result(start)
        return
    number, recorded, _ = part.arrivals[at]
    before = [[arrival for arrival in run if arrival.number < number] for run in runs]
    after = [[arrival for arrival in run if arrival.number >= number] for run in runs]
    yield from results(node, [run for run in before if run], readers, divisions - 1, start)
    yield from results(node, [run for run in after if run], readers, divisions - 1, Place(number, recorded.time))


class _Part:
    """Frames of a node under each edition."""

    def __init__(self, node: NodeFrames, runs: Runs, readers: Sequence[EditionReader]) -> None:
        self.node = node
        self.editions = [reader.edition for reader in readers]
        self.arrivals = [arrival for run in runs for arrival in run]
        frames = [[arrival.recorded for arrival in run] for run in runs]
        self.readings = [reader.read(frames) for reader in readers]
        self.own = [at for at, arrival in enumerate(self.arrivals) if arrival.kind.node is node]
        """The positions of the frames of the node itself."""
        self.unexplained: Counter[Kind] = Counter()
        """Frames that no edition has."""
        self.tried = [0] * len(readers)
        """For each edition, the number of requests that only others have, and that no node answers in any."""
        self._answered = {at for own in self.readings for at in own.asked.values()}
        self.points = [[*self._points(at)] for at in self.own]
        """The points of each frame against each edition."""

    @property
    def judged(self) -> int:
        """The number of frames that some edition has."""
        return len(self.own) - self.unexplained.total()

    def _points(self, at: int) -> Iterator[int]:
        readings = [own.frames[at] for own in self.readings]
        having = [reading for reading in readings if not reading.is_rejected]
        if not having:
            self.unexplained[self.arrivals[at].kind] += 1
        is_request = all(reading.is_request for reading in having)
        if having and is_request and at not in self._answered:
            self.tried = [count + reading.is_rejected for count, reading in zip(self.tried, readings, strict=True)]
        return (0 if is_request else reading.points for reading in readings)

    def change(self) -> int | None:
        """The position of the first frame of another edition; None if the edition does not change."""
        totals = [sum(own) for own in zip(*self.points, strict=True)]
        saved, at, after = 0, 0, 0
        before = [0] * len(totals)
        for number, points in enumerate(self.points):
            rest = [total - sum_ for total, sum_ in zip(totals, before, strict=True)]
            less = min(totals) - min(before) - min(rest)
            if less >= saved:
                saved, at, after = less, number, rest.index(min(rest))
            before = [sum_ + own for sum_, own in zip(before, points, strict=True)]
        if saved <= SWITCH * max(1, math.sqrt(self.unexplained.total())):
            return None
        first = self.own[at]
        changed = self.readings[after].asked.get(first, first)
        return changed if changed > self.own[0] else None

    def result(self, start: Place | None) -> NodeResult:
        """The result for the node."""
        explained = [self._explained(number) for number in range(len(self.editions))]
        frames = Counter(self.arrivals[at].kind for at in self.own)
        noise = len(self.own) - max(map(sum, zip(explained, self.tried, strict=True)))
        rare = max(math.sqrt(len(self.own)) / 10, noise / 32)
        often = [frames[self.arrivals[at].kind] >= rare for at in self.own]
        scores = [
            EditionScore(
                edition,
                explained[number],
                self.tried[number],
                sum(points[number] for points, counts in zip(self.points, often, strict=True) if counts),
                self._evidence(number, rare),
                *self._requests(readings),
            )
            for number, (edition, readings) in enumerate(zip(self.editions, self.readings, strict=True))
        ]
        complete = [each for each in scores if self.judged > JUDGED * len(self.own) and each.is_explained(self.judged)]
        possible = [score for score in complete if score.is_possible(self.judged)]
        scores.sort(key=lambda score: (score not in possible, score.score, -score.explained))
        limit = min((score.score for score in complete), default=0) + STRONG * max(1, math.sqrt(noise))
        fits = [score for score in scores if score in possible and score.score < limit]
        is_shown = any(score.is_shown(self.judged) for score in fits)
        fitting = tuple(score.edition for score in fits) if is_shown else ()
        differing = _differing(fitting)
        seen = {own.frames[at].name for own in self.readings for at in self.own}
        examples = {self.arrivals[at].kind: self.arrivals[at].recorded.frame for at in reversed(self.own)}
        return NodeResult(
            bus=self.node.bus,
            node=self.node.number,
            total=len(self.own),
            frames=len(self.own),
            unexplained=tuple((examples[kind], count) for kind, count in self.unexplained.most_common()),
            scores=tuple(scores),
            editions=fitting,
            distinguishing=_distinguishing(fitting, seen, differing),
            differing=frozenset(differing),
            start=start,
        )

    def _explained(self, number: int) -> int:
        """The number of frames that an edition explains."""
        frames = (self.readings[number].frames[at] for at in self.own)
        pairs = zip(frames, self.points, strict=True)
        return sum(not (frame.is_rejected or (frame.is_request and points[number])) for frame, points in pairs)

    def _requests(self, readings: Readings) -> tuple[int, Counter[str]]:
        """The number of requests that have a reply in an edition, and the unanswered ones by command."""
        answered = set(readings.asked.values())
        requests = [at for at in self.own if at in readings.requests]
        return len(requests), Counter(readings.requests[at] for at in requests if at not in answered)

    def _evidence(self, number: int, rare: float) -> tuple[Evidence, ...]:
        """All evidence against an edition, the strongest first."""
        names: Counter[str] = Counter()
        against: Counter[tuple[Reason, str]] = Counter()
        examples: dict[Reason, CanFrame] = {}
        for at, points in zip(self.own, self.points, strict=True):
            reading: Reading = self.readings[number].frames[at]
            names[reading.name] += 1
            if points[number]:
                for reason in reading.reasons:
                    against[reason, reading.name] += 1
                    examples.setdefault(reason, self.arrivals[at].recorded.frame)
        listed = []
        for (reason, name), count in against.items():
            counts = count >= rare and Fraction(count, names[name]) >= SHARE
            listed.append(Evidence(*reason, count, names[name], examples[reason], counts))
        return tuple(sorted(listed, key=lambda e: (not e.counts, -e.points, -e.count)))


def _differing(fitting: Sequence[Edition]) -> Counter[str]:
    """The commands whose frames have another meaning in some of the editions that fit, and the number of changes."""
    return Counter(name for old, new in itertools.permutations(fitting, 2) for name in _with_other_meaning(old, new))


@functools.lru_cache(maxsize=64)
def _with_other_meaning(old: Edition, new: Edition) -> tuple[str, ...]:
    """The commands of an edition whose frames have another meaning in another one; a command once for each change."""
    return tuple(
        name
        for change in compare(old, new)
        if change.rule.id != "range-changed" and any(impact is not Impact.SAFE for impact in change.verdicts.values())
        for name in change.used_by
    )


def _distinguishing(fitting: Sequence[Edition], seen: set[str], differing: Counter[str]) -> tuple[str, ...]:
    """Read commands whose replies differ between the editions that fit; those without a recorded reply first."""
    known = [{c.spec_name: c for c in edition.commands} for edition in fitting]
    names = [
        name
        for name, _ in differing.most_common()
        if all(name in group and _only_reads(group[name]) for group in known)
    ]
    return tuple(sorted(names, key=lambda name: f"{name}_reply" in seen))


def _only_reads(command: Command) -> bool:
    return not command.effects and command.request is not None and not command.request.layout.fields
