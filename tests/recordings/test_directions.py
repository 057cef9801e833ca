"""The directions of frames with and without marks, in simulated traffic with losses, and at the places to divide a log."""

from __future__ import annotations

import random
import tracemalloc
from collections.abc import Iterable, Sequence
from itertools import pairwise

import pytest
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.recordings.directions import DecidedBy, DirectedFrame, Directions
from canwright.recordings.doubts import doubts
from canwright.recordings.frame_classes import WINDOW, FrameClasses
from canwright.recordings.log_frame import LogFrame
from canwright.recordings.rows import RowReader
from canwright.recordings.summary import Summary
from canwright.recordings.two_recorders import repeated_after
from canwright.semantics.frame import CanFrame
from hypothesis import given, settings, strategies as st

from ..spec_texts import ROOT, WITHOUT_SETTINGS_IN_IDS, called
from . import motor_bus
from .motor_bus import MotorBus
from .traffic import MIXES, Loss, Sent, Traffic, in_cycles, together, with_clock_jumps, with_marks

EDITIONS = {called(file): specification(file).edition for file in WITHOUT_SETTINGS_IN_IDS}
MOTOR = EDITIONS["mwd_motor/v2.35"]
WITH_WRITES = EDITIONS["mwd_motor/v2.35-2024-02"]
JOINT = EDITIONS["joint/v1"]

BARS = {Loss(): 0.01, Loss(0.01): 0.07, Loss(0.1): 0.5, Loss(0.1, has_retries=True): 1.2}
"""The allowed share of wrong directions without marks, in percent."""


def judge(edition: Edition, recorded: Iterable[LogFrame], **options: object) -> list[DirectedFrame]:
    return list(Directions({}, edition, **options).classify(recorded))  # type: ignore[arg-type]


def summarized(
    edition: Edition, recorded: Iterable[LogFrame], window: int | None = None
) -> tuple[list[DirectedFrame], list[str]]:
    """The frames with their directions, and the doubts."""
    directions, summary = Directions({}, edition, window=window), Summary()
    judged = list(directions.classify(recorded))
    for row in RowReader(lambda *_: {}).rows(judged):
        summary.add(row)
    summary.finish()
    return judged, [*doubts(summary, directions.behaviours or {})]


def doubts_of(edition: Edition, recorded: Iterable[LogFrame], window: int | None = None) -> list[str]:
    return summarized(edition, recorded, window)[1]


def wrong(edition: Edition, log: Sequence[Sent]) -> float:
    """The share of wrong directions in percent."""
    judged = judge(edition, [sent.recorded for sent in log])
    count = sum(frame.direction is not sent.direction for frame, sent in zip(judged, log, strict=True))
    return 100 * count / len(log)


def frames(text: str, step: int = 100_000) -> list[LogFrame]:
    """Frames as `ID#DATA`, at equal distances in ns."""
    lines = (line.split("#") for line in text.split())
    return [
        LogFrame(number * step, "can0", CanFrame(int(id_, 16), bytes.fromhex(data)), None)
        for number, (id_, data) in enumerate(lines)
    ]


def rows(judged: Iterable[DirectedFrame]) -> list[tuple[str, str, int | None]]:
    return [
        (
            frame.message.name if frame.message else frame.direction.value if frame.direction else "",
            frame.decided_by.value,
            frame.request,
        )
        for frame in judged
    ]


def test_content_pairing_and_broadcast() -> None:
    log = frames("""141#9A00000000000000 141#9A3200E701000000 141#8000000000000000 141#8000000000000000
        280#0100020003000400 141#A13200E701000000 144#A13200E701000000 141#9B00000000000000 141#9A3200E701000000
        7FF#00 141#EE00000000000000""")
    judged = judge(MOTOR, log)
    assert rows(judged) == [
        ("read_status_1_request", "pairing", None),
        ("read_status_1_reply", "content", 0),
        ("motor_off_request", "pairing", None),
        ("motor_off_reply", "pairing", 2),
        ("broadcast_torque_request", "id", None),
        ("set_torque_reply", "content", 4),
        ("set_torque_reply", "content", 4),
        ("clear_errors_request", "pairing", None),
        ("clear_errors_reply", "content", 7),
        ("", "none", None),
        ("", "none", None),
    ]
    assert [frame.latency for frame in judged][:7] == [None, 100_000, None, 100_000, None, 100_000, 200_000]
    assert [frame.node for frame in judged][3:7] == [1, None, 1, 4]
    assert judged[-1].rejection is not None and judged[-1].edition is MOTOR and judged[-2].edition is None


