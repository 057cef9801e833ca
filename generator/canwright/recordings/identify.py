"""Identification of the editions that a recorded exchange fits.

No frame contains the edition, so this counts what an edition does not allow: ids, codes, lengths, reserved bits, names
and ranges. If several editions explain a log equally well, the result lists all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from ..compare import Change, Impact, Side, compare
from ..model.edition import Edition
from ..model.message import Command
from ..semantics.frame import CanFrame, has_id, node_of
from .scoring import STRONG, Interpretation, Reason, Scorer

LEAD = 3
"""The minimum lead in points over every other edition before one edition is identified."""
SHARE = Fraction(1, 20)
"""The minimum share of the frames of a kind; evidence from fewer frames does not count."""


@dataclass(frozen=True)
class Evidence:
    """Evidence against an edition: in `count` of `among` frames of a kind, of which `example` is the first."""

    points: int
    text: str
    count: int
    among: int
    example: CanFrame

    @property
    def counts(self) -> bool:
        return Fraction(self.count, self.among) >= SHARE


@dataclass(frozen=True)
class EditionScore:
    """An edition with all evidence against it, and the number of frames that it explains."""

    edition: Edition
    against: tuple[Evidence, ...]
    explained: int

    @property
    def score(self) -> int:
        return sum(e.points for e in self.against if e.counts)

    @property
    def is_possible(self) -> bool:
        return all(e.points < STRONG or not e.counts for e in self.against)


@dataclass(frozen=True)
class NodeResult:
    """The result for one node. `editions` are those that fit; exactly one if the edition is identified.

    `unexplained` are frames that no edition has, the first of each kind with its count; they do not affect the scores.
    The replies to the commands `distinguishing` differ between the editions that fit.
    """

    node: int | None
    frames: int
    unexplained: tuple[tuple[CanFrame, int], ...]
    scores: tuple[EditionScore, ...]
    editions: tuple[Edition, ...]
    distinguishing: tuple[str, ...]

    @property
    def scored(self) -> int:
        return self.frames - sum(count for _, count in self.unexplained)


def identify(frames: Iterable[CanFrame], editions: Sequence[Edition]) -> tuple[list[NodeResult], Counter[int]]:
    """The result for each node, and the ids that belong to no edition. All editions are of one family."""
    by_node: dict[int | None, list[CanFrame]] = {}
    foreign: Counter[int] = Counter()
    known: dict[tuple[int, bool, bool], list[int | None]] = {}
    for frame in frames:
        id_ = (frame.id, frame.extended, frame.remote)
        if id_ not in known:
            known[id_] = [node_of(m, frame) for e in editions for m in e.all_messages() if has_id(m, frame)]
        if known[id_]:
            by_node.setdefault(next((n for n in known[id_] if n is not None), None), []).append(frame)
        else:
            foreign[frame.id] += 1
    ordered = sorted(by_node.items(), key=lambda item: (item[0] is None, item[0] or 0))
    compared: Compared = {}
    return [_node_result(node, own, editions, compared) for node, own in ordered], foreign


Compared = dict[tuple[str, str], tuple[Change, ...]]
"""The changes between two editions, by their names: a cache, since several nodes mostly fit the same editions."""


def _node_result(
    node: int | None, frames: Sequence[CanFrame], editions: Sequence[Edition], compared: Compared
) -> NodeResult:
    scorers = [Scorer(edition) for edition in editions]
    tallies = [_Tally() for _ in editions]
    unexplained: dict[str, tuple[CanFrame, int]] = {}
    for frame in frames:
        interpretations = [scorer.interpret(frame) for scorer in scorers]
        if all(interpretation.points >= STRONG for interpretation in interpretations):
            kind = f"{frame.id} {frame.data[:1].hex()} {len(frame.data)}"
            first, count = unexplained.get(kind, (frame, 0))
            unexplained[kind] = (first, count + 1)
        else:
            for tally, interpretation in zip(tallies, interpretations, strict=True):
                tally.add(frame, interpretation)
    scores = sorted(
        (
            EditionScore(edition, tally.evidence(), tally.explained)
            for edition, tally in zip(editions, tallies, strict=True)
        ),
        key=lambda c: (not c.is_possible, c.score),
    )
    possible = [c for c in scores if c.is_possible and tallies[0].kinds]
    fitting = tuple(c.edition for c in possible if c.score < possible[0].score + LEAD)
    seen = {kind for tally in tallies for kind in tally.kinds}
    by_count = sorted(unexplained.values(), key=lambda one: -one[1])
    return NodeResult(
        node, len(frames), tuple(by_count), tuple(scores), fitting, _distinguishing(fitting, seen, compared)
    )


@dataclass
class _Tally:
    """The interpretations of the frames of one node in one edition, counted."""

    explained: int = 0
    kinds: Counter[str] = field(default_factory=Counter)
    _found: dict[Reason, tuple[CanFrame, int]] = field(default_factory=dict)
    _reserved: dict[Reason, tuple[CanFrame, int]] = field(default_factory=dict)

    def add(self, frame: CanFrame, interpretation: Interpretation) -> None:
        self.kinds[interpretation.kind] += 1
        self.explained += not interpretation.reasons
        some = None
        for reason in interpretation.reasons:
            first, count = self._found.get(reason, (frame, 0))
            self._found[reason] = (first, count + 1)
            if reason.byte is not None:
                some = Reason(0, reason.kind, reason.text)
        if some is not None:
            first, count = self._reserved.get(some, (frame, 0))
            self._reserved[some] = (first, count + 1)

    def evidence(self) -> tuple[Evidence, ...]:
        """All evidence, the strongest first; the reserved bytes of one message are one item."""
        found = [
            Evidence(reason.points, reason.text, count, self.kinds[reason.kind], first)
            for reason, (first, count) in self._found.items()
            if reason.byte is None
        ]
        for some, (first, count) in self._reserved.items():
            among = self.kinds[some.kind]
            of_it = {r: n for r, (_, n) in self._found.items() if r.byte is not None and r.text == some.text}
            often = [r for r, n in of_it.items() if Fraction(n, among) >= SHARE] or list(of_it)
            places = ", ".join(f"DATA[{byte}]" for byte in sorted(r.byte for r in often if r.byte is not None))
            points = min(sum(r.points for r in often), STRONG)
            found.append(Evidence(points, f"{some.text}: {places} should be 0", count, among, first))
        return tuple(sorted(found, key=lambda e: (not e.counts, -e.points, -e.count)))


def _distinguishing(fitting: Sequence[Edition], seen: set[str], compared: Compared) -> tuple[str, ...]:
    """Read commands whose replies differ between the editions that fit; those without a recorded reply first."""
    if len(fitting) < 2:
        return ()
    first = fitting[0]
    for other in fitting[1:]:
        if (first.name, other.name) not in compared:
            compared[first.name, other.name] = compare(first, other)
    changes = [change for other in fitting[1:] for change in compared[first.name, other.name]]
    counts = Counter(
        name
        for change in changes
        if change.verdicts.get(Side.RECEIVING, Impact.SAFE) is not Impact.SAFE and change.rule.id != "range-changed"
        for name in change.used_by
    )
    known = [{c.group: c for c in edition.commands} for edition in fitting]
    names = [
        name for name, _ in counts.most_common() if all(name in group and _only_reads(group[name]) for group in known)
    ]
    return tuple(sorted(names, key=lambda name: f"{name}_reply" in seen))


def _only_reads(command: Command) -> bool:
    return not command.effects and command.request is not None and not command.request.layout.fields
