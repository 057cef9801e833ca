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
    by_outcome: dict[tuple[object, ...], list[NodeResult]] = {}
    for result in results:
        changed = (result.node, result.start) if result.start else None
        outcome = (
            result.bus,
            result.node is None,
            result.editions,
            result.distinguishing,
            result.is_judged,
            result.is_stray,
            changed,
        )
        by_outcome.setdefault(outcome, []).append(result)
    return [Group(tuple(result.node for result in own), _merged(own)) for own in by_outcome.values()]


def _merged(results: Sequence[NodeResult]) -> NodeResult:
    first = results[0]
    if len(results) == 1:
        return first
    return dataclasses.replace(
        first,
        total=sum(result.total for result in results),
        frames=sum(result.frames for result in results),
        unexplained=tuple(
            sorted((item for result in results for item in result.unexplained), key=lambda item: -item[1])
        ),
        scores=tuple(
            _sum([next(s for s in result.scores if s.edition is score.edition) for result in results])
            for score in first.scores
        ),
    )


def _sum(scores: Sequence[EditionScore]) -> EditionScore:
    return EditionScore(
        scores[0].edition,
        explained=sum(score.explained for score in scores),
        tried=sum(score.tried for score in scores),
        score=sum(score.score for score in scores),
        against=_evidence(evidence for score in scores for evidence in score.against),
        requests=sum(score.requests for score in scores),
        unanswered=sum((Counter(score.unanswered) for score in scores), Counter()),
    )


def _evidence(evidence: Iterable[Evidence]) -> tuple[Evidence, ...]:
    """Evidence with equal texts merged, the strongest first."""
    merged: dict[str, Evidence] = {}
    for item in evidence:
        same = merged.get(item.text)
        merged[item.text] = (
            item
            if same is None
            else dataclasses.replace(
                same, count=same.count + item.count, among=same.among + item.among, counts=same.counts or item.counts
            )
        )
    return tuple(sorted(merged.values(), key=lambda e: (not e.counts, -e.points, -e.count)))