def test_a_repeated_echo_is_a_retry_and_a_late_one_a_reply() -> None:
    off = CanFrame(0x141, bytes.fromhex("8000000000000000"))
    times = [0, 1_000_000, 1_200_000, 9_000_000, 10_000_000]
    judged = judge(MOTOR, [LogFrame(time, "can0", off, None) for time in times])
    assert rows(judged) == [
        ("motor_off_request", "pairing", None),
        ("motor_off_request", "retry", None),
        ("motor_off_reply", "pairing", 1),
        ("motor_off_request", "pairing", None),
        ("motor_off_reply", "pairing", 3),
    ]


def test_a_reply_that_the_request_allows_and_two_requests_in_a_row() -> None:
    """A torque of 0 at 0 degC: the next frame decides."""
    reply = frames("141#A10000000A000000 141#A10000000B000000 141#A10000000A000000", 300_000)
    requests = frames("141#A10000000A000000 141#A10000000B000000 141#A13200E701000000", 300_000)
    request_, reply_ = Direction.REQUEST, Direction.REPLY
    assert [frame.direction for frame in judge(MOTOR, reply)] == [request_, reply_, request_]
    assert [frame.direction for frame in judge(MOTOR, requests)] == [request_, request_, reply_]


def test_nodes_of_two_editions_obey_one_broadcast() -> None:
    older = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition
    log = frames("280#0100020003000400 141#A13200E701000000 142#A13200E701000000 143#A13200E701000000")
    judged = list(Directions({("can0", 2): older, ("can0", 3): MOTOR}, MOTOR).classify(log))
    assert [frame.edition for frame in judged] == [older, MOTOR, older, MOTOR]
    assert [frame.request for frame in judged] == [None, 0, 0, 0]


def test_without_times_the_order_counts() -> None:
    log = [frame._replace(time=None) for frame in frames("141#8000000000000000 " * 4)]
    assert [frame.request for frame in judge(MOTOR, log)] == [None, 0, None, 2]
    assert judge(MOTOR, log)[1].latency is None


@pytest.mark.parametrize("mix", MIXES)
def test_wrong_directions_without_marks(mix: str) -> None:
    for loss, bar in BARS.items():
        log = Traffic(MOTOR, mix, 7, loss=loss).frames(1500)
        assert wrong(MOTOR, log) <= bar + 100 / len(log), (mix, loss)
    second_bus = Traffic(MOTOR, mix, 8, loss=Loss(0.01), bus="can1").frames(800)
    log = with_clock_jumps(together([Traffic(MOTOR, mix, 9, loss=Loss(0.01)).frames(800), second_bus]), 1)
    assert wrong(MOTOR, log) <= 0.15, mix


@pytest.mark.parametrize("spec", EDITIONS)
def test_marks_are_obeyed(spec: str) -> None:
    edition = EDITIONS[spec]
    log = with_marks(Traffic(edition, "mixed", 3, loss=Loss(0.1, has_retries=True, not_recorded=0.1)).frames(100))
    judged = judge(edition, [sent.recorded for sent in log])
    assert [frame.direction for frame in judged] == [sent.direction for sent in log]
    # That of a node of which no request is recorded does not count.
    assert sum(frame.decided_by is DecidedBy.MARK for frame in judged) > 0.8 * len(judged)
    assert all(frame.message is not None for frame in judged)


