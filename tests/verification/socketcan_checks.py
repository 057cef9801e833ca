"""Checks of canwright on SocketCAN, on the buses `vcan0` and `vcan1`; `socketcan` runs them in its machine.

An emulated machine is slow: time-outs are long.
"""

from __future__ import annotations

import functools
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any

import can
from canwright.__main__ import run
from canwright.cli import decode, identify, monitor_feed, python_package, request, scan, simulate  # noqa: F401
from mwd_motor import client as clients, nodes, v2_35, v2_36_2025_03

BUSES = {"vcan0": ("v2.36-2025-03", v2_36_2025_03), "vcan1": ("v2.35", v2_35)}
"""An edition with an id of its own for replies, and one whose replies have the ids of the requests."""
MG = ("--set", "series=MG", "--set", "encoder_bits=14")
VALUES = ("voltage=48", "temperature=25", "encoder=90", "multi_turn_angle=90", "single_turn_angle=90")
"""With zeros, many replies of the old edition equal their requests, and `identify` cannot find them."""
WAIT = ("--timeout", "2")
LOST = "canwright: the bus does not work"
LIMIT = 300
"""The seconds for each command, or for what it prints."""
FORKING = multiprocessing.get_context("fork")
"""Commands begin with the modules that are imported here: to import them takes ten seconds each time."""
RECEIVERS = Path("/proc/net/can/rcvlist_all")


class Program:
    """A command that runs on a bus."""

    def __init__(self, channel: str, output: IO[str], *arguments: str) -> None:
        self.name = arguments[0]
        self._output = output
        words = ["canwright", *arguments, "-i", "socketcan", "-c", channel]
        self._process = FORKING.Process(target=_execute, args=(output, words))
        self._process.start()

    def wait_for(self, text: str) -> None:
        """Waits until a text is printed. Raises AssertionError."""
        self.wait_until(lambda: text in self.text())

    def wait_until(self, is_reached: Callable[[], bool]) -> None:
        """Waits for a condition. Raises AssertionError if the command ends first, or is too slow."""
        until = time.monotonic() + LIMIT
        while not is_reached():
            assert self._process.is_alive() and time.monotonic() < until, f"{self.name}: {self.text()}"
            time.sleep(0.1)

    def text(self) -> str:
        """What was printed so far."""
        self._output.seek(0)
        return self._output.read()

    def ended(self) -> tuple[int | None, str]:
        """The exit status, and what was printed."""
        self._process.join(LIMIT)
        return self._process.exitcode, self.text()

    def interrupted(self) -> tuple[int | None, str]:
        """The same after Ctrl-C."""
        os.kill(self._process.pid or 0, signal.SIGINT)
        return self.ended()

    def kill(self) -> None:
        """Ends it at once, if it runs."""
        self._process.kill()
        self._process.join()


def _execute(output: IO[str], words: Sequence[str]) -> None:
    for stream in (1, 2):
        os.dup2(output.fileno(), stream)
    sys.argv = [*words]
    run()


def _has_more_receivers(channel: str, before: int) -> bool:
    return _receivers(channel) > before


def _receivers(channel: str) -> int:
    """How many sockets receive all frames of a bus."""
    return sum(line.split()[:1] == [channel] for line in RECEIVERS.read_text().splitlines())


@contextmanager
def _listening(channel: str, *commands: Sequence[str]) -> Iterator[list[Program]]:
    """Commands that listen on a bus until they are ended."""
    with ExitStack() as stack:
        programs: list[Program] = []
        for command in commands:
            listening = _receivers(channel)
            programs.append(Program(channel, stack.enter_context(TemporaryFile("w+")), *command))
            stack.callback(programs[-1].kill)
            programs[-1].wait_until(functools.partial(_has_more_receivers, channel, listening))
        yield programs


def _simulate(channel: str) -> Sequence[str]:
    return "simulate", BUSES[channel][0], *VALUES, "--node", "1..2", *MG


@contextmanager
def _client(channel: str, **options: Any) -> Iterator[Any]:
    module = BUSES[channel][1]
    known = module.Parameters(series=module.Series.MG, encoder_bits=14)
    motors = [nodes.Node(module, number, known) for number in (1, 2)]
    with can.Bus(channel, interface="socketcan", **options) as bus, clients.Client(bus, motors, timeout=5) as client:
        yield client


def _run(channel: str, *arguments: str) -> tuple[int | None, str]:
    """The exit status of a command, and what it prints."""
    with TemporaryFile("w+") as output:
        program = Program(channel, output, *arguments)
        try:
            return program.ended()
        finally:
            program.kill()


def _expect(result: tuple[int | None, str], status: int, *texts: str) -> None:
    assert result[0] == status and all(text in result[1] for text in texts), f"{status}, {texts} expected: {result}"


def scan_and_request(channel: str) -> str:
    """The nodes are found, read, and moved only with consent."""
    edition = BUSES[channel][0]
    asked = ("--node", "1", "--edition", edition, *MG, *WAIT)
    with _listening(channel, _simulate(channel)) as (simulated,):
        _expect(_run(channel, "scan", "--node", "1..3", *WAIT), 0, "mwd_motor, nodes 1..2, ", f"fits {edition}")
        _expect(_run(channel, "request", "read_status_1", *asked), 0, "48.0 V")
        _expect(_run(channel, "request", "set_torque", "iq=2.5", *asked), 1, "--allow motion")
        _expect(
            _run(channel, "request", "set_torque", "iq=2.5", *asked, "--allow", "motion"),
            0,
            "reply of set_torque from node 1",
        )
        _expect(simulated.interrupted(), 130, " received, ")
    return "nodes 1..2 are found, read, and moved with consent only"


