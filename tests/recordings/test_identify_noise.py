"""Logs with corrupted frames, foreign protocols and careless hosts: what `identify` reports, and what it does not."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator

import pytest
from canwright.cli import main
from canwright.project.loader import spec_files, specification
from canwright.recordings.grouping import groups
from canwright.recordings.identify import identify
from canwright.recordings.log_frame import LogFrame
from canwright.recordings.results import Identification
from canwright.semantics.frame import CanFrame
from click.testing import CliRunner

from ..spec_texts import ROOT
from . import mixed_buses as buses
from .mixed_buses import Motor

EDITIONS = {e.name: e for e in (specification(file).edition for file in spec_files(ROOT / "spec"))}
NODES = range(1, 19)
Frames = Iterable[CanFrame]


MIX = ("status", "torque", "feedback")
OWN = {"v2.36-2024-11": ("current_ramp",), "v2.36-2025-03": ("lower_angle",)}
"""What only one of two similar editions has."""


def traffic(name: str, rounds: int = 20, nodes: Iterable[int] = NODES) -> Iterator[CanFrame]:
    """A host that polls the status of motors, sets their torque and reads their state."""
    asked = (*MIX, *OWN.get(name, ()))
    motors = [Motor(node, name, asked, first=()) for node in nodes]
    return (CanFrame(frame.id, frame.data) for frame in buses.frames(motors, rounds * len(asked), 7))


def corrupted(frames: Frames, share: float, seed: int) -> Iterator[CanFrame]:
    """Frames of which some have a flipped bit, and as many have random data."""
    rng = random.Random(seed)
    for frame in frames:
        if rng.random() < share:
            word = int.from_bytes(frame.data, "little") ^ 1 << rng.randrange(8 * len(frame.data))
            flipped = word.to_bytes(len(frame.data), "little")
            yield frame._replace(data=rng.choice([flipped, rng.randbytes(len(frame.data))]))
        else:
            yield frame


def identified(frames: Frames, bus: str = "can0") -> Identification:
    return identify((LogFrame(None, bus, frame, None) for frame in frames), list(EDITIONS.values()))


def fits(identification: Identification) -> dict[int | None, list[str]]:
    return {result.node: [edition.name for edition in result.editions] for result in identification.nodes}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", EDITIONS)
def test_three_of_a_hundred_frames_are_corrupted(name: str, seed: int) -> None:
    nodes = range(1, 7)
    assert fits(identified(corrupted(traffic(name, nodes=nodes), 0.03, seed))) == {node: [name] for node in nodes}


CANOPEN = ["40000A1000000000", "4300101892010F00", "80000A1000000006", "2F60600001000000", "05", "7F", "", "9C"]
"""SDO transfers, heartbeats, and frames with one byte or none."""


@pytest.mark.parametrize("foreign", CANOPEN)
@pytest.mark.parametrize("name", EDITIONS)
def test_a_canopen_frame_on_the_id_of_a_motor(name: str, foreign: str) -> None:
    for at in (0, 1, 100):
        frames = list(traffic(name, rounds=30, nodes=[1]))
        frames.insert(at, CanFrame(frames[0].id, bytes.fromhex(foreign)))
        assert fits(identified(frames)) == {1: [name]}, at


def test_the_buses_of_a_log_are_independent() -> None:
    both = [
        LogFrame(None, bus, frame, None)
        for name, bus in (("v2.35", "can0"), ("v2.36-2025-03", "can1"))
        for frame in traffic(name, rounds=3)
    ]
    identification = identify(both, list(EDITIONS.values()))
    assert {(result.bus, *(e.name for e in result.editions)) for result in identification.nodes} == {
        ("can0", "v2.35"),
        ("can1", "v2.36-2025-03"),
    }
    assert [len(group.nodes) for group in groups(identification.nodes)] == [18, 18]


def canopen() -> Iterator[CanFrame]:
    """Process data, heartbeats, emergencies and SDO transfers of drives with the nodes 1 to 8."""
    rng = random.Random(3)
    for _ in range(50):
        for node in range(1, 9):
            yield CanFrame(0x180 + node, b"\x37\x06" + rng.randbytes(4))
            yield CanFrame(0x200 + node, b"\x0f\0" + rng.randbytes(4))
            yield CanFrame(0x280 + node, rng.randbytes(8))
            yield CanFrame(0x600 + node, bytes.fromhex("4041600000000000"))
            yield CanFrame(0x580 + node, bytes.fromhex("4B41600037060000"))
            yield CanFrame(0x700 + node, b"\x05")


def j1939() -> Iterator[CanFrame]:
    """Engine data with 29-bit ids."""
    rng = random.Random(3)
    for _ in range(50):
        for id_ in (0x0CF00400, 0x18FEF100, 0x18FEEE00, 0x00000141):
            yield CanFrame(id_, rng.randbytes(8), extended=True)


def rmd_v3() -> Iterator[CanFrame]:
    """Motors with the same codes for requests, whose replies have the ids 0x240 + node, and a broadcast on 0x280."""
    rng = random.Random(3)
    for _ in range(50):
        yield CanFrame(0x280, b"\x9c" + bytes(7))
        for node in range(1, 5):
            for code in (0x9A, 0x9C, 0x92, 0xA4, 0x81):
                yield CanFrame(0x140 + node, bytes([code]) + bytes(7))
                yield CanFrame(0x240 + node, bytes([code]) + rng.randbytes(7))


def random_frames() -> Iterator[CanFrame]:
    """Frames of any length on the ids of motors."""
    rng = random.Random(3)
    for _ in range(2000):
        yield CanFrame(rng.randrange(0x140, 0x1A1), rng.randbytes(rng.randrange(9)))


def dead_motor() -> Iterator[CanFrame]:
    """A host that polls a motor which is off."""
    return (CanFrame(0x141, b"\x9a" + bytes(7)) for _ in range(50))


@pytest.mark.parametrize("frames", [canopen, j1939, rmd_v3, random_frames, dead_motor])
def test_no_edition_fits_foreign_traffic(frames: Callable[[], Frames]) -> None:
    assert not any(fits(identified(frames())).values())


@pytest.mark.parametrize("folder", ["spec", "spec/mwd_motor"])
def test_equal_motors_are_one_result(folder: str) -> None:
    log = "".join(
        f"(1.000000) can0 {frame.id:03X}#{frame.data.hex().upper()}\n"
        for frame in traffic("v2.35", rounds=6, nodes=range(1, 33))
    )
    options = ["identify", "-", "--spec", str(ROOT / folder)]
    result = CliRunner().invoke(main, options, input=log)
    assert result.exit_code == 0, result.output
    assert "mwd_motor, nodes 1..32, 1152 frames: fits v2.35\n" in result.output
    assert "\n  v2.36-2024-11, v2.36-2025-03 explain 576 of 1152 frames; " in result.output
    assert len(result.output.splitlines()) < 15


def test_what_is_identified_is_printed_first() -> None:
    log = "".join(
        f"({number / 100:.6f}) {bus} {frame.id:03X}#{frame.data.hex().upper()}\n"
        for bus, frames in (
            ("can0", canopen()),
            ("can1", dead_motor()),
            ("can2", traffic("v2.35", rounds=2, nodes=[3])),
        )
        for number, frame in enumerate(frames)
    )
    result = CliRunner().invoke(main, ["identify", "-", "--spec", str(ROOT / "spec")], input=log)
    assert result.exit_code == 1
    assert [line for line in result.output.splitlines() if line.startswith("mwd_motor")] == [
        "mwd_motor, can2, node 3, 12 frames: fits v2.35",
        "mwd_motor, can1, node 1, 50 frames: no edition fits, since 50 of 50 requests have no reply",
        "mwd_motor, can0, nodes 1..8, 400 frames: no edition fits, since only 0 of 400 are of one",
    ]