def repeated(frames: Sequence[LogFrame], after: int) -> list[LogFrame]:
    """The frames of two recorders, the clock of the second of which is late by some ns."""
    later = [frame._replace(time=frame.time + after) for frame in frames if frame.time is not None]
    return sorted([*frames, *later], key=lambda frame: frame.time or 0)


@pytest.mark.parametrize("after", [1_900_000, 12_000_000, 250_000_000])
def test_a_log_of_two_recorders(after: int) -> None:
    """Replies would be paired with requests of the other recorder."""
    log = [sent.recorded for sent in MotorBus("polling", motor_bus.SITUATIONS["clean"], 1).frames(500)]
    text = " ".join(doubts_of(MOTOR, repeated(log, after)))
    assert f"each frame is recorded twice, again after {after / 1e6:g} ms" in text


@pytest.mark.parametrize("mix", motor_bus.MIXES)
@pytest.mark.parametrize("name", motor_bus.SITUATIONS)
def test_a_log_of_one_recorder_is_not_taken_for_that_of_two(name: str, mix: str) -> None:
    log = [sent.recorded for sent in MotorBus(mix, motor_bus.SITUATIONS[name], 1).frames(500)]
    assert repeated_after(log) is None or "doubled" in name
    poll = "0 141#9A00000000000000, 300 141#9A32081364000000"
    toggling = [poll, poll.replace("1364000000", "1364000001")]
    twice = f"{poll}, 2000 141#9A00000000000000, 2300 141#9A32081364000000"
    for cycles in ([poll], [twice], toggling):
        assert repeated_after(in_cycles(*cycles * 50)) is None
    assert repeated_after(repeated(in_cycles(*toggling * 50), 12_000_000)) == 12_000_000


def test_two_requests_at_once_are_both_answered() -> None:
    """A host that does not wait for the reply; one that repeats a request waits for it."""
    replies = "400 141#9A32081364000000, 600 141#9A32091364000000"
    judged = judge(WITH_WRITES, in_cycles(*[f"0 141#9A00000000000000, 120 141#9A00000000000000, {replies}"] * 2))
    assert [frame.request for frame in judged] == [None, None, 0, 1, None, None, 4, 5]
    retried = "0 141#9A00000000000000, 600 141#9A00000000000000, 900 141#9A32081364000000"
    assert [frame.request for frame in judge(WITH_WRITES, in_cycles(retried))] == [None, None, 1]


@pytest.mark.parametrize("count", [3, 20])
def test_copies_in_a_log_without_times(count: int) -> None:
    """Neither they nor the next request are replies; they are known as copies if there are enough of them."""
    cycle = "0 141#9200000000000000, 80 141#9200000000000000, 300 141#9210270000000000"
    log = [frame._replace(time=None) for frame in in_cycles(*[cycle] * count)]
    judged = judge(WITH_WRITES, log)
    assert [frame.direction for frame in judged] == [Direction.REQUEST, Direction.REQUEST, Direction.REPLY] * count
    assert {frame.decided_by for frame in judged[1::3]} == {DecidedBy.COPY if count == 20 else DecidedBy.RETRY}


def test_echoes_later_than_the_window_are_a_reason_to_doubt() -> None:
    status, write = "0 141#9A00000000000000, 300 141#9A32081364000000", "0 141#B10E000022000000"
    (sentence,) = doubts_of(WITH_WRITES, in_cycles(*[*[status] * 10, f"{write}, 2300 141#B10E000022000000"] * 4))
    assert sentence.startswith("can0: 4 of 48 requests repeat the one before, and can be its late reply; ")
    assert doubts_of(WITH_WRITES, in_cycles(*[*[status] * 10, write] * 4)) == []


def test_a_short_log_of_requests_with_old_bytes_is_a_reason_to_doubt() -> None:
    """Both look like replies, but no motor replies twice at once; replies of a recorder without requests are further apart."""
    first, second = "0 141#9C0000005AFF0000", "141#9C27D4FFFEFFFE61"
    (sentence,) = doubts_of(WITH_WRITES, in_cycles(*[f"{first}, 270 {second}"] * 2))
    assert sentence.startswith("can0: 2 of 4 replies follow others that can be their requests, with old bytes; ")
    assert doubts_of(WITH_WRITES, in_cycles(*[f"{first}, 1000 {second}"] * 2)) == []


