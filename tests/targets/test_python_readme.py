"""The programs of the README of a Python package, on a virtual bus with a node that answers."""

from __future__ import annotations

import itertools
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.semantics.exchange import is_read
from canwright.targets.base import EditionInput
from canwright.targets.python.examples import Example, example
from canwright.targets.python.text import class_name

from ..samples import sampled
from ..spec_texts import ROOT, SPECS, called
from .test_python import write

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"

VIRTUAL = """\
import threading
import can
RealBus = can.Bus
can.Bus = lambda channel, interface: RealBus(channel, interface="virtual", receive_own_messages={returned})
"""

NODE = """\
REPLIES = {replies}
def simulated_node():
    with RealBus("can0", interface="virtual") as bus:
        ready.set()
        while True:
            asked = bus.recv()
            bus.send(can.Message(arbitration_id=0x7FE, data=b"other", is_extended_id=False))
            for can_id, data in REPLIES.get((asked.arbitration_id, bytes(asked.data)), ()):
                bus.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=asked.is_extended_id))
ready = threading.Event()
threading.Thread(target=simulated_node, daemon=True).start()
ready.wait()
"""

PATIENT = r"\1, timeout=10"
"""A time-out that a busy machine keeps."""
CLIENT = re.compile(r"(Client\(bus, \[[^\n]*\])")
SIMULATION = re.compile(r"(Simulation\(other_bus, \[[^\n]*\], Printed)")


def programs(folder: Path) -> list[str]:
    """The programs of the README, each of which continues the one before it."""
    return re.findall(r"```python\n(.*?)```", (folder / "README.md").read_text("utf-8"), re.DOTALL)


def run(folder: Path, *parts: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "\n".join(parts)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


Frame = tuple[int, bytes]


def answers(item: EditionInput, x: Example) -> dict[Frame, list[Frame]]:
    """The replies of the node to the requests of the programs, as golden frames have them."""
    assert item.frames is not None
    sent = [
        frame
        for frame in item.frames.frames
        if class_name(f"{frame.command}_request") == x.request and frame.direction is Direction.REQUEST
    ]
    command = next(command for command in item.edition.commands if class_name(f"{command.name}_request") == x.request)
    parts = [
        (frame.id, frame.data)
        for frame in item.frames.frames
        if (frame.command, frame.direction, frame.id) == (command.name, Direction.REPLY, x.frame.id)
    ]
    several = command.reply is not None and command.reply.sequence is not None
    replies = {(frame.id, frame.data): parts if several else [(x.frame.id, x.frame.data)] for frame in sent}
    for command in item.edition.commands:
        if is_read(item.edition, command) or command.ends_motion is not None:
            assert command.request is not None and command.reply is not None
            ids = [rule.base + x.node * rule.node_step for rule in (command.request.id, command.reply.id)]
            data = [
                next(f.data for f in item.frames.frames if command.name == f.command and f.direction.value == kind)
                for kind in KINDS
            ]
            replies[ids[0], data[0]] = [(ids[1], data[1])]
    return replies


KINDS = ("request", "reply")


def started(returned: bool, replies: Mapping[Frame, Sequence[Frame]]) -> str:
    """A virtual bus that returns own frames or not, with a node that gives these answers."""
    return VIRTUAL.format(returned=returned) + NODE.format(replies=dict(replies))


@pytest.mark.parametrize(
    ("spec", "returned"),
    sampled(list(itertools.product(SPECS, (False, True))), 3),  # so that each bus meets every second spec or so
    ids=lambda value: called(value) if isinstance(value, Path) else str(value),
)
def test_all_programs(spec: Path, returned: bool, tmp_path: Path) -> None:
    """They send what a golden frame has, read the reply of the node, and print no value that is only raw."""
    folder, item = write(tmp_path, spec), specification(spec)
    x = example([item])
    assert item.frames is not None and isinstance(x, Example)
    requests = [frame for frame in item.frames.frames if frame.direction is Direction.REQUEST]
    known = f", own_frames={returned}" if x.shares_ids and not item.edition.effects else ""
    shown = [CLIENT.sub(PATIENT + known, program) for program in programs(folder)]
    shown = [SIMULATION.sub(rf"\1, own_frames={returned}", program) for program in shown]
    done = run(folder, started(returned, answers(item, x)), *shown)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    ids = [f"{frame.id:08X}" if frame.extended else f"{frame.id:03X}" for frame in requests]
    assert lines[0].strip() in {
        f"{id_} {f.data.hex(' ').upper()}".strip() for id_, f in zip(ids, requests, strict=True)
    }
    assert "_raw=" not in done.stdout and "no reply" not in done.stdout
    executed = [line for line in lines if line.startswith("executes ")]  # the reads of the client first
    lines = [line for line in lines if line not in executed]
    _, reply, value, _, values, raw, _, *cycles, of_async, simulated, variables, made, _ = lines
    assert values.startswith("{'") and raw.startswith("{'")
    assert {*cycles} == {value} and of_async == reply and made.startswith(f"{x.request}(")
    assert any(line.startswith(f"executes {x.request}(") for line in executed)
    assert simulated.startswith(f"{x.reply}(") and variables[0] == "{"


@pytest.mark.parametrize("returned", [False, True])
def test_a_silent_node_ends_the_control_loop(returned: bool, tmp_path: Path) -> None:
    """A request that the bus returns is no reply."""
    folder, item = write(tmp_path, SPEC), specification(SPEC)
    x = example([item])
    assert isinstance(x, Example)
    silent = {sent: replies for sent, replies in answers(item, x).items() if replies[0][1] != x.frame.data}
    # a time-out within which a busy machine answers the reads
    shown = [CLIENT.sub(r"\1, timeout=1", program) for program in programs(folder)]
    done = run(folder, started(returned, silent), *shown)
    cycles = [line for line in done.stdout.splitlines()[7:] if "SetPowerRequest" not in line]
    assert (cycles, done.returncode) == ([], 1)
    assert done.stderr.endswith("NoReply: no reply to SetPowerRequest(node=1, power=200)\n")


@pytest.mark.interop("mypy")
def test_programs_are_typed(tmp_path: Path) -> None:
    folder = write(tmp_path, SPEC)
    (folder / "use.py").write_text("".join(programs(folder)), "utf-8")
    mypy = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "use.py"]
    done = subprocess.run(mypy, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
