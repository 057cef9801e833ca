"""The directions of frames in arrays are those of the frames one by one, whatever the blocks are."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

import pytest
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.recordings.bus_behaviour import LOOKED_AHEAD
from canwright.recordings.direction_arrays import infer_directions
from canwright.recordings.directions import Directions
from canwright.recordings.log_frame import LogFrame, Mark
from canwright.targets.columns.runtime._columns import Direction as Number, Frames, Kind, frames
from hypothesis import given, settings, strategies as st

from ..samples import sampled
from . import motor_bus
from .test_directions import ALPHABET, EDITIONS, MOTOR, STEPS, frames as recorded_frames, judge
from .traffic import Loss, Traffic, together, with_clock_jumps

NUMBERS = {Direction.REQUEST: Number.REQUEST, Direction.REPLY: Number.REPLY, None: Number.UNKNOWN}
MARKS = {Mark.SENT: Number.REQUEST, Mark.RECEIVED: Number.REPLY, None: Number.UNKNOWN}


def blocks(log: Sequence[LogFrame], size: int) -> Iterator[Frames]:
    for start in range(0, len(log), size):
        part = log[start : start + size]
        yield frames(
            [recorded.frame.id for recorded in part],
            [recorded.frame.data for recorded in part],
            [MARKS[recorded.mark] for recorded in part],
            time=[recorded.time or 0 for recorded in part],
            bus=[recorded.bus for recorded in part],
            kind=[Kind.EXTENDED * recorded.frame.extended | Kind.REMOTE * recorded.frame.remote for recorded in part],
        )


def directions(edition: Edition, log: Sequence[LogFrame], size: int) -> list[int]:
    inferred = infer_directions(blocks(log, size), edition)
    return [direction for block in inferred for direction in block.direction.tolist()]


def one_by_one(edition: Edition, log: Iterable[LogFrame]) -> list[int]:
    """The directions of `Directions`; an id of no edition keeps the given one."""
    log = list(log)
    behaviours = Directions({}, edition).learn(log[:LOOKED_AHEAD], {"can0", "can1"})
    return [
        NUMBERS[frame.direction] if frame.edition else MARKS[frame.recorded.mark]
        for frame in judge(edition, log, behaviours=behaviours)
    ]


@pytest.mark.parametrize("spec", EDITIONS)
def test_losses_retries_broadcasts_two_buses_and_clock_jumps(spec: str) -> None:
    for loss in (Loss(0.01), Loss(0.1, has_retries=True, not_recorded=0.02)):
        buses = [Traffic(EDITIONS[spec], "mixed", 3, loss=loss, bus=f"can{number}").frames(60) for number in (0, 1)]
        log = [sent.recorded for sent in with_clock_jumps(together(buses), 1, every=50)]
        assert directions(EDITIONS[spec], log, 97) == one_by_one(EDITIONS[spec], log)


@st.composite
def logs(draw: st.DrawFn) -> list[LogFrame]:
    """Short logs of few different frames, some with marks."""
    log, time = [], 10**10
    steps = st.sampled_from([step for step in STEPS if step is not None])
    buses, marks = st.sampled_from(["can0", "can1"]), st.sampled_from([None, None, None, *Mark])
    for frame, step, bus, mark in draw(
        st.lists(st.tuples(st.sampled_from(ALPHABET), steps, buses, marks), min_size=1, max_size=30)
    ):
        time += step
        log.append(frame._replace(time=time, bus=bus, mark=mark))
    return log


@given(logs(), st.integers(1, 30))
@settings(max_examples=100)
def test_unlikely_logs(log: list[LogFrame], size: int) -> None:
    assert directions(MOTOR, log, size) == one_by_one(MOTOR, log)


def test_a_frame_of_no_edition_is_unknown() -> None:
    log = recorded_frames("7FF#00 141#EE00000000000000 141#9A 280#0000000000000000")
    assert directions(MOTOR, log, 4) == [Number.UNKNOWN] * 3 + [Number.REQUEST]
    assert not list(infer_directions([], MOTOR))
    assert [len(block) for block in infer_directions([frames([], [], [])], MOTOR)] == [0]


@pytest.mark.parametrize(("name", "mix"), sampled([*itertools.product(motor_bus.SITUATIONS, motor_bus.MIXES)], 2))
def test_hosts_recorders_and_motors_of_any_behaviour(name: str, mix: str) -> None:
    log = [sent.recorded for sent in motor_bus.MotorBus(mix, motor_bus.SITUATIONS[name], 2).frames(600)]
    assert directions(MOTOR, log, 250) == one_by_one(MOTOR, log)


def test_no_block_waits_for_the_end_of_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    """A repeated echo waits for the next frame of its node; the clock of the bus ends the wait."""
    off = recorded_frames("141#8000000000000000 141#8000000000000000", 900_000)
    exchanges = recorded_frames("142#9A00000000000000 142#9A3200E701000000 " * 10)
    log = [*off, *(frame._replace(time=2_000_000 + (frame.time or 0)) for frame in exchanges)]
    monkeypatch.setattr("canwright.recordings.direction_arrays.LOOKED_AHEAD", 4)
    consumed = []

    def source() -> Iterator[Frames]:
        for block in blocks(log, 2):
            consumed.append(block)
            yield block

    first = next(infer_directions(source(), MOTOR))
    assert first.direction.tolist() == [Number.REQUEST, Number.REPLY] and 5 < len(consumed) < len(log) // 2


def test_memory_for_kinds_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("canwright.recordings.direction_arrays.MAX_CLASSES", 20)
    log = [sent.recorded for sent in Traffic(MOTOR, "polling", 5, loss=Loss(0.1)).frames(100)]
    assert directions(MOTOR, log, 30) == one_by_one(MOTOR, log)
