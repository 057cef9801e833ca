"""The summary of `canwright decode` counts frames that are missing or repeated according to their counter."""

from __future__ import annotations

from pathlib import Path

from ..spec_texts import MINIMAL
from .test_periods import summary_lines

BEAT = "  beat: {code: 0x20, request: {count: {at: 6, raw: u4, counter: 1..14}}, reply: none}\n"


def summary(folder: Path, *frames: str) -> list[str]:
    """The summary of a log with a frame every 10 ms, by line."""
    spec = folder / "lamp.yaml"
    spec.write_text(MINIMAL + BEAT, "utf-8")
    return summary_lines(folder, spec, ((at / 100, frame) for at, frame in enumerate(frames)))


def beat(count: int, node: int = 1) -> str:
    """A frame of `beat` with a counter."""
    return f"10{node}#200000000000{count:02X}00"


def test_a_counter_without_gaps(tmp_path: Path) -> None:
    """It starts again after its last value, and need not start with its first."""
    counts = [*range(5, 15), *range(1, 15), 1]
    assert summary(tmp_path, *map(beat, counts)) == ["can0, node 1, v1: 25 requests, 0 replies"]


def test_gaps_and_repetitions_of_a_counter(tmp_path: Path) -> None:
    """After 3, one frame is missing; after 13, three: 14, 1 and 2. 6 is repeated; 15 and 0 are no values of the counter."""
    assert summary(tmp_path, *map(beat, [2, 3, 5, 15, 6, 6, *range(7, 14), 3, 0, 4])) == [
        "can0, node 1, v1: 16 requests, 0 replies",
        "  beat_request: counter `count` from 1 to 14; 2 gaps, 4 frames missing; 1 repeated; 2 outside",
    ]


def test_each_node_has_a_counter_of_its_own(tmp_path: Path) -> None:
    frames = [frame for count in range(1, 8) for frame in (beat(count), beat(2 * count % 14 + 1, node=2))]
    assert summary(tmp_path, *frames) == [
        "can0, node 1, v1: 7 requests, 0 replies",
        "can0, node 2, v1: 7 requests, 0 replies",
        "  beat_request: counter `count` from 1 to 14; 6 gaps, 6 frames missing",
    ]


def test_other_messages_do_not_end_a_counter(tmp_path: Path) -> None:
    assert summary(tmp_path, beat(1), "101#1000000000000000", beat(2))[1:] == [
        "  1 missing: 1 request without an answer"
    ]
