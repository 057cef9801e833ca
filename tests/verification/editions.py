"""Simulated buses of all editions: `canwright identify` and `canwright decode` never take an edition for another one.

For each log, of each size and with each kind of marks, as a file and as a stream:

- a row names the true edition, possibly among others; a voltage that differs from the true one is never alone;
- the exit status is 0 only if each edition is identified and each voltage is plausible;
- both commands name the same editions.

It does not cover other protocols on the bus; tests/recordings/test_identify_noise.py does.
"""

from __future__ import annotations

import argparse
import functools
import json
import random
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

from canwright.cli import main as canwright
from canwright.project.loader import spec_files, specification
from canwright.targets.base import EditionInput
from click.testing import CliRunner

from ..recordings import mixed_buses as buses
from ..recordings.mixed_buses import COMMON, EDITIONS, OWN, Frame, Motor
from ..spec_texts import ROOT

ONLY_TORQUE = ("torque",) * 40
MIXES: Sequence[Sequence[str]] = (
    ("status",),
    ("status", "torque", "feedback"),
    ("at_zero", "status", "stop"),
    COMMON,
    (*ONLY_TORQUE, "status"),
)


class Case(NamedTuple):
    """A log with the truth; `is_changed` if the edition of a motor changes, `is_damaged` if frames are."""

    name: str
    frames: Sequence[Frame]
    marks: str
    is_changed: bool = False
    is_damaged: bool = False

    @property
    def is_small(self) -> bool:
        """Whether there are too few replies to see a change."""
        return len(self.frames) < 200


def cases(rounds: int, seed: int) -> Iterator[Case]:
    """Logs of some rounds, each with all marks, complete and without requests."""
    for name, frames, changed, damaged in _logs(rounds, random.Random(seed), seed):
        listed = list(frames)
        for marks in ("", "R", "RT"):
            for kind, log in (("", listed), (", replies only", buses.replies(listed))):
                yield Case(
                    f"{name}{kind}, marks {marks or 'none'}, {rounds} rounds, {seed}", log, marks, changed, damaged
                )


