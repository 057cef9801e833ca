"""Shared by the tests of commands on a bus: nodes in this process, and in another one over UDP multicast."""

from __future__ import annotations

import functools
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import can
from canwright.conformance import modules

from ..spec_texts import ROOT

NEW, OLD = "v2.36-2025-03", "v2.35"
"""An edition with an id of its own for replies, and one whose replies have the ids of the requests."""
NAMES = ("v2_36_2025_03", "v2_35", "nodes", "simulation", "client")
MG = ("--set", "series=MG", "--set", "encoder_bits=14")


@functools.cache
def package() -> dict[str, ModuleType]:
    """The committed package."""
    loaded = modules.load(ROOT / "generated/python", *(f"mwd_motor.{name}" for name in NAMES))
    return dict(zip(NAMES, loaded, strict=True))


@contextmanager
def answering(edition: str, channel: str, **options: Any) -> Iterator[Any]:
    """The simulated nodes 1 and 2 of the package on a virtual bus."""
    module = package()[edition]
    known = module.Parameters(series=module.Series.MG, encoder_bits=14)
    nodes = [package()["nodes"].Node(module, number, known) for number in (1, 2)]
    simulation = package()["simulation"].Simulation
    with can.Bus(channel, interface="virtual") as bus, simulation(bus, nodes, **options) as ours:
        yield ours


@dataclass
class Ended:
    """What became of a process."""

    status: int | None = None
    stdout: str = ""


def free_port() -> tuple[str, ...]:
    """The options of a port for a bus between processes that no other test uses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("", 0))
        return "--bus-kwargs", f"port={free.getsockname()[1]}"


@contextmanager
def simulated(*arguments: str) -> Iterator[Ended]:
    """`canwright simulate` in another process, which an interrupt ends at the end of the block."""
    command = (sys.executable, "-m", "canwright", "simulate", *arguments)
    ended = Ended()
    pipe = subprocess.PIPE
    with subprocess.Popen(command, text=True, cwd=ROOT, stdout=pipe, stderr=pipe) as process:
        assert process.stderr
        try:
            assert "Ctrl-C ends" in process.stderr.readline()
            yield ended
        finally:
            process.send_signal(signal.SIGINT)
            ended.stdout, _ = process.communicate()
            ended.status = process.returncode
