"""A bus as the source of `decode` and `identify`."""

from __future__ import annotations

import _thread
import itertools
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator

import can
import pytest
from can.interfaces.virtual import channels
from canwright.cli import main
from click.testing import CliRunner, Result

from ..spec_texts import ROOT
from .live import free_port

WAIT = 20
"""The longest time in seconds to wait for the command."""
EXCHANGES = ("9A00000000000000", "9A32081364000000"), ("9C00000000000000", "9C320100F4011027")
"""Requests and replies of node 1 of v2.35-2024-02: 48.72 V, and 500 deg/s."""


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, [*arguments])


def frames() -> Iterator[can.Message]:
    """At steps of 0.5 ms."""
    for number, data in enumerate(itertools.chain(*EXCHANGES)):
        at = 1.0 + number * 0.0005
        yield can.Message(timestamp=at, arbitration_id=0x141, data=bytes.fromhex(data), is_extended_id=False)
    yield can.Message(timestamp=1.1, is_error_frame=True)


def wait_until(is_met: Callable[[], bool]) -> None:
    for _ in range(100 * WAIT):
        if is_met():
            return
        time.sleep(0.01)


def listened(channel: str, *arguments: str) -> Result:
    """Runs a command on a virtual bus on which a host and a node exchange frames, and ends it with an interrupt."""

    def exchange() -> None:
        with can.Bus(channel, interface="virtual", preserve_timestamps=True) as bus:
            wait_until(lambda: len(channels[channel]) > 1)
            for frame in frames():
                bus.send(frame)
            wait_until(lambda: all(queue.empty() for queue in channels[channel]))
            time.sleep(0.5)
        _thread.interrupt_main()

    thread = threading.Thread(target=exchange, daemon=True)
    thread.start()
    result = run(*arguments, "-i", "virtual", "-c", channel)
    thread.join()
    return result


def test_frames_of_a_bus_are_decoded_until_an_interrupt() -> None:
    result = listened("decoded", "decode", "--set", "edition=v2.35-2024-02", "--set", "series=MG")
    assert result.exit_code == 130, result.output
    lines = result.stdout.splitlines()
    assert "voltage 48.72 V" in lines[2] and "answers #0 after 0.500 ms" in lines[2]
    assert "speed 500 °/s" in lines[4] and "answers #2 after 0.500 ms" in lines[4]
    assert "error frame" in result.stdout


def test_rows_are_printed_while_the_bus_is_open() -> None:
    """In another process; the request is sent until it listens."""
    port = free_port()
    command = (sys.executable, "-m", "canwright", "decode", "--set", "edition=v2.35-2024-02", "-i", "udp_multicast")
    pipe = subprocess.PIPE
    request = next(frames())
    with subprocess.Popen([*command, *port], stdout=pipe, text=True, cwd=ROOT) as process:
        ended = threading.Event()

        def send() -> None:
            with can.Bus(interface="udp_multicast", port=int(port[1].partition("=")[2])) as bus:
                while not ended.wait(0.1):
                    bus.send(request)

        thread = threading.Thread(target=send, daemon=True)
        thread.start()
        assert process.stdout
        head, row = process.stdout.readline(), process.stdout.readline()
        ended.set()
        thread.join()
        process.send_signal(signal.SIGINT)
        summary, _ = process.communicate()
    assert head.split()[:2] == ["number", "time"]
    assert row.split()[0] == "#0" and "read_status_1" in row
    assert (process.returncode, "node 1, v2.35-2024-02: 1 request, 0 replies" in summary) == (130, True), summary


def test_the_edition_of_a_bus_is_identified() -> None:
    result = listened("identified", "identify")
    assert result.exit_code == 130
    assert "skipped: error frames (1)" in result.stdout
    assert "mwd_motor, node 1, 4 frames: fits v2.35-2024-02\n" in result.stdout


def test_a_lost_bus_ends_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise can.CanOperationError("adapter unplugged")

    monkeypatch.setattr("can.interfaces.virtual.VirtualBus._recv_internal", fail)
    for command in ("decode", "identify"):
        result = run(command, "-i", "virtual", "-c", "lost")
        says = "canwright: the bus does not work any more: adapter unplugged\n"
        assert (result.exit_code, result.stderr) == (2, says)


@pytest.mark.parametrize("command", ["decode", "identify"])
def test_a_log_and_a_bus_exclude_each_other(command: str) -> None:
    for arguments in ((), ("-", "-i", "virtual")):
        result = run(command, *arguments)
        assert (result.exit_code, "give either LOG or a bus, such as -i socketcan" in result.stderr) == (2, True)
    result = run(command, "--time-differences", "-i", "virtual")
    assert (result.exit_code, "are for logs, not for a bus" in result.stderr) == (2, True)
