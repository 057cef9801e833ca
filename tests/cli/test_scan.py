"""`canwright scan`: finds nodes, identifies their editions, and sends nothing that has an effect."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import can
import pytest
from can.interfaces.virtual import VirtualBus
from canwright.cli import main
from canwright.conformance import modules
from click.testing import CliRunner, Result

from ..spec_texts import ROOT, SPECS
from .live import NEW, free_port, simulated

EDITIONS = {"v2_35": "v2.35", "v2_35_2024_02": "v2.35-2024-02", "v2_36_2025_03": NEW}
READS = {0x30, 0x33, 0x40, 0x90, 0x92, 0x94, 0x9A, 0x9C, 0x9D, 0xB0, 0xC0}
"""The first bytes of the commands that the manuals call reading: parameters, encoder, angles and states."""
SLOW = ("--timeout", "0.5")

LAMPS = """
canwright: 1
family: lamp
edition: EDITION
title: Lamps
addresses:
  lamp: {request: 0x100 + node, reply: 0x200 + node, nodes: 1..4}
selector: {at: 0, raw: u8}
effects:
  flashes: {title: The lamp flashes, level: warning}
commands:
"""
READ = "  read_NAME: {code: CODE, reply: {NAME: {at: 1, raw: u8}}}\n"
FLASH = "  flash: {code: CODE, effects: [flashes], reply: {lamps: {at: 1, raw: u8}}}\n"


@pytest.fixture(scope="module")
def package() -> dict[str, ModuleType]:
    """The committed package."""
    names = (*EDITIONS, "nodes", "simulation")
    return dict(
        zip(names, modules.load(ROOT / "generated/python", *(f"mwd_motor.{name}" for name in names)), strict=True)
    )


@contextmanager
def answering(package: dict[str, ModuleType], channel: str, editions: dict[int, str]) -> Iterator[None]:
    """A simulated node of each edition on a virtual bus."""
    with ExitStack() as stack:
        for number, edition in editions.items():
            module = package[edition]
            node = package["nodes"].Node(module, number, module.Parameters(series=module.Series.MG, encoder_bits=14))
            bus = stack.enter_context(can.Bus(channel, interface="virtual"))
            values: dict[str, Any] = {"voltage": 48, "temperature": 25, "encoder": 90}
            stack.enter_context(package["simulation"].Simulation(bus, [node], **values))
        yield


def run(channel: str, *arguments: str) -> Result:
    return CliRunner().invoke(main, ["scan", *arguments, "-i", "virtual", "-c", channel])


def test_frames_of_other_programs_on_this_computer_are_no_own_frames(
    package: dict[str, ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    """SocketCAN marks them as it marks own frames; the scan and the simulated node have to use them."""
    receive = VirtualBus._recv_internal

    def marked(bus: VirtualBus, timeout: float | None) -> tuple[can.Message | None, bool]:
        message, is_filtered = receive(bus, timeout)
        if message is not None:
            message.is_rx = False
        return message, is_filtered

    monkeypatch.setattr(VirtualBus, "_recv_internal", marked)
    with answering(package, "local", {3: "v2_35"}):
        result = run("local", "--node", "3", *SLOW)
    assert "mwd_motor, node 3, " in result.stdout and ": fits v2.35\n" in result.stdout, result.output


@pytest.mark.parametrize("edition", EDITIONS)
def test_nodes_are_found_and_their_editions_identified(edition: str, package: dict[str, ModuleType]) -> None:
    with answering(package, edition, {3: edition}), can.Bus(edition, interface="virtual") as listener:
        result = run(edition, "--node", "1..4", *SLOW)
        first, *_ = result.stdout.splitlines()
        assert result.exit_code == 0, result.output
        assert (first.startswith("mwd_motor, node 3, "), first.endswith(f": fits {EDITIONS[edition]}")) == (True, True)
        sent = []
        while (frame := listener.recv(0)) is not None:
            if frame.arbitration_id in range(0x141, 0x145):
                sent.append(frame)
        assert {frame.data[0] for frame in sent} <= READS
        assert {frame.arbitration_id for frame in sent} == {0x141, 0x142, 0x143, 0x144}
        assert len([frame for frame in sent if frame.arbitration_id != 0x143]) == 3  # one for a node that is absent


def test_no_answer_is_a_finding() -> None:
    result = run("empty", "--node", "1..3", "--timeout", "0.01")
    assert (result.exit_code, result.output) == (1, "no answer of nodes 1..3\n")


def test_a_frame_that_another_edition_has_with_an_effect_is_not_sent(tmp_path: Path) -> None:
    """0x10 flashes the lamps of v2, 0x11 is a read of v1 alone, and 0x12 is one of both."""
    read_level, read_hours = (READ.replace("NAME", name) for name in ("level", "hours"))
    reads = read_level.replace("CODE", "0x10") + read_hours.replace("CODE", "0x11")
    common = READ.replace("NAME", "state").replace("CODE", "0x12")
    texts = {"v1": reads, "v2": FLASH.replace("CODE", "0x10")}
    for name, text in texts.items():
        (tmp_path / f"{name}.yaml").write_text(LAMPS.replace("EDITION", name) + text + common, "utf-8")
    with can.Bus("lamps", interface="virtual") as node:
        answers = can.Notifier(node, [lambda frame: node.send(_lamp_reply(frame))])
        result = run("lamps", "--spec", str(tmp_path), "--node", "2", *SLOW)
        answers.stop()
    assert "node 2, 4 frames" in result.stdout, result.output
    with can.Bus("lamps2", interface="virtual") as listener:
        run("lamps2", "--spec", str(tmp_path), "--node", "1..2", "--timeout", "0.01")
        sent = [listener.recv(0), listener.recv(0), listener.recv(0)]
    assert [frame and (frame.arbitration_id, frame.data[0]) for frame in sent] == [(0x101, 0x12), (0x102, 0x12), None]


def _lamp_reply(frame: can.Message) -> can.Message:
    assert frame.data[0] in (0x11, 0x12)
    data = bytes([frame.data[0], 1, *[0] * 6])
    return can.Message(arbitration_id=frame.arbitration_id + 0x100, data=data, is_extended_id=False)


def test_error_frames_are_counted_with_their_causes() -> None:
    with can.Bus("noisy", interface="virtual") as bus:
        answers = can.Notifier(bus, [lambda frame: bus.send(can.Message(is_error_frame=True))])
        result = run("noisy", "--node", "1", *SLOW)
        answers.stop()
    assert result.stderr == "1 error frame: check the bit rate, termination and wiring\n"


def test_a_lost_bus_ends_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise can.CanOperationError("Transmit buffer full")

    monkeypatch.setattr("can.interfaces.virtual.VirtualBus.send", fail)
    result = run("lost", "--node", "1")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == (
        "canwright: the bus does not work any more: Transmit buffer full; "
        "if nothing acknowledges frames, check power, wiring and bit rate\n"
    )


def test_wrong_arguments_end_with_a_sentence() -> None:
    chassis = str(next(spec for spec in SPECS if spec.parent.name == "chassis"))
    for arguments, says in (
        (("--node", "0"), "--node 0: mwd_motor v2.35 has no node 0"),
        (("--spec", chassis, "--node", "1"), "no command is known to be a harmless read"),
        (("--edition", "v2.53"), "there is no edition `v2.53`"),
    ):
        result = run("wrong", *arguments)
        assert (result.exit_code, says in result.stderr) == (2, True), result.output


@pytest.mark.parametrize("is_known", [True, False])
def test_frames_that_come_back_are_no_replies(is_known: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bus of UDP returns own frames, which is learned where it is not known."""
    if not is_known:
        monkeypatch.setattr("canwright.cli.scan.returns_own_frames", lambda _: False)
    bus = ("-i", "udp_multicast", *free_port())
    with simulated("v2.35", "--node", "2", "--set", "series=MG", "--set", "encoder_bits=14", *bus):
        result = CliRunner().invoke(main, ["scan", "--node", "1..3", *SLOW, *bus])
    assert result.stdout.startswith("mwd_motor, node 2, 16 frames: "), result.output