def test_a_request_repeats_one_with_other_reserved_bits() -> None:
    """Also if these are keys of other commands of the edition."""
    log = in_cycles("0 141#9A00000000000000, 4000 141#9A05B20000000000, 5000 181#9A32081364000000")
    judged = judge(EDITIONS["mwd_motor/v2.36-2025-03"], log, window=20_000_000)
    assert [frame.request for frame in judged] == [None, None, 1]


def test_a_short_log_of_slow_replies_names_the_window() -> None:
    cycle = "0 141#9A00000000000000, 4200 141#9A32081364000000"
    assert doubts_of(WITH_WRITES, in_cycles(*[cycle] * 3)) == [
        "can0: replies come after up to 4.2 ms: --window 5 pairs them"
    ]
    assert doubts_of(WITH_WRITES, in_cycles(*[cycle] * 3), window=5_000_000) == []


def test_late_replies_are_a_reason_to_doubt() -> None:
    soon, late = (f"0 141#9A00000000000000, {after} 141#9A32081364000000" for after in (300, 9_000))
    (sentence,) = doubts_of(WITH_WRITES, in_cycles(*[*[soon] * 19, late] * 10))
    assert sentence.startswith("can0: 10 of 200 replies answer no request in the log: ")
    assert doubts_of(WITH_WRITES, in_cycles(*[soon] * 99, late)) == []


def test_a_stream_of_many_nodes_is_learned_a_few_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not again for each node that completes its marks; these count from there."""
    learn, counts = Directions.learn, list[int]()

    def counting(self: Directions, start: Sequence[LogFrame]) -> object:
        counts.append(len(start))
        return learn(self, start)

    monkeypatch.setattr(Directions, "learn", counting)
    # Each reply could be a request, too.
    polls = [f"0 {node:X}#9A00000000000000 T, 300 {node:X}#9A00000000000000 R" for node in range(0x141, 0x161)]
    judged = judge(MOTOR, in_cycles(*polls, *polls), is_stream=True)
    assert counts == [64, 128]
    assert [frame.direction for frame in judged] == [Direction.REQUEST, Direction.REPLY] * 64


def test_memory_does_not_grow_with_random_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("canwright.recordings.frame_classes.MAX_CLASSES", 1 << 6)
    chance, classes = random.Random(1), FrameClasses(EDITIONS["mwd_motor/v2.36-2025-03"])
    tracemalloc.start()
    for number in range(4000):
        classes.of(CanFrame(0x141 + number % 100, chance.randbytes(8)))
    size = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert size < 400_000


def test_memory_does_not_grow_with_the_log() -> None:
    chance = random.Random(1)
    edition = EDITIONS["joint/v1"]

    def noise(count: int) -> Iterable[LogFrame]:
        for number in range(count):
            frame = CanFrame(chance.getrandbits(11) | 0x700, chance.randbytes(8), number % 3 == 0)
            yield LogFrame(number * 130_000, "can0", frame, None)

    directions = Directions({}, edition, behaviours={})
    peaks = []
    for _ in range(2):
        tracemalloc.start()
        for _ in directions.classify(noise(4000)):
            pass
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < peaks[0] + 200_000


# Short logs of few different frames: each sequence is likely, the unlikely ones of the simulator too.
ALPHABET = frames("""141#8000000000000000 141#9A00000000000000 141#9A3200E701000000 141#A100000001000000
    141#A10000000A000000 141#A13200E701000000 142#8000000000000000 280#0100020003000400 7FF#00 141#EE""")
STEPS = (0, 100_000, 400_000, 600_000, 1_500_000, WINDOW, WINDOW + 1, 5_000_000, -1_000_000, None)


