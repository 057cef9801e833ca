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
from .steps import Meaning, Open, Step, Waiting

LEAD = 3
"""The points against an edition, in excess of those against the best one, with which it does not fit any more."""
SHARE = Fraction(1, 20)
"""The minimum share of the frames of a kind; evidence from fewer frames is not listed first."""

MAX_ADDED = 1 << 8
"""The maximum number of steps that are collected before they are counted."""


class Seen(NamedTuple):
    """The number of frames of a step, and the first of them."""

    frames: int
    example: CanFrame


def merge(counts: dict[Step, Seen], more: Mapping[Step, Seen]) -> None:
    """Adds frames by step."""
    for step, seen in more.items():
        known = counts.get(step)
        counts[step] = seen if known is None else Seen(known.frames + seen.frames, known.example)


class _EditionTally:
    """The frames of a node under one edition, by kind, counted."""

    def __init__(self) -> None:
        self.explained: Counter[ScoredClass] = Counter()
        self.points: Counter[ScoredClass] = Counter()
        self.weak: Counter[ScoredClass] = Counter()
        """Points for what a host may send."""
        self.names: Counter[str] = Counter()
        self._reasons: Counter[tuple[str, str, int]] = Counter()
        """The frames with a reason, by its text, the name of the message and its points."""
        self._bytes: Counter[tuple[str, int]] = Counter()
        self._examples: dict[str, CanFrame] = {}
        self._opened: Counter[bool] = Counter()
        """Requests that have a reply; those that are certain, and those that can be replies too."""
        self._unanswered: Counter[Open] = Counter()
        self._unrequested = 0

    def add(self, kind: ScoredClass, meaning: Meaning, cost: int, count: int, example: CanFrame) -> None:
        """Counts frames with one meaning."""
        interpretation = meaning.interpretation
        self.explained[kind] += count * (interpretation.points < STRONG)
        self.points[kind] += count * cost
        self.weak[kind] += count * (interpretation.points - cost)
        self.names[interpretation.kind] += count
        self._unrequested += count * meaning.is_unrequested
        if meaning.opened is not None:
            self._opened[meaning.opened.is_certain] += count
        if meaning.unanswered is not None:
            self._unanswered[meaning.unanswered] += count
        for text, points in {reason.text: reason.points for reason in interpretation.reasons}.items():
            self._reasons[text, interpretation.kind, points] += count
            self._examples.setdefault(text, example)
        for reason in interpretation.reasons:
            if reason.byte is not None:
                self._bytes[reason.text, reason.byte] += count

    def requests(self, waiting: Waiting) -> tuple[int, Mapping[str, int]]:
        """The number of requests that have a reply, and the unanswered ones by command.

        If the log has more replies without a request than answered requests, and few other requests, its recorder does not
        see requests; then frames that can be replies too are no requests.
        """
        unanswered = self._unanswered + Counter(open_ for open_ in waiting if not open_.is_answered)
        answered = self._opened.total() - unanswered.total()
        replies_only = self._unrequested > max(answered, self._opened.total() // 2)
        uncertain = sum(count for open_, count in unanswered.items() if not open_.is_certain) if replies_only else 0
        by_command: Counter[str] = Counter()
        for (command, is_certain, _), count in unanswered.items():
            by_command[command] += count * (is_certain or not replies_only)
        return max(self._opened.total() - uncertain, by_command.total()), +by_command

    def evidence(self, rare: float) -> tuple[Evidence, ...]:
        """All evidence against the edition, the strongest first."""
        listed = []
        for (text, name, points), count in self._reasons.items():
            if not count:
                continue
            among = self.names[name]
            where = text
            by_byte = {byte: number for (of, byte), number in self._bytes.items() if of == text and number > 0}
            if by_byte:
                often = [byte for byte, number in by_byte.items() if Fraction(number, among) >= SHARE]
                bytes_ = sorted(often or by_byte)
                where = f"{text}: {', '.join(f'DATA[{byte}]' for byte in bytes_)} should be 0"
                points = min(points * len(bytes_), STRONG)
            counts = count >= rare and Fraction(count, among) >= SHARE
            listed.append(Evidence(points, where, count, among, self._examples[text], counts))
        return tuple(sorted(listed, key=lambda e: (not e.counts, -e.points, -e.count)))


class Tally:
    """The frames of a node of a bus, counted. Memory does not grow with the log."""

    def __init__(self, editions: Sequence[Edition], start: Place | None = None) -> None:
        self.start = start
        self._editions = editions
        self._frames: Counter[ScoredClass] = Counter()
        self._unexplained: Counter[ScoredClass] = Counter()
        self._examples: dict[ScoredClass, CanFrame] = {}
        self._by_edition = [_EditionTally() for _ in editions]
        self._added: dict[Step, Seen] = {}
        """Frames that are not counted yet."""

    def add(self, counts: Mapping[Step, Seen]) -> None:
        """Counts frames by step."""
        merge(self._added, counts)
        if len(self._added) > MAX_ADDED:
            self._count_added()

    def remove(self, counts: Mapping[Step, Seen]) -> None:
        """Removes frames that were added."""
        self._count_added()
        self._count(counts, -1)

    def _count_added(self) -> None:
        self._count(self._added, 1)
        self._added = {}

    def _count(self, counts: Mapping[Step, Seen], sign: int) -> None:
        for step, (number, example) in counts.items():
            count = sign * number
            self._frames[step.kind] += count
            self._examples.setdefault(step.kind, example)
            if step.is_unexplained:
                self._unexplained[step.kind] += count
                continue
            for own, meaning, cost in zip(self._by_edition, step.meanings, step.costs, strict=True):
                own.add(step.kind, meaning, cost, count, example)

    def result(self, bus: str, node: int | None, waiting: Sequence[Waiting]) -> NodeResult:
        """The result for the node; `waiting` are the requests without a reply at the end."""
        self._count_added()
        frames = self._frames.total()
        judged = frames - self._unexplained.total()
        noise = frames - max(own.explained.total() for own in self._by_edition)
        rare = max(math.sqrt(frames) / 10, noise / 32)
        often = [kind for kind, count in self._frames.items() if count >= rare]
        scores = []
        for edition, own, open_ in zip(self._editions, self._by_edition, waiting, strict=True):
            score = sum(own.points[kind] for kind in often) + min(sum(own.weak[kind] for kind in often), LEAD - 1)
            explained = own.explained.total()
            scores.append(EditionScore(edition, explained, score, own.evidence(rare), *own.requests(open_)))
        complete = [each for each in scores if judged > JUDGED * frames and each.is_explained(judged)]
        possible = [candidate for candidate in complete if candidate.is_possible(judged)]
        scores.sort(key=lambda candidate: (candidate not in possible, candidate.score, -candidate.explained))
        limit = min((candidate.score for candidate in complete), default=0) + LEAD * max(1, math.sqrt(noise))
        fitting = tuple(candidate.edition for candidate in scores if candidate in possible and candidate.score < limit)
        seen = {name for own in self._by_edition for name, count in own.names.items() if count}
        differing = _differing(fitting)
        unexplained = [(example, self._unexplained[kind]) for kind, example in self._examples.items()]
        return NodeResult(
            bus=bus,
            node=node,
            frames=frames,
            unexplained=tuple(sorted((item for item in unexplained if item[1]), key=lambda item: -item[1])),
            scores=tuple(scores),
            editions=fitting,
            distinguishing=_distinguishing(fitting, seen, differing),
            differing=frozenset(differing),
            start=self.start,
        )


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