def _logs(rounds: int, rng: random.Random, seed: int) -> Iterator[tuple[str, Sequence[Frame], bool, bool]]:
    def made(*motors: Motor) -> list[Frame]:
        return list(buses.frames(motors, rounds, seed))

    for edition in EDITIONS:
        mix = rng.choice([*MIXES, (*COMMON, *OWN[edition])])
        yield edition, made(*(Motor(node, edition, mix) for node in range(1, rng.randint(2, 5)))), False, False
    mixed = made(*(Motor(node, rng.choice(EDITIONS), rng.choice((MIXES[1], COMMON))) for node in range(1, 7)))
    yield "mixed", mixed, False, False
    first, second = rng.sample(EDITIONS, 2)
    yield f"late {second}", made(Motor(1, first), Motor(2, second, since=rounds * 3 // 4)), False, False
    half = rounds // 2
    late = made(Motor(1, first, ONLY_TORQUE, until=half), Motor(1, first, ("status",), since=half, first=()))
    yield f"late status {first}", late, False, False
    own = {edition: (*COMMON[2:], *OWN[edition]) for edition in EDITIONS}
    changed = (
        Motor(1, first, own[first], until=half),
        Motor(1, second, own[second], since=half, first=()),
        Motor(2, first),
    )
    yield f"{first} to {second}", made(*changed), True, False
    loops = made(
        *(Motor(node, edition, ("torque", "feedback") * 5 + ("status",)) for node, edition in enumerate(EDITIONS, 1))
    )
    yield "old bytes", buses.dirty(loops, seed), False, False
    yield "damaged data", buses.damaged(mixed, 0.02, seed), False, True
    yield "damaged ids", buses.damaged(mixed, 0.01, seed, ids=True), False, True
    yield "a damaged id", _with_a_damaged_id(mixed, rng), False, True


def _with_a_damaged_id(log: Sequence[Frame], rng: random.Random) -> Sequence[Frame]:
    at = rng.randrange(len(log))
    return [*log[:at], *buses.damaged([log[at]], 1, rng.randrange(99), ids=True), *log[at + 1 :]]


def problems(case: Case, folder: Path) -> list[str]:
    """What is wrong with the output for a case; empty if it is as it should be."""
    log = folder / "bus.log"
    log.write_text(buses.text(case.frames, case.marks), "utf-8")
    runner = CliRunner()
    with mock.patch("canwright.cli.identify.read", _read), mock.patch("canwright.cli.decode.read", _read):
        identified = runner.invoke(canwright, ["identify", str(log), "--format", "json"])
        as_file = runner.invoke(canwright, ["decode", str(log), "--format", "jsonl"])
        as_stream = runner.invoke(canwright, ["decode", "-", "--format", "jsonl"], input=log.read_bytes())
        for result in (identified, as_file, as_stream):
            if result.exit_code not in (0, 1):
                return [f"{case.name}: {result.output[-300:]} {result.exception!r}"]
        wrong = [*_wrong_results(case, json.loads(identified.stdout))]
        wrong += _wrong_rows(case, as_file.stdout, as_file.exit_code)
        wrong += (f"stream: {p}" for p in _wrong_rows(case, as_stream.stdout, as_stream.exit_code, stream=True))
        if identified.exit_code == 1 and as_file.exit_code == 0:
            motors = {(frame.motor.bus, frame.motor.node): frame.motor.edition for frame in case.frames}
            given = [f"--set={bus}:{node}:edition={edition}" for (bus, node), edition in motors.items()]
            known = runner.invoke(canwright, ["decode", str(log), "--format", "jsonl", *given])
            if _meanings(known.stdout) != _meanings(as_file.stdout):
                wrong.append("identify has findings, decode none, but values depend on the edition")
    return [f"{case.name}: {problem}" for problem in wrong[:3]]


def _meanings(rows: str) -> list[tuple[object, ...]]:
    return [(row["direction"], row["command"], row["fields"]) for row in map(json.loads, rows.splitlines())]


@functools.cache
def _specifications() -> Sequence[EditionInput]:
    return [specification(file) for file in spec_files(ROOT / "spec")]


def _read(*_: object, **__: object) -> Sequence[EditionInput]:
    """The specs, which are loaded once."""
    return _specifications()


def _wrong_results(case: Case, facts: Any) -> Iterator[str]:
    truth: dict[int, set[str]] = {}
    for frame in case.frames:
        truth.setdefault(frame.motor.node, set()).add(frame.motor.edition)
    for node in facts["nodes"]:
        if node["node"] not in truth:
            if not node["stray"] and len(case.frames) > 1000:
                yield f"node {node['node']} with {node['frames']} frames is not stray"
        elif node["fits"] and not truth[node["node"]].intersection(node["fits"]):
            yield f"node {node['node']} fits {node['fits']}, not {truth[node['node']]}"
        elif node["stray"]:
            yield f"node {node['node']} is stray"
        elif not node["fits"] and not case.is_small:
            yield f"nothing fits node {node['node']}, {node['frames']} frames"


def _wrong_rows(case: Case, rows: str, status: int, *, stream: bool = False) -> Iterator[str]:
    for line, frame in zip(rows.splitlines(), case.frames, strict=True):
        row = json.loads(line)
        voltage = row["fields"].get("voltage", {}).get("value")
        labels = (row["edition"] or "").split("|")
        is_alone = len(labels) == 1 and labels != [""]
        is_excused = frame.is_damaged or (case.is_changed and (stream or case.is_small))
        if is_alone and labels[0] != frame.motor.edition and not is_excused and (status == 0 or not stream):
            yield f"#{row['number']} is {labels[0]}, not {frame.motor.edition}"
        if status == 0 and voltage is not None and not 6 <= voltage <= 100:
            yield f"#{row['number']} is {voltage} V, and the exit status 0"
        if status == 0 and voltage not in (None, frame.voltage) and not frame.is_damaged:
            yield f"#{row['number']} is {voltage} V, not {frame.voltage}, and the exit status 0"


def main() -> int:
    """Prints what is wrong, and the number of logs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default=3, type=int)
    parser.add_argument("--first", default=0, type=int, help="The first seed.")
    parser.add_argument("--rounds", default=[4, 12, 60, 400, 2500], type=int, nargs="+")
    arguments = parser.parse_args()
    count = frames = wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.first, arguments.first + arguments.seeds):
            for rounds in arguments.rounds:
                for case in cases(rounds, seed):
                    listed = problems(case, Path(folder))
                    count, frames, wrong = count + 1, frames + len(case.frames), wrong + bool(listed)
                    for problem in listed:
                        print(problem, flush=True)
    print(f"{count} logs, {frames} frames: {wrong} wrong")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
