"""The programs of the README of a Python package, on a virtual bus with a node that answers."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from canwright.project.loader import specification
from canwright.targets.python.examples import Example, example

from ..samples import sampled
from ..spec_texts import ROOT, SPECS, called
from .test_python import write

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"

VIRTUAL = """\
import threading
import can
RealBus = can.Bus
can.Bus = lambda channel, interface: RealBus(channel, interface="virtual")
"""

NODE = """\
def simulated_node():
    with RealBus("can0", interface="virtual") as bus:
        ready.set()
        while True:
            bus.recv()
            bus.send(can.Message(arbitration_id=0x7FE, data=b"other", is_extended_id=False))
            bus.send(can.Message(arbitration_id={id}, data=bytes.fromhex("{data}"), is_extended_id={extended}))
ready = threading.Event()
threading.Thread(target=simulated_node, daemon=True).start()
ready.wait()
"""

PATIENT = "TIMEOUT = 60"
"""A time-out that a busy machine keeps."""


def programs(folder: Path) -> list[str]:
    """The programs of the README, each of which continues the one before it."""
    return re.findall(r"```python\n(.*?)```", (folder / "README.md").read_text("utf-8"), re.DOTALL)


def run(folder: Path, *parts: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "\n".join(parts)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("spec", sampled(SPECS, 2), ids=called)
def test_all_programs(spec: Path, tmp_path: Path) -> None:
    """They send what a golden frame has, read the reply of the node, and print no value that is only raw."""
    folder, item = write(tmp_path, spec), specification(spec)
    x = example([item])
    assert item.frames is not None and isinstance(x, Example)
    node = NODE.format(id=x.reply_id, data=x.data, extended=x.extended)
    done = run(folder, VIRTUAL, node, *(re.sub(r"^TIMEOUT = .*", PATIENT, one, flags=re.M) for one in programs(folder)))
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    requests = [frame for frame in item.frames.frames if frame.request]
    ids = [f"{frame.id:08X}" if frame.extended else f"{frame.id:03X}" for frame in requests]
    assert lines[0].strip() in {
        f"{id_} {f.data.hex(' ').upper()}".strip() for id_, f in zip(ids, requests, strict=True)
    }
    assert "_raw=" not in done.stdout and "no reply" not in done.stdout
    _, reply, value, _, values, raw, _, *cycles, of_async, made, _ = lines
    assert values.startswith("{'") and raw.startswith("{'")
    assert cycles == [value] * 3 and of_async == reply and made.startswith(f"{x.request}(")


def test_a_silent_node_ends_the_control_loop(tmp_path: Path) -> None:
    folder = write(tmp_path, SPEC)
    done = run(folder, VIRTUAL, *programs(folder))
    assert done.returncode == 1 and done.stdout.count("no reply to SetPowerRequest(node=1, power=200)") == 3
    assert done.stderr.endswith("TimeoutError: no reply to SetPowerRequest(node=1, power=200)\n")


def test_programs_are_typed(tmp_path: Path) -> None:
    folder = write(tmp_path, SPEC)
    (folder / "use.py").write_text("".join(programs(folder)), "utf-8")
    mypy = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "use.py"]
    done = subprocess.run(mypy, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
