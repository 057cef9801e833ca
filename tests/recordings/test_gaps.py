"""The summary of `canwright decode` counts late, missing and repeated frames by periods, time-outs and counters."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from canwright.cli import main
from click.testing import CliRunner

from ..spec_texts import MINIMAL, ROOT

SPEC = ROOT / "tests/specs/pack/v1.yaml"
STATE = "182#00C883FF02"
BEAT = "  beat: {code: 0x20, request: {count: {at: 6, raw: u4, counter: 1..14}}, reply: none}\n"


def summary_lines(folder: Path, spec: Path, frames: Iterable[tuple[float, str]]) -> list[str]:
    """The summary of a log, by line."""
    log = folder / "bus.log"
    log.write_text("".join(f"({time:.6f}) can0 {frame}\n" for time, frame in sorted(frames)), "utf-8")
    done = CliRunner().invoke(main, ["decode", str(log), "--spec", str(spec)])
    return done.output.partition("\n\n")[2].splitlines()


def summary(folder: Path, *frames: tuple[float, str]) -> list[str]:
    return summary_lines(folder, SPEC, frames)


def test_regular_frames_are_neither_late_nor_unexpected(tmp_path: Path) -> None:
    """A period of 100 ms, and delays of less than half of it; a reply among the cyclic frames is no fault either."""
    frames = [(i / 10 + (0.04 if i % 5 == 0 else 0), STATE) for i in range(20)]
    asked = [(0.55, "102#"), (0.551, STATE)]
    assert summary(tmp_path, *frames, *asked) == [
        "can0, node 2, v1: 1 request, 21 replies after 1.000 ms on average, at most 1.000 ms"
    ]


def test_gaps_of_a_cyclic_frame(tmp_path: Path) -> None:
    """Frames 4, 5 and 10 to 15 are missing: gaps of 300 and 700 ms, of which the second exceeds 500 ms."""
    times = [i / 10 for i in range(20) if i not in (4, 5, *range(10, 16))]
    assert summary(tmp_path, *((time, STATE) for time in times))[1:] == [
        "  read_state_reply: every 100 ms, on request, time-out 500 ms; 2 late frames, about 8 missing; 1 time-out; "
        "longest gap 700.000 ms before #8"
    ]


def test_a_watchdog_that_starved(tmp_path: Path) -> None:
    """A limit has a time-out of 1000 ms, and no period."""
    fed = summary(tmp_path, (0, "381#DC05"), (0.9, "381#DC05"), (1.9, "381#DC05"))
    assert len(fed) == 1
    assert summary(tmp_path, (0, "381#DC05"), (0.9, "381#DC05"), (1.95, "381#DC05"))[1:] == [
        "  limit_request: time-out 1000 ms; 1 time-out; longest gap 1050.000 ms before #2"
    ]


def test_a_node_that_falls_silent(tmp_path: Path) -> None:
    """Pack 2 sends its last frame at 0.1 s, and pack 1 sends until 0.7 s."""
    frames = [(0, STATE), (0.1, STATE), *((i / 10, STATE.replace("182", "181")) for i in range(8))]
    assert summary(tmp_path, *frames) == [
        "can0, node 1, v1: 0 requests, 8 replies",
        "can0, node 2, v1: 0 requests, 2 replies",
        "  read_state_reply: every 100 ms, on request, time-out 500 ms; 1 late frame, about 5 missing; 1 time-out; "
        "longest gap 600.000 ms before the end of the log",
    ]


def beats(folder: Path, *frames: str) -> list[str]:
    """The summary of a log of a lamp with a frame every 10 ms, by line."""
    spec = folder / "lamp.yaml"
    spec.write_text(MINIMAL + BEAT, "utf-8")
    return summary_lines(folder, spec, ((at / 100, frame) for at, frame in enumerate(frames)))


def beat(count: int, node: int = 1) -> str:
    """A frame of `beat` with a counter."""
    return f"10{node}#200000000000{count:02X}00"


def test_a_counter_without_gaps(tmp_path: Path) -> None:
    """It starts again after its last value, and need not start with its first."""
    counts = [*range(5, 15), *range(1, 15), 1]
    assert beats(tmp_path, *map(beat, counts)) == ["can0, node 1, v1: 25 requests, 0 replies"]


def test_gaps_and_repetitions_of_a_counter(tmp_path: Path) -> None:
    """After 3, one frame is missing; after 13, three: 14, 1 and 2. 6 is repeated; 15 and 0 are no values of the counter."""
    assert beats(tmp_path, *map(beat, [2, 3, 5, 15, 6, 6, *range(7, 14), 3, 0, 4])) == [
        "can0, node 1, v1: 16 requests, 0 replies",
        "  beat_request: counter `count` from 1 to 14; 2 gaps, 4 frames missing; 1 repeated; 2 outside",
    ]


def test_each_node_has_a_counter_of_its_own(tmp_path: Path) -> None:
    frames = [frame for count in range(1, 8) for frame in (beat(count), beat(2 * count % 14 + 1, node=2))]
    assert beats(tmp_path, *frames) == [
        "can0, node 1, v1: 7 requests, 0 replies",
        "can0, node 2, v1: 7 requests, 0 replies",
        "  beat_request: counter `count` from 1 to 14; 6 gaps, 6 frames missing",
    ]


def test_other_messages_do_not_end_a_counter(tmp_path: Path) -> None:
    assert beats(tmp_path, beat(1), "101#1000000000000000", beat(2))[1:] == ["  1 missing: 1 request without an answer"]
