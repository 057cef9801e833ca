"""A sample of the logs of `python -m tests.verification.editions`, and all of several seeds on request."""

from __future__ import annotations

import sys
from itertools import islice
from pathlib import Path

import pytest
from canwright.model.message import Direction
from canwright.project.loader import spec_files, specification
from canwright.recordings.directions import Directions
from canwright.recordings.identify import Identifier
from canwright.recordings.log_frame import LogFrame
from canwright.semantics.frame import CanFrame

from ..recordings import mixed_buses as buses
from ..recordings.mixed_buses import V235, V235B, Frame, Motor
from ..spec_texts import ROOT
from . import editions


@pytest.mark.parametrize("first", range(6))
def test_a_sample_of_simulated_buses_is_identified(first: int, tmp_path: Path) -> None:
    listed = islice(editions.cases((4, 60)[first % 2], first), 2 * first, None, 23)
    assert not [problem for case in listed for problem in editions.problems(case, tmp_path)]


@pytest.mark.exhaustive
def test_all_simulated_buses_are_identified(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["editions", "--seeds", "3"])
    assert editions.main() == 0


def test_the_frame_after_which_a_node_has_another_edition() -> None:
    identifier = Identifier([specification(file).edition for file in spec_files(ROOT / "spec")])
    motors = (Motor(1, V235, until=100), Motor(1, V235B, since=100, first=()), Motor(2, V235B))
    log = list(buses.frames(motors, 200, 1))
    for frame in log:
        identifier.add(recorded(frame))
    first, second, third = identifier.result().nodes
    assert ([edition.name for edition in first.editions], [edition.name for edition in second.editions]) == (
        [V235],
        [V235B],
    )
    changed = next(number for number, frame in enumerate(log) if frame.motor is motors[1])
    assert second.start == (changed, log[changed].time * 1000)
    assert (first.start, third.start) == (None, None)


def test_replies_without_requests_are_no_requests_with_old_bytes() -> None:
    """A recorder that does not see requests, and few replies that follow the one before sooner than others."""
    (case,) = (case for case in editions.cases(60, 60) if case.name == "v2.35, replies only, marks none, 60 rounds, 60")
    directions = Directions({}, specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition)
    judged = directions.classify(map(recorded, case.frames))
    assert {each.direction for each in judged if each.recorded.frame.data[0] == 0x9A} == {Direction.REPLY}


def recorded(frame: Frame) -> LogFrame:
    return LogFrame(frame.time * 1000, frame.bus, CanFrame(frame.id, frame.data), None)
