"""Results of nodes with equal outcomes, merged into one, so that a bus of 32 equal nodes is one result."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .results import EditionScore, Evidence, NodeResult


@dataclass(frozen=True)
class Group:
    """Nodes of one bus with equal outcomes; `result` has the sums of their counts."""

    nodes: tuple[int | None, ...]
    result: NodeResult


def groups(results: Iterable[NodeResult]) -> list[Group]:
    """The nodes of each bus that fit the same editions, in the order of their first nodes."""
    found: dict[tuple[object, ...], list[NodeResult]] = {}
    for one in results:
        changed = (one.node, one.start) if one.start else None
        outcome = (one.bus, one.node is None, one.editions, one.distinguishing, one.is_judged, one.is_stray, changed)
        found.setdefault(outcome, []).append(one)
    return [Group(tuple(one.node for one in own), _merged(own)) for own in found.values()]


def _merged(results: Sequence[NodeResult]) -> NodeResult:
    first = results[0]
    if len(results) == 1:
        return first
    return dataclasses.replace(
        first,
        frames=sum(one.frames for one in results),
        unexplained=tuple(sorted((item for one in results for item in one.unexplained), key=lambda item: -item[1])),
        scores=tuple(
            _sum([next(s for s in one.scores if s.edition is score.edition) for one in results])
            for score in first.scores
        ),
    )


def _sum(scores: Sequence[EditionScore]) -> EditionScore:
    return EditionScore(
        scores[0].edition,
        explained=sum(one.explained for one in scores),
        score=sum(one.score for one in scores),
        against=_evidence(evidence for one in scores for evidence in one.against),
        requests=sum(one.requests for one in scores),
        unanswered=sum((Counter(one.unanswered) for one in scores), Counter()),
    )


def _evidence(evidence: Iterable[Evidence]) -> tuple[Evidence, ...]:
    """Evidence with equal texts merged, the strongest first."""
    found: dict[str, Evidence] = {}
    for one in evidence:
        same = found.get(one.text)
        found[one.text] = (
            one
            if same is None
            else dataclasses.replace(
                same, count=same.count + one.count, among=same.among + one.among, counts=same.counts or one.counts
            )
        )
    return tuple(sorted(found.values(), key=lambda e: (not e.counts, -e.points, -e.count)))
