"""The result of identification: for each node of each bus, the editions that fit, and the evidence against the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ..model.edition import Edition
from ..semantics.frame import CanFrame

JUDGED = Fraction(1, 2)
"""More than this share of the frames of a node is a message of some edition."""
EXPLAINED = Fraction(9, 10)
"""The minimum share of those frames that an edition explains."""
ANSWERED = Fraction(1, 2)
"""The minimum share of the requests with a reply that are answered."""


RARE = Fraction(1, 20)
"""The maximum share of the frames of a node that are rare, so that they may be corrupted."""


class Place(NamedTuple):
    """A frame of a log: its number, and its time in ns; None in a log without times."""

    number: int
    time: int | None


@dataclass(frozen=True)
class Evidence:
    """Evidence against an edition: in `count` of `among` frames of a kind, of which `example` is the first.

    `points` are those of one frame. It does not count if the frames are rare, so that they may be corrupted.
    """

    points: int
    text: str
    count: int
    among: int
    example: CanFrame
    counts: bool


@dataclass(frozen=True)
class EditionScore:
    """An edition: the number of frames that it explains, and all evidence against it, the strongest first.

    `tried` are the requests that only other editions have, and that no node answers: a host sends the same to all nodes.
    `requests` are those that have a reply in this edition; `unanswered` counts those without one, by command. Frames
    that can be replies as well are no requests if the log has replies whose requests it lacks.
    """

    edition: Edition
    explained: int
    tried: int
    score: int
    against: tuple[Evidence, ...]
    requests: int
    unanswered: Mapping[str, int]

    def is_explained(self, judged: int) -> bool:
        """Whether the edition explains nearly all of the frames that some edition has, apart from fewer that are tried."""
        return self.explained > self.tried and self.explained + self.tried >= EXPLAINED * judged

    def is_shown(self, judged: int) -> bool:
        """Whether that is so without tried requests, or no fewer requests are answered: the log may lack replies to them."""
        answered = self.requests - sum(self.unanswered.values())
        return self.tried <= answered or self.explained >= EXPLAINED * judged

    def is_possible(self, judged: int) -> bool:
        """Whether the edition explains nearly all frames, and most of its requests are answered, unless these are rare."""
        unanswered = sum(self.unanswered.values())
        most = max((1 - ANSWERED) * self.requests, RARE * judged)
        return self.is_explained(judged) and unanswered <= most


@dataclass(frozen=True, kw_only=True)
class NodeResult:
    """The result for one node of a bus. `editions` are those that fit; exactly one if the edition is identified.

    Of its `total` frames, those that were kept are compared: `frames`, of which all counts are.

    `unexplained` are frames that no edition has, the first of each kind with its count; they do not affect the scores.
    The frames of the commands `differing` have another meaning in some of the editions that fit; `distinguishing` are those
    of which a reply decides. `scores` starts with the best. A node whose edition changes has several results; `start` is the first frame of all but the first. A `stray` node has
    few frames that are far apart, as frames with a damaged id are.
    """

    bus: str
    node: int | None
    total: int
    frames: int
    unexplained: tuple[tuple[CanFrame, int], ...]
    scores: tuple[EditionScore, ...]
    editions: tuple[Edition, ...]
    distinguishing: tuple[str, ...]
    differing: frozenset[str] = frozenset()
    start: Place | None = None
    is_stray: bool = False

    @property
    def judged(self) -> int:
        """The number of frames that are a message of some edition."""
        return self.frames - sum(count for _, count in self.unexplained)

    @property
    def is_judged(self) -> bool:
        """Whether most frames are a message of some edition."""
        return self.judged > JUDGED * self.frames


@dataclass(frozen=True)
class Identification:
    """The results of a log, by bus and node; `foreign` counts the frames whose id belongs to no edition.

    `foreign_ids` counts them by id, for the first ids: its number, whether it has 29 bits, and whether a frame is remote.
    """

    frames: int
    foreign: int
    foreign_ids: Mapping[tuple[int, bool, bool], int]
    nodes: tuple[NodeResult, ...]

    @property
    def is_complete(self) -> bool:
        """Whether the edition of every node, apart from stray ones, is identified and does not change."""
        nodes = [result for result in self.nodes if not result.is_stray]
        return bool(nodes) and all(len(result.editions) == 1 and result.start is None for result in nodes)
