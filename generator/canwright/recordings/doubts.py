"""Reasons to doubt the directions of a log, as sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..model.message import Direction
from .bus_behaviour import Behaviour
from .directions import DecidedBy
from .frame_classes import bus_window
from .summary import NodeSummary, Summary
from .two_recorders import two_recorders

_LEAST = 8
"""The number of replies from which a share of unexpected ones is taken."""
_FEW = 128
"""One unexpected reply of so many is a reason to doubt directions that are inferred: other frames are late or reordered, too."""
_UNANSWERED = 32
"""One request of so many without a reply is a reason to doubt directions that are inferred from slow replies."""
_SHOWN = 3
"""The number of commands that are listed."""
_PLURALS = {Direction.REQUEST: "requests", Direction.REPLY: "replies"}
_MARKS = "to be certain, record the marks of sent frames (`candump -l -x`, BLF, ASC)"


@dataclass
class _BusCounts:
    """The frames of all nodes of a bus; replies are expected within `expected_within` ns."""

    requests: int = 0
    missing: int = 0
    replies: int = 0
    unexpected: int = 0
    inferred: int = 0
    expected_within: int = 0

    def add(self, node: NodeSummary) -> None:
        self.requests += node.requests
        self.missing += node.missing
        self.replies += node.replies
        self.unexpected += node.unexpected
        self.inferred += node.frames - node.decided[DecidedBy.ID] - node.decided[DecidedBy.MARK]
        windows = (bus_window(edition, Behaviour(), None) for edition in node.editions)
        self.expected_within = max(self.expected_within, *windows, 0)


def doubts(summary: Summary, behaviours: Mapping[str, Behaviour]) -> Iterator[str]:
    """A sentence for each bus whose directions are not certain."""
    yield from two_recorders(behaviours)
    buses: dict[str, _BusCounts] = {}
    for (bus, _), node in summary.nodes.items():
        buses.setdefault(bus, _BusCounts()).add(node)
    for bus, counts in buses.items():
        where = f"{bus}: " if bus else ""
        behaviour = behaviours.get(bus, Behaviour())
        limit = _FEW if counts.inferred and counts.unexpected >= _LEAST else 4
        is_slow = (behaviour.reply_time or 0) > counts.expected_within
        if behaviour.slowest is not None and counts.inferred and counts.unexpected:
            milliseconds = math.ceil(behaviour.slowest * 1.1 / 1_000_000)
            yield f"{where}replies come after up to {behaviour.slowest / 1_000_000:g} ms: --window {milliseconds} pairs them"
        elif counts.replies >= _LEAST and limit * counts.unexpected > counts.replies:
            causes = ["it lacks requests", "replies take longer than --window"]
            if counts.inferred:
                causes.insert(1, "the host sets reserved bits")
            advice = f"; {_MARKS}" if counts.inferred else ""
            yield (
                f"{where}{counts.unexpected} of {counts.replies} replies answer no request in the log: {', '.join(causes[:-1])} or "
                f"{causes[-1]}{advice}"
            )
        elif behaviour.old_bits and (behaviour.unmarked or not behaviour.is_marked):
            names = sorted({bits.request.command for bits in behaviour.old_bits})
            shown = ", ".join(names[:_SHOWN]) + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")
            varies = any(bits.value is None for bits in behaviour.old_bits)
            how = f"times decide on their directions; {_MARKS}" if varies else "they are the same in all requests"
            yield f"{where}the host sends old bytes in reserved bits of {shown}: {how}"
        elif (
            is_slow and counts.inferred and counts.missing >= _LEAST and _UNANSWERED * counts.missing > counts.requests
        ):
            yield (
                f"{where}{counts.missing} of {counts.requests} requests have no reply, and replies are slow: a request that "
                f"is repeated so soon can count as a reply; {_MARKS}"
            )


def copies(summary: Summary, behaviours: Mapping[str, Behaviour]) -> Iterator[str]:
    """Sentences about frames that were recorded twice."""
    for bus, behaviour in behaviours.items():
        where = f"{bus}: " if bus else ""
        count = sum(node.copies for (of, _), node in summary.nodes.items() if of == bus)
        if count:
            what = " and ".join(_PLURALS[direction] for direction in Direction if direction in behaviour.copied)
            yield f"{where}{what} are recorded twice; {count} copies are not counted"