@st.composite
def logs(draw: st.DrawFn) -> list[LogFrame]:
    log, time = [], 10**10
    for frame, step, bus in draw(
        st.lists(st.tuples(st.sampled_from(ALPHABET), st.sampled_from(STEPS), st.sampled_from(["a", "b"])), max_size=24)
    ):
        time += step or 0
        log.append(frame._replace(time=None if step is None else time, bus=bus))
    return log


def facts(frame: DirectedFrame, numbers: Sequence[int]) -> tuple[object, ...]:
    """The result for a frame that does not depend on the part of the log; `numbers` are those in the whole log."""
    request = None if frame.request is None else numbers[frame.request]
    return numbers[frame.number], frame.direction, frame.decided_by, frame.message, request, frame.latency


@given(logs())
@settings(max_examples=60)
def test_each_frame_once_in_order_and_each_bus_on_its_own(log: list[LogFrame]) -> None:
    judged = judge(MOTOR, log)
    assert [frame.recorded for frame in judged] == log
    assert [frame.number for frame in judged] == list(range(len(log)))
    swapped = judge(MOTOR, [frame._replace(bus={"a": "b", "b": "a"}[frame.bus]) for frame in log])
    assert [frame[2:] for frame in swapped] == [frame[2:] for frame in judged]
    for bus in "ab":
        numbers = [number for number, frame in enumerate(log) if frame.bus == bus]
        alone = judge(MOTOR, [log[number] for number in numbers])
        assert [facts(frame, numbers) for frame in alone] == [
            facts(frame, range(len(log))) for frame in judged if frame.recorded.bus == bus
        ]


@given(logs())
@settings(max_examples=60)
def test_a_reply_answers_an_earlier_request_of_its_bus(log: list[LogFrame]) -> None:
    judged = judge(MOTOR, log)
    for frame in judged:
        if frame.request is not None:
            asked = judged[frame.request]
            assert asked.direction is Direction.REQUEST and frame.direction is Direction.REPLY
            assert asked.number < frame.number and asked.recorded.bus == frame.recorded.bus
            assert frame.latency is None or frame.latency >= 0


@given(logs())
@settings(max_examples=80)
def test_parts_have_the_results_of_the_whole_log(log: list[LogFrame]) -> None:
    """Also of a log in which some frames have a time."""
    log = [frame._replace(bus="a") for frame in log]
    whole = judge(MOTOR, log)
    cuts = [after.number for before, after in pairwise(whole) if is_silent(before, after)]
    parts = [log[start:end] for start, end in pairwise([0, *cuts, len(log)])]
    starts = [0, *cuts]
    results = [
        facts(frame, range(start, len(log)))
        for start, part in zip(starts, parts, strict=True)
        for frame in judge(MOTOR, part, behaviours=Directions({}, MOTOR).learn(log))
    ]
    assert results == [facts(frame, range(len(log))) for frame in whole]


def is_silent(before: DirectedFrame, after: DirectedFrame) -> bool:
    start, end = before.recorded.time, after.recorded.time
    return start is not None and end is not None and end - start > WINDOW