def a_bus_as_source(channel: str) -> str:
    """Three commands listen to the frames of other programs."""
    edition = BUSES[channel][0]
    setting = ("--set", f"edition={edition}", *MG)
    listening = ("identify", *MG), ("decode", *setting), ("monitor", "--plain", *setting)
    with _listening(channel, _simulate(channel), *listening) as (_, identified, decoded, monitored):
        _run(channel, "scan", "--node", "1..2", *WAIT)
        for program in (decoded, monitored):
            program.wait_for("voltage 48.0 V")
            _expect(program.interrupted(), 130, "read_status_1")
        _expect(identified.interrupted(), 130, "nodes 1..2, ", f"fits {edition}")
    return f"{', '.join(name for name, *_ in listening)}"


def own_frames_on(channel: str) -> str:
    """The client, where its bus object returns what it sends."""
    return _asked(channel, is_returned=True)


def own_frames_off(channel: str) -> str:
    """The client, where its bus object does not."""
    return _asked(channel, is_returned=False)


def _asked(channel: str, *, is_returned: bool) -> str:
    module, count = BUSES[channel][1], 200
    reads = [module.ReadStatus1Request(node=number) for number in (1, 2)]
    options = {"receive_own_messages": is_returned}
    with _listening(channel, _simulate(channel)), _client(channel, **options) as client:
        start = time.monotonic()
        voltages = {client.request(reads[0]).voltage for _ in range(count)}
        seconds = time.monotonic() - start
        outcomes = client.cycle(reads)
        assert voltages == {outcome.get().voltage for outcome in outcomes} == {48}, (voltages, outcomes)
        counters = client.counters
    assert counters.unproven == counters.foreign == counters.missing == 0, counters
    return f"{count} of {count} replies after {1000 * seconds / count:.1f} ms each, a cycle of 2 nodes"


def no_loopback(channel: str) -> str:
    """Without loopback in the kernel, no program of this computer receives a frame of the client."""
    module = BUSES[channel][1]
    with _listening(channel, _simulate(channel)) as (simulated,), _client(channel, local_loopback=False) as client:
        error = client.cycle([module.ReadStatus1Request(node=1)])[0].error
        assert isinstance(error, clients.NoReply | clients.NotSent), error
        _expect(simulated.interrupted(), 130, "0 frames received")
    return str(error)


def a_c_program(channel: str) -> str:
    """The generated example of the edition."""
    module = BUSES[channel][1]
    with _listening(channel, _simulate(channel)):
        done = subprocess.run(
            [Path(sys.argv[1]) / module.__name__.rpartition(".")[2], channel],
            capture_output=True,
            text=True,
            check=False,
        )
    _expect((done.returncode, done.stdout + done.stderr), 0, "reply")
    return done.stdout.strip()


def a_lost_bus(channel: str) -> str:
    """The interface goes down: each program ends with a sentence, and works again after the interface is up."""
    edition, module = BUSES[channel]
    setting = ("--set", f"edition={edition}", *MG)
    listening = _simulate(channel), ("decode", *setting), ("identify", *MG), ("monitor", "--plain", *setting)
    ask = ("request", "read_status_1", "--node", "1", "--edition", edition, *MG, *WAIT)
    read = module.ReadStatus1Request(node=1)
    with _listening(channel, *listening) as programs, _client(channel) as client:
        assert client.request(read).voltage == 48
        _set(channel, "down")
        try:
            error = client.cycle([read])[0].error
            assert isinstance(error, clients.BusLost), error
            lost = {program.name: program.ended() for program in programs} | {"request": _run(channel, *ask)}
        finally:
            _set(channel, "up")
        for name, (status, text) in lost.items():
            sentence = next((line for line in text.splitlines() if line.startswith(LOST)), "")

            assert status == 2 and sentence and "Traceback" not in text, (name, status, text)
    return f"client: {error}; {', '.join(lost)}: {sentence}"


def _set(channel: str, state: str) -> None:
    subprocess.run(["ip", "link", "set", channel, state], check=True)


def main() -> int:
    for channel in BUSES:
        subprocess.run(["ip", "link", "add", channel, "type", "vcan"], check=True)
        _set(channel, "up")
    checks = scan_and_request, a_bus_as_source, own_frames_on, own_frames_off, no_loopback, a_c_program, a_lost_bus
    failed = sum(not _passes(check, channel) for check in checks for channel in BUSES)
    return bool(failed)


def _passes(check: Callable[[str], str], channel: str) -> bool:
    """Runs a check, and prints its result."""
    start = time.monotonic()
    try:
        word, text = "ok", check(channel)
    except Exception as error:  # each is a failed check
        word, text = "FAILED", f"{type(error).__name__}: {error}"
    name = check.__name__.replace("_", " ")
    print(f"{word}: {channel}, {name}, {time.monotonic() - start:.0f} s: {text}", flush=True)
    return word == "ok"


if __name__ == "__main__":
    sys.exit(main())
