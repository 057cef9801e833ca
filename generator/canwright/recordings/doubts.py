"""Reasons to doubt the directions of a log, as sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ..model.message import Direction
from .bus_behaviour import Behaviour
from .directions import DecidedBy
from .frame_classes import bus_window
from .summary import Summary
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


def doubts(summary: Summary, behaviours: Mapping[str, Behaviour]) -> Iterator[str]:
    """A sentence for each bus whose directions are not certain."""
    yield from two_recorders(behaviours)
    for bus in dict.fromkeys(bus for bus, _ in summary.nodes):
        nodes = [node for (of, _), node in summary.nodes.items() if of == bus]
        missing, requests = sum(node.missing for node in nodes), sum(node.requests for node in nodes)
        repeated, paired = sum(node.repeated for node in nodes), sum(node.paired for node in nodes)
        unexpected, replies = sum(node.unexpected for node in nodes), sum(node.replies for node in nodes)
        inferred = sum(node.frames - node.decided[DecidedBy.ID] - node.decided[DecidedBy.MARK] for node in nodes)
        windows = (bus_window(edition, Behaviour(), None) for node in nodes for edition in node.editions)
        where = f"{bus}: " if bus else ""
        behaviour = behaviours.get(bus, Behaviour())
        limit = _FEW if inferred and unexpected >= _LEAST else 4
        is_slow = (behaviour.reply_time or 0) > max(windows, default=0)
        if behaviour.slowest is not None and inferred and unexpected:
            milliseconds = math.ceil(behaviour.slowest * 1.1 / 1_000_000)
            yield f"{where}replies come after up to {behaviour.slowest / 1_000_000:g} ms: --window {milliseconds} pairs them"
        elif replies >= _LEAST and limit * unexpected > replies:
            causes = ["it lacks requests", "replies take longer than --window"]
            if inferred:
                causes.insert(1, "the host sets reserved bits")
            advice = f"; {_MARKS}" if inferred else ""
            yield (
                f"{where}{unexpected} of {replies} replies answer no request in the log: {', '.join(causes[:-1])} or "
                f"{causes[-1]}{advice}"
            )
        elif behaviour.old_bits and (behaviour.unmarked or not behaviour.is_marked):
            names = sorted({bits.request.command for bits in behaviour.old_bits})
            shown = ", ".join(names[:_SHOWN]) + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")
            varies = any(bits.value is None for bits in behaviour.old_bits)
            how = f"times decide on their directions; {_MARKS}" if varies else "they are the same in all requests"
            yield f"{where}the host sends old bytes in reserved bits of {shown}: {how}"
        elif inferred and 4 * paired > replies:
            yield f"{where}{paired} of {replies} replies follow others that can be their requests, with old bytes; {_MARKS}"
        elif inferred and _UNANSWERED * repeated > requests:
            yield f"{where}{repeated} of {requests} requests repeat the one before, and can be its late reply; {_MARKS}"
        elif is_slow and inferred and missing >= _LEAST and _UNANSWERED * missing > requests:
            yield (
                f"{where}{missing} of {requests} requests have no reply, and replies are slow: a request that "
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
