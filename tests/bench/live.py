"""Cost of the client of the generated Python package, and its proof over hours of bus time: `python -m tests.bench.live`.

The cost is the processor time of the host's process over UDP multicast, with the nodes in another process, in relation to plain
`send` and `recv` of python-can without any check. A node replies after the time of two frames, as on a bus: without it, it is chance
whether the host waits for a reply, and waiting costs as much as the rest.

Client and plain python-can run in many short turns, one after the other, so that other work of the computer affects both turns of
a pair alike. A figure is the median of the ratios of all pairs: a few disturbed turns do not change it. A ratio of sums includes every
disturbance, and one of minima compares the luckiest turns of each side.

`--hours 10` runs the client against nodes in virtual time instead, at several shares of lost and late frames, and counts
replies that were given to the wrong request.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from importlib import import_module
from types import ModuleType
from typing import Any

import can

from ..spec_texts import ROOT
from ..targets.live_bus import Clock, VirtualTimeBus
from .bars import Measure, report

NODES = range(1, 9)
ROUNDS = 5
TURNS = 150
REPLY_TIME = 0.00025
"""Seconds that two frames last on a bus of 1 Mbit/s."""
CHANNEL = "239.74.163.2"
FAULTS = (0.0, 0.01, 0.1, 0.3)


def _package(name: str) -> ModuleType:
    sys.path.insert(0, str(ROOT / "generated/python"))
    return import_module(f"mwd_motor.{name}")


def _answer(asked: can.Message) -> list[can.Message]:
    """Status 1 with 48 V; a motion with the low byte of its argument as the speed."""
    code, node = asked.data[0], asked.arbitration_id - 0x140
    if not 1 <= node <= 32:
        return []
    data = (
        bytes.fromhex("9A 14 C0 12 00 00 00 00") if code == 0x9A else bytes([code, 50, 1, 0, asked.data[4], 0, 0, 32])
    )
    return [can.Message(arbitration_id=0x180 + node, data=data, is_extended_id=False)]


def _serve() -> None:
    with can.Bus(CHANNEL, interface="udp_multicast") as bus:
        print("ready", flush=True)
        while True:
            asked = bus.recv()
            for reply in _answer(asked) if asked is not None and asked.arbitration_id < 0x180 else ():
                time.sleep(REPLY_TIME)
                bus.send(reply)


class _Cost:
    """The exchanges to compare: with all nodes, each at once or one after the other."""

    def __init__(self, bus: can.BusABC) -> None:
        self.bus = bus
        self.edition, nodes = _package("v2_36_2025_03"), _package("nodes")
        known = self.edition.Parameters(series=self.edition.Series.MG, encoder_bits=16)
        self.nodes = [nodes.Node(self.edition, number, known) for number in NODES]
        self.requests = [self.edition.SetTorqueRequest(node=n, iq=1, parameters=known) for n in NODES]
        self.frames = [_package("python_can").to_message(request) for request in self.requests]
        self.client = _package("client").Client(bus, self.nodes, allow="motion", on_exit="nothing", timeout=10)

    def _reply(self) -> None:
        while True:
            frame = self.bus.recv(1)
            if frame is None or frame.arbitration_id > 0x180:
                return

    def plain_single(self) -> None:
        for frame in self.frames:
            self.bus.send(frame)
            self._reply()

    def plain_cycle(self) -> None:
        for frame in self.frames:
            self.bus.send(frame)
        for _ in self.frames:
            self._reply()

    def single(self) -> None:
        for request in self.requests:
            self.client.request(request)

    def cycle(self) -> None:
        for outcome in self.client.cycle(self.requests):
            outcome.get()


async def _seconds(work: Callable[[], Awaitable[None] | None]) -> float:
    """Processor time of some rounds."""
    start = time.process_time()
    for _ in range(ROUNDS):
        if (waiting := work()) is not None:
            await waiting
    return time.process_time() - start


async def _ratios(bus: can.BusABC) -> list[float]:
    """The cost of a single request, of a cycle, and of a single request with asyncio, each in relation to plain python-can."""
    cost, module = _Cost(bus), _package("client_asyncio")
    async with module.AsyncClient(bus, cost.nodes, allow="motion", on_exit="nothing", timeout=10) as client:

        async def single() -> None:
            for request in cost.requests:
                await client.request(request)

        pairs = (cost.single, cost.plain_single), (cost.cycle, cost.plain_cycle), (single, cost.plain_single)
        turns = [[await _seconds(ours) / await _seconds(plain) for ours, plain in pairs] for _ in range(TURNS)]
    return [statistics.median(ratios) for ratios in zip(*turns, strict=True)]


def costs() -> list[Measure]:
    """The ratios over UDP multicast, with the nodes in another process."""
    command = [sys.executable, "-m", "tests.bench.live", "--serve"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None and server.stdout.readline() == "ready\n"
        try:
            with can.Bus(CHANNEL, interface="udp_multicast") as bus:
                ratios = asyncio.run(_ratios(bus))
        finally:
            server.kill()
    names = (("single request", 1.8), ("cycle of 8", 1.5), ("single request with asyncio", 2.2))
    return [Measure(name, ratio, bar) for ratio, (name, bar) in zip(ratios, names, strict=True)]


def proof(hours: float, share: float, seed: int = 1) -> tuple[int, int, int, int]:
    """Requests, replies, wrong ones, and the growth of memory in KiB, over some hours of bus time at a share of faults."""
    edition, nodes, client_module, clock = *map(_package, ("v2_36_2025_03", "nodes", "client")), Clock()
    client_module.__dict__["time"] = clock
    bus = VirtualTimeBus(clock, _answer, loss=share / 2, late=share, twice=share / 10, seed=seed)
    known = edition.Parameters(series=edition.Series.MG, encoder_bits=16)
    requests = answered = wrong = memory = 0
    choose, end = random.Random(seed).random, clock.now + hours * 3600
    options: dict[str, Any] = {"allow": "motion", "on_exit": "nothing", "bit_rate": 1_000_000, "timeout": 0.01}
    with client_module.Client(bus, [nodes.Node(edition, 1, known)], **options) as client:
        while clock.now < end:
            is_motion, raw = choose() < 0.9, requests % 251
            request: Any = edition.ReadStatus1Request(node=1)
            if is_motion:
                request = edition.SetTorqueRequest.from_raw(node=1, iq=raw, parameters=known)
            outcome = client.cycle([request])[0]
            assert (outcome.reply is None) != (outcome.error is None), "a request has one outcome"
            requests += 1
            if outcome.reply is not None:
                answered += 1
                wrong += outcome.reply.speed_raw != raw if is_motion else outcome.reply.voltage != 48
            clock.sleep(0.01)
            bus.sent.clear()
            if requests == 10_000:
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return requests, answered, wrong, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--hours", type=float, help="hours of bus time, instead of the cost")
    given = parser.parse_args()
    if given.serve:
        _serve()
    if given.hours is None:
        return report(costs())
    print("faults   requests   replies   wrong   KiB more")
    for share in FAULTS:
        requests, answered, wrong, memory = proof(given.hours, share)
        print(f"{share:6.0%} {requests:10} {answered:9} {wrong:7} {memory:10}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
