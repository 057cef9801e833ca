"""The latest values of nodes, of frames as data."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from canwright.model.edition import Edition
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.latest_values import SECOND, Filter, LatestValues, Line, parse_filter
from canwright.recordings.log_frame import LogFrame
from canwright.recordings.rows import RowReader
from canwright.semantics.frame import CanFrame

from ..spec_texts import ROOT

MS = SECOND // 1000
ASK, ANSWER = "9A00000000000000", "9A32081364000000"
"""Of v2.35-2024-02: 50 degrees, 48.72 V, 1 A."""


@pytest.fixture(scope="module")
def edition() -> Edition:
    return specification(ROOT / "spec/mwd_motor/v2.35-2024-02.yaml").edition


def frame(at: int, data: str, id_: int = 0x141, bus: str = "") -> LogFrame:
    return LogFrame(at, bus, CanFrame(id_, bytes.fromhex(data)), None)


def table(edition: Edition, frames: Sequence[LogFrame]) -> LatestValues:
    """The values of a log."""
    values, reader = LatestValues(), RowReader(lambda *_: {"series": "MG"})
    for row in reader.rows(Directions({}, edition).classify(frames)):
        values.add(row)
    return values


def shown(line: Line) -> tuple[object, ...]:
    return line.entry.node, line.entry.command, line.signal


def test_the_last_frame_of_each_message_is_kept(edition: Edition) -> None:
    old, new = "9A1900FA00000000", ANSWER
    frames = [frame(1 * SECOND, ASK), frame(1 * SECOND + MS, old), frame(2 * SECOND, ASK), frame(2 * SECOND + MS, new)]
    request, reply = table(edition, frames).entries()
    assert (request.node, request.command, request.signals) == (1, "read_status_1", [""])
    assert reply.signals == ["temperature", "voltage", "current", "motor_state", "errors"]
    assert reply.row.fields[1:6:2] == [50, 48.72, 1.0]
    assert (reply.frames, reply.row.judged.latency, reply.time) == (2, MS, 2 * SECOND + MS)
    assert (reply.age(5 * SECOND + MS), reply.age(0)) == (3.0, 0)


def test_the_rate_is_that_of_the_last_frames_and_falls_in_silence(edition: Edition) -> None:
    steady = [frame(SECOND + at * 100 * MS, ASK) for at in range(20)]
    (entry,) = table(edition, steady).entries()
    last = steady[-1].time or 0
    assert entry.rate(last) == entry.rate(last + 150 * MS) == 10
    assert entry.rate(last + 10 * SECOND) == 0.1
    faster = [*steady, *(frame(last + (at + 1) * 10 * MS, ASK) for at in range(100))]
    (entry,) = table(edition, faster).entries()
    assert entry.rate(last + SECOND) == pytest.approx(100, rel=0.01)
    assert table(edition, steady[:1]).entries()[0].rate(last) is None


def test_entries_are_ordered_by_bus_node_command_and_direction(edition: Edition) -> None:
    ids = (("b", 0x141), ("a", 0x142), ("a", 0x141))
    pairs = [(frame(SECOND, ASK, id_, bus), frame(SECOND + MS, ANSWER, id_, bus)) for bus, id_ in ids]
    brake = frame(2 * SECOND, "9B00000000000000", 0x141, "a"), frame(2 * SECOND, "0000", 0x141, "a")
    entries = table(edition, [recorded for pair in [*pairs, brake] for recorded in pair]).entries()
    assert [(e.bus, e.node, e.command, e.is_rejected) for e in entries] == [
        ("a", 1, "clear_errors", False),
        ("a", 1, "read_status_1", False),
        ("a", 1, "read_status_1", False),
        ("a", 1, "", True),
        ("a", 2, "read_status_1", False),
        ("a", 2, "read_status_1", False),
        ("b", 1, "read_status_1", False),
        ("b", 1, "read_status_1", False),
    ]
    assert [e.row.form.direction.value for e in entries[1:3] if e.row.form.direction] == ["request", "reply"]


def test_rejected_and_foreign_frames_are_counted(edition: Edition) -> None:
    values = table(
        edition, [frame(SECOND, ASK), frame(SECOND, "0000"), frame(SECOND, "0000"), frame(SECOND, "", 0x7FF)]
    )
    status = values.status(SECOND)
    assert (status.frames, status.rejected, status.foreign, status.dropped) == (4, 2, 1, 0)
    rejected = values.entries()[-1]
    assert (rejected.frames, rejected.signals) == (2, ("rejected",))


def test_the_load_counts_frames_that_are_not_decoded(edition: Edition) -> None:
    """A classic frame with 8 bytes has at most 135 bits."""
    values = table(edition, [frame(SECOND, ASK)])
    assert values.status(1 * SECOND).bits is None
    values.drop([CanFrame(0x141, bytes(8))] * 99)
    status = values.status(2 * SECOND)
    assert (status.rate, status.bits, status.dropped) == (99, 99 * 135, 99)
    for half in range(5, 9):
        values.drop([CanFrame(0x141, bytes(8))] * 10)
        status = values.status(half * SECOND // 2)
    assert status.rate == 20
    assert values.status(0).rate is None  # of a clock that was set back


@pytest.mark.parametrize(
    ("text", "nodes", "signals"),
    [
        ("", {1, 2}, {"", "temperature", "voltage", "current", "motor_state", "errors"}),
        ("node=2", {2}, {"", "temperature", "voltage", "current", "motor_state", "errors"}),
        ("node=2..4,7 signal=VOLT", {2}, {"voltage"}),
        (
            "node=1 node=2 signal=e command=status",
            {1, 2},
            {"temperature", "voltage", "current", "motor_state", "errors"},
        ),
        ("command=torque", set(), set()),
    ],
)
def test_a_filter_selects_nodes_commands_and_signals(
    edition: Edition, text: str, nodes: set[int], signals: set[str]
) -> None:
    frames = [frame(SECOND + at, data, id_) for id_ in (0x141, 0x142) for at, data in enumerate((ASK, ANSWER))]
    lines = [shown(line) for line in parse_filter(text).lines(table(edition, frames).entries())]
    assert {node for node, _, _ in lines} == nodes
    assert {signal for _, _, signal in lines} == signals


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("volt", "`volt` is not a filter; write it as node=1..2 command=status signal=volt"),
        ("signal=", "`signal=` is not a filter"),
        ("node=a", "`a` is not a node; write nodes as 5,7 or 1..8"),
    ],
)
def test_a_wrong_filter_says_what_to_write(text: str, says: str) -> None:
    with pytest.raises(ValueError, match="^" + says.replace(".", r"\.")):
        parse_filter(text)
    assert parse_filter("") == Filter()
