"""The frames of a node under one edition, counted, and what follows from the counts."""

from __future__ import annotations

import functools
import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ..compare import Impact, compare
from ..model.edition import Edition
from ..model.message import Command
from ..semantics.frame import CanFrame
from .checks import STRONG
from .results import JUDGED, EditionScore, Evidence, NodeResult, Place
from .scoring import ScoredClass
from .steps import Step, Waiting

LEAD = 3
"""The points against an edition, in excess of those against the best one, with which it does not fit any more."""
SHARE = Fraction(1, 20)
"""The minimum share of the frames of a kind; evidence from fewer frames is not listed first."""


class Seen(NamedTuple):
    """The number of frames of a step, and the first of them."""

    frames: int
    example: CanFrame


class _ClassTally:
    """The frames of one kind; the lists have a number for each edition."""

    def __init__(self, editions: int, example: CanFrame) -> None:
        self.example = example
        self.frames = 0
        self.unexplained = 0
        self.explained = [0] * editions
        self.points = [0] * editions
        self.weak = [0] * editions
        """Points for what a host may send."""


class _Found:
    """A reason against an edition: the number of frames, and the first."""

    def __init__(self, name: str, points: int, example: CanFrame) -> None:
        self.name = name
        self.points = points
        self.example = example
        self.frames = 0
        self.by_byte: Counter[int] = Counter()


class Tally:
    """The frames of a node of a bus, counted. Memory does not grow with the log."""

    def __init__(self, editions: Sequence[Edition], start: Place | None = None) -> None:
        self.start = start
        self._editions = editions
        self._kinds: dict[ScoredClass, _ClassTally] = {}
        self._found: list[dict[str, _Found]] = [{} for _ in editions]
        self._names: list[Counter[str]] = [Counter() for _ in editions]
        self._opened: list[Counter[bool]] = [Counter() for _ in editions]
        """Requests that have a reply; those that are certain, and those that can be replies too."""
        self._unanswered: list[Counter[tuple[str, bool]]] = [Counter() for _ in editions]
        self._unrequested = [0] * len(editions)

    def add(self, counts: Mapping[Step, Seen], sign: int = 1) -> None:
        """Counts frames by step; removes them if the sign is negative."""
        for step, (number, example) in counts.items():
            count = sign * number
            kind = self._kinds.get(step.kind)
            if kind is None:
                kind = self._kinds[step.kind] = _ClassTally(len(self._editions), example)
            kind.frames += count
            if step.is_unexplained:
                kind.unexplained += count
                continue
            for i, meaning in enumerate(step.meanings):
                interpretation = meaning.interpretation
                kind.explained[i] += count * (interpretation.points < STRONG)
                kind.points[i] += count * step.costs[i]
                kind.weak[i] += count * (interpretation.points - step.costs[i])
                self._names[i][interpretation.kind] += count
                self._unrequested[i] += count * meaning.is_unrequested
                if meaning.opened is not None:
                    self._opened[i][meaning.opened.is_certain] += count
                if meaning.unanswered is not None:
                    self._unanswered[i][meaning.unanswered] += count
                for reason in interpretation.reasons:
                    if reason.text not in self._found[i]:
                        self._found[i][reason.text] = _Found(interpretation.kind, reason.points, example)
                    if reason.byte is not None:
                        self._found[i][reason.text].by_byte[reason.byte] += count
                for text in {reason.text for reason in interpretation.reasons}:
                    self._found[i][text].frames += count

    def result(self, bus: str, node: int | None, waiting: Sequence[Waiting]) -> NodeResult:
        """The result for the node; `waiting` are the requests without a reply at the end."""
        frames = sum(kind.frames for kind in self._kinds.values())
        judged = frames - sum(kind.unexplained for kind in self._kinds.values())
        explained = [sum(kind.explained[i] for kind in self._kinds.values()) for i in range(len(self._editions))]
        noise = frames - max(explained)
        rare = max(math.sqrt(frames) / 10, noise / 32)
        often = [kind for kind in self._kinds.values() if kind.frames >= rare]
        scores = []
        for i, edition in enumerate(self._editions):
            weak = min(sum(kind.weak[i] for kind in often), LEAD - 1)
            score = sum(kind.points[i] for kind in often) + weak
            against = self._evidence(i, rare)
            scores.append(EditionScore(edition, explained[i], score, against, *self._requests(i, waiting[i])))
        possible = [candidate for candidate in scores if judged > JUDGED * frames and candidate.is_possible(judged)]
        scores.sort(key=lambda candidate: (candidate not in possible, candidate.score, -candidate.explained))
        limit = min((candidate.score for candidate in possible), default=0) + LEAD * max(1, math.sqrt(noise))
        fitting = tuple(candidate.edition for candidate in scores if candidate in possible and candidate.score < limit)
        seen = {name for names in self._names for name, count in names.items() if count}
        differing = _differing(fitting)
        unexplained = [(kind.example, kind.unexplained) for kind in self._kinds.values() if kind.unexplained]
        return NodeResult(
            bus=bus,
            node=node,
            frames=frames,
            unexplained=tuple(sorted(unexplained, key=lambda item: -item[1])),
            scores=tuple(scores),
            editions=fitting,
            distinguishing=_distinguishing(fitting, seen, differing),
            differing=frozenset(differing),
            start=self.start,
        )

    def _requests(self, edition: int, waiting: Waiting) -> tuple[int, Mapping[str, int]]:
        """The number of requests that have a reply, and the unanswered ones by command.

        If the log has more replies without a request than answered requests, and few other requests, its recorder does not
        see requests; then frames that can be replies too are no requests.
        """
        opened, unanswered = self._opened[edition], self._unanswered[edition] + Counter(waiting)
        answered = opened.total() - unanswered.total()
        replies_only = self._unrequested[edition] > max(answered, opened.total() // 2)
        uncertain = sum(count for open_, count in unanswered.items() if not open_[1]) if replies_only else 0
        by_command: Counter[str] = Counter()
        for (command, is_certain), count in unanswered.items():
            by_command[command] += count * (is_certain or not replies_only)
        return max(opened.total() - uncertain, by_command.total()), +by_command

    def _evidence(self, edition: int, rare: float) -> tuple[Evidence, ...]:
        """All evidence against an edition, the strongest first."""
        listed = []
        for text, reason in self._found[edition].items():
            if not reason.frames:
                continue
            among = self._names[edition][reason.name]
            counts = reason.frames >= rare and Fraction(reason.frames, among) >= SHARE
            where, points = text, reason.points
            by_byte = +reason.by_byte
            if by_byte:
                often = [byte for byte, count in by_byte.items() if Fraction(count, among) >= SHARE]
                bytes_ = sorted(often or by_byte)
                where = f"{text}: {', '.join(f'DATA[{byte}]' for byte in bytes_)} should be 0"
                points = min(points * len(bytes_), STRONG)
            listed.append(Evidence(points, where, reason.frames, among, reason.example, counts))
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