@pytest.mark.parametrize("mix", motor_bus.MIXES)
@pytest.mark.parametrize("name", motor_bus.SITUATIONS)
@pytest.mark.parametrize("seed", [1, 2])
def test_hosts_recorders_and_motors_of_any_behaviour(name: str, mix: str, seed: int) -> None:
    """Directions are correct, or a sentence states the reason for doubt."""
    log = MotorBus(mix, motor_bus.SITUATIONS[name], seed).frames(1200)
    judged, doubtful = summarized(MOTOR, (sent.recorded for sent in log))
    share = sum(frame.direction is not sent.direction for frame, sent in zip(judged, log, strict=True)) / len(log)
    is_disturbed = any(word in name for word in ("late", "reordered", "not recorded"))
    if not is_disturbed or "not recorded" in name:
        assert bool(doubtful) is (is_disturbed or "old" in name or "random" in name or name == "slow, 10 %, retries")
    if not doubtful:
        assert share <= (0.001 if is_disturbed else 0.0005), share
        replies = sum(sent.direction is Direction.REPLY for sent in log)
        assert sum(frame.request is not None for frame in judged) > 0.85 * replies
        assert sum(frame.is_late for frame in judged) < 0.01 * replies
    elif mix != "control":
        assert share <= (0.03 if "retries" in name else 0.015 if is_disturbed else 0.01), share
    copies = sum(frame.decided_by is DecidedBy.COPY for frame in judged)
    assert copies == (sum(sent.direction is Direction.REQUEST for sent in log) // 2 if "doubled" in name else 0)


@pytest.mark.parametrize("direction", Direction)
@pytest.mark.parametrize("mix", motor_bus.MIXES)
@pytest.mark.parametrize("is_irregular", [False, True])
def test_a_log_of_one_direction(direction: Direction, mix: str, is_irregular: bool) -> None:
    """Echoes are no requests, replies no requests with old bits, and requests no replies to earlier ones."""
    rng = random.Random(1)
    log = MotorBus(mix, motor_bus.SITUATIONS["clean"], 1).frames(500)
    listed = [
        sent.recorded for sent in log if sent.direction is direction and not (is_irregular and rng.random() < 0.5)
    ]
    directions = Directions({}, MOTOR)
    assert {judged.direction for judged in directions.classify(listed)} == {direction}


def test_a_stream_is_decided_without_its_next_frames() -> None:
    """What its first frames show counts for later ones; a mark of a sent frame counts at once."""
    log = MotorBus("control", motor_bus.SITUATIONS["old requests"], 1).frames(2000)
    taken = 0

    def stream() -> Iterable[LogFrame]:
        nonlocal taken
        for sent in log:
            taken += 1
            yield sent.recorded

    wrong = []
    for number, judged in enumerate(Directions({}, MOTOR, is_stream=True).classify(stream())):
        assert taken - number <= 64
        wrong += [number] * (judged.direction is not log[number].direction)
    assert all(number < 64 for number in wrong)
    marked = with_marks(log[:64])
    listed = Directions({}, MOTOR, is_stream=True).classify(sent.recorded for sent in marked)
    assert [judged.direction for judged in listed] == [sent.direction for sent in marked]


def late(times: Sequence[int]) -> list[bool]:
    """Whether frames at these times, requests and replies in turn, are late."""
    log = frames("141#9A00000000000000 141#9A3200E701000000 " * (len(times) // 2))
    timed = [frame._replace(time=time) for frame, time in zip(log, times, strict=True)]
    return [frame.is_late for frame in judge(MOTOR, timed)]


def test_a_late_reply_is_late_for_the_log() -> None:
    """Not by the time of the spec, in which the time to send the reply is missing."""
    times = [10_000_000 * number + step for number in range(20) for step in (0, 400_000)]
    times[-1] += 1_000_000
    assert late(times) == [False] * 39 + [True]


@pytest.mark.parametrize(("latency", "is_late"), [(1, False), (2, True)])
def test_a_reply_is_late_only_by_more_than_the_resolution_of_the_times(latency: int, is_late: bool) -> None:
    """At 1 ms: the reply of 1 ms took more than 0 ms, that of 2 ms more than 1 ms; 0.5 ms are permitted."""
    times = [1_841_000_000, 1_842_000_000, 1_851_000_000, 1_851_000_000 + latency * 1_000_000]
    assert late(times) == [False] * 3 + [is_late]


def test_a_command_with_a_reply_time_of_its_own() -> None:
    edition = EDITIONS["mwd_motor/v2.36-2025-03"]
    log = frames("141#1800000000000000 141#9A00000000000000 181#9A32081364000000 181#18D20400E8030001")
    log[-1] = log[-1]._replace(time=3_500_000_000)
    judged = judge(edition, log)
    assert [frame.request for frame in judged] == [None, None, 1, 0]
    assert judged[-1].latency == 3_500_000_000 and not judged[-1].is_late
    late = [*log[:-1], log[-1]._replace(time=10_500_000_000)]
    assert judge(edition, late)[-1].request is None
