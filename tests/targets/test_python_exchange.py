"""The state machine of a line, by vectors of events: no bus, no clock."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.targets.python.runtime.exchange import Call, Copies, Counters, Frame, Line

VECTORS = yaml.load(Path(__file__).with_name("exchanges.yaml").read_text("utf-8"), yaml.CSafeLoader)
READS = ("status", "encoder", "angle")
ECHOED = ("switch", "stop")
TIMEOUT = 0.02


def _frame(text: str) -> Frame:
    return 1, False, False, False, text.encode()


def _call(name: str, frames: int = 1, tries: int = 1, *, at_once: bool = False) -> Call:
    reply = {_frame(f"{name}!"), *([_frame(name)] if name in ECHOED else [])}
    return Call(
        key=name,
        frame=_frame(name),
        accept=lambda frame: frame if frame in reply else None,
        timeout=TIMEOUT,
        frames=frames,
        is_read=name in READS,
        differs=name in READS,
        tries=tries,
        at_once=at_once,
    )


class _Line:
    """A line as a vector describes it."""

    def __init__(self, vector: Mapping[str, Any]) -> None:
        alike = {frozenset(pair) for pair in vector.get("alike", ())}
        self.counters = Counters()
        self._open: list[Call] = []
        self._replies = vector.get("replies", {})
        self.line = Line(
            reads=[_call(name) for name in vector.get("reads", READS)],
            alike=lambda key, owed: key == owed or frozenset((key, owed)) in alike,
            copies=Copies(None if vector.get("shares_ids") else False),
            counters=self.counters,
            in_order=vector.get("in_order", True),
            timeout=TIMEOUT,
            floor=vector.get("floor", 0.0),
            is_certain=vector.get("certain", False),
        )

    def step(self, now: float, event: str, *given: str) -> str:
        """What an event leads to: what is sent, or how the request ends."""
        if event == "open":
            tries = int(given[1]) if given[1:] and given[1].isdigit() else 1
            call = _call(given[0], self._replies.get(given[0], 1), tries, at_once="at_once" in given)
            self._open.append(call)
            sent = self.line.open(call, now)
        elif event == "feed":
            sent = self.line.feed(_frame(given[0]), now)
        else:
            assert now == pytest.approx(self.line.deadline)
            sent = self.line.tick(now)
        ended = [call.failure or "done" for call in self._open if call.at is not None]
        self._open = [call for call in self._open if call.at is None]
        return ", ".join([*ended, *([str(sent.key)] if sent else [])]) or "nothing"


@pytest.mark.parametrize("vector", VECTORS, ids=[vector["name"] for vector in VECTORS])
def test_events_of_a_line(vector: Mapping[str, Any]) -> None:
    line = _Line(vector)
    for step in vector["steps"]:
        done, _, expected = step.partition(" -> ")
        at, event, *given = done.split()
        assert line.step(float(at), event, *given) == expected, step
    for name, number in vector.get("counters", {}).items():
        assert getattr(line.counters, name) == number, name
