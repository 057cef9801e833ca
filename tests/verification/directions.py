"""Prints the share of wrong directions that `canwright decode` and the dissector for Wireshark give simulated traffic.

For each loss, the smallest and the largest share of the traffic mixes in percent; with alternation for comparison: each
second frame of a code on an id is a reply, always or within 2 ms. Equal seeds give equal figures.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.frame_classes import WINDOW

from ..recordings.traffic import MIXES, Loss, Sent, Traffic, together, with_clock_jumps, with_marks
from ..spec_texts import ROOT
from ..targets.dissector import judge

Rule = Callable[[Edition, Sequence[Sent]], Sequence[Direction | None]]

LOSSES = {
    "no loss": Loss(),
    "1 %": Loss(0.01),
    "10 %": Loss(0.1),
    "10 %, retries": Loss(0.1, has_retries=True),
    "1 %, 1 % not recorded": Loss(0.01, not_recorded=0.01),
}


def canwright(edition: Edition, log: Sequence[Sent]) -> Sequence[Direction | None]:
    """The directions of `recordings/directions.py`."""
    return [classified.direction for classified in Directions({}, edition).classify(sent.recorded for sent in log)]


def wireshark(edition: Edition, log: Sequence[Sent]) -> Sequence[Direction | None]:
    """The directions of the dissector."""
    named = {direction.value: direction for direction in Direction}
    return [named.get(judged.direction) for judged in judge(edition, [sent.recorded for sent in log])]


def alternation(window: int | None) -> Rule:
    """Each second frame of a code on an id is a reply, if it comes within a time."""

    def directions(_: Edition, log: Sequence[Sent]) -> Sequence[Direction | None]:
        asked: dict[tuple[str, int, bytes], int] = {}
        results: list[Direction | None] = []
        for sent in log:
            time, frame = sent.recorded.time or 0, sent.recorded.frame
            key = (sent.recorded.bus, frame.id, frame.data[:1])
            since = asked.pop(key, None)
            is_reply = since is not None and (window is None or 0 <= time - since <= window)
            if not is_reply:
                asked[key] = time
            results.append(Direction.REPLY if is_reply else Direction.REQUEST)
        return results

    return directions


RULES: dict[str, Rule] = {
    "alternation": alternation(None),
    "alternation within 2 ms": alternation(WINDOW),
    "content, 2 ms, retry": canwright,
    "Wireshark": wireshark,
}


def traffic(edition: Edition, loss: Loss, exchanges: int, seed: int) -> list[list[Sent]]:
    """A log of each mix, and one of two buses with clock jumps."""
    logs = [Traffic(edition, mix, seed, loss=loss).frames(exchanges) for mix in MIXES]
    buses = [Traffic(edition, "mixed", seed + i, loss=loss, bus=f"can{i}").frames(exchanges // 2) for i in (1, 2)]
    return [*logs, with_clock_jumps(together(buses), seed)]


def share(directions: Sequence[Direction | None], log: Sequence[Sent]) -> float:
    """The share of wrong directions in percent."""
    return (
        100 * sum(direction is not sent.direction for direction, sent in zip(directions, log, strict=True)) / len(log)
    )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--spec", default=ROOT / "spec/mwd_motor/v2.35.yaml", type=type(ROOT))
    parser.add_argument("--exchanges", default=20_000, type=int)
    parser.add_argument("--seed", default=1, type=int)
    arguments = parser.parse_args()
    edition = specification(arguments.spec).edition
    logs = {name: traffic(edition, loss, arguments.exchanges, arguments.seed) for name, loss in LOSSES.items()}
    print(f"{'rule':<24} " + " ".join(f"{name:>22}" for name in LOSSES))
    for name, rule in RULES.items():
        cells = []
        for loss in LOSSES:
            shares = [share(rule(edition, log), log) for log in logs[loss]]
            cells.append(f"{min(shares):.2f}..{max(shares):.2f}")
        print(f"{name:<24} " + " ".join(f"{cell:>22}" for cell in cells))
    marked = [with_marks(log) for log in logs["10 %, retries"]]
    print(f"with marks: {max(share(canwright(edition, log), log) for log in marked):.2f}")


if __name__ == "__main__":
    main()
