"""`canwright simulate`: what its nodes answer, what it counts, and how it ends."""

from __future__ import annotations

import _thread
import runpy
import threading
import time
from collections.abc import Callable
from pathlib import Path

import can
import pytest
from can.interfaces.virtual import channels
from canwright.cli import main
from click.testing import CliRunner, Result

from ..spec_texts import ROOT
from .live import MG, NEW, package

READ_STATUS_1 = can.Message(arbitration_id=0x141, data=bytes([0x9A, *[0] * 7]), is_extended_id=False)
FOREIGN = can.Message(arbitration_id=0x7FF, data=b"\x01", is_extended_id=False)
WAIT = 20
"""The longest time in seconds that a test waits for a reply."""


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["simulate", *arguments])


def run_beside(host: Callable[[can.BusABC], None], channel: str, *arguments: str) -> Result:
    """Runs the command on a virtual bus, and ends it with an interrupt when the host in a thread has ended."""
    failed: list[BaseException] = []

    def use_bus() -> None:
        try:
            with can.Bus(channel, interface="virtual") as bus:
                _wait_for_node(channel)
                host(bus)
        except BaseException as error:
            failed.append(error)
        _thread.interrupt_main()

    thread = threading.Thread(target=use_bus, daemon=True)
    thread.start()
    result = run(*arguments, "-i", "virtual", "-c", channel)
    thread.join()
    assert not failed, failed
    return result


def _wait_for_node(name: str) -> None:
    """Until the simulation has opened its bus."""
    for _ in range(WAIT * 100):
        if len(channels[name]) > 1:
            return
        time.sleep(0.01)
    raise AssertionError("the simulation did not start")


def test_nodes_answer_until_an_interrupt_and_frames_are_counted() -> None:
    replies: list[can.Message | None] = []

    def host(bus: can.BusABC) -> None:
        bus.send(READ_STATUS_1)
        replies.append(bus.recv(WAIT))
        bus.send(FOREIGN)
        bus.send(READ_STATUS_1)
        replies.append(bus.recv(WAIT))

    result = run_beside(
        host, "counted", "v2.36-2025-03", "temperature=-3", "errors=low_voltage,over_current", "--node", "1..4"
    )
    first, second = replies
    assert first and second
    assert (first.arbitration_id, first.data.hex()) == (0x181, "9afd580200000011")  # 6 V, the least that is plausible
    assert second.data == first.data
    assert (result.exit_code, result.stderr) == (130, "mwd_motor v2.36-2025-03, nodes 1..4; Ctrl-C ends\n")
    assert result.stdout == "3 frames received, 2 sent, 1 of no request to these nodes\n"


def test_nodes_turn_as_the_class_of_the_readme(tmp_path: Path) -> None:
    """It uses the package of the nodes, although none is installed."""
    python, _, _ = (
        (ROOT / "README.md")
        .read_text("utf-8")
        .partition("<!-- example: python -->\n```python\n")[2]
        .partition("\nnode =")
    )
    (tmp_path / "motor.py").write_text(python.replace("v2_35", "v2_36_2025_03"))
    module, angles = package()["v2_36_2025_03"], []
    known = module.Parameters(series=module.Series.MG, encoder_bits=14)

    def host(bus: can.BusABC) -> None:
        moves = module.MoveToAngleAtSpeedRequest(node=1, angle=90, max_speed=10)
        for request in (moves, *[module.ReadMultiTurnAngleRequest(node=1)] * 2):
            time.sleep(0.1)
            bus.send(can.Message(arbitration_id=request.can_id, data=request.encode(), is_extended_id=False))
            reply = bus.recv(WAIT)
            assert reply
            decoded = module.decode_reply(reply.arbitration_id, bytes(reply.data), known)
            angles.append(getattr(decoded, "angle", 0.0))

    result = run_beside(host, "turning", NEW, "--node", "1", *MG, "--behaviour", str(tmp_path / "motor.py:Motor"))
    assert result.exit_code == 130, result.output
    assert 0 < angles[1] < angles[2] <= 91, angles


@pytest.mark.parametrize("error", ["ValueError", "KeyError"])
def test_an_error_of_a_behaviour_names_its_line(error: str, tmp_path: Path) -> None:
    """Also one that a bus raises when it is lost."""
    file = tmp_path / "broken.py"
    file.write_text(f"class Broken:\n    def step(self, node, seconds):\n        raise {error}('no angle')\n")
    arguments = ("--behaviour", f"{file}:Broken", "-i", "virtual", "-c", "broken")
    result = run(NEW, "--node", "1", *arguments)
    assert (result.exit_code, f"canwright: --behaviour {file}:3: {error}: " in result.stderr) == (2, True), (
        result.stderr
    )


def test_faults_are_given_as_shares() -> None:
    def host(bus: can.BusABC) -> None:
        for _ in range(3):
            bus.send(READ_STATUS_1)
            assert bus.recv(0.2) is None

    lossy = run_beside(host, "lossy", "v2.36-2025-03", "--node", "1", "--loss", "100%")
    assert lossy.stdout.startswith("3 frames received, 0 sent")

    def impatient(bus: can.BusABC) -> None:
        bus.send(READ_STATUS_1)
        assert [bus.recv(WAIT) is not None for _ in range(2)] == [True, True]

    twice = run_beside(impatient, "twice", "v2.36-2025-03", "--node", "1", "--twice", "1", "--delay", "0.01")
    assert twice.stdout.startswith("1 frame received, 2 sent")


def test_a_node_that_lacks_a_parameter_warns_once_in_a_line() -> None:
    set_torque = can.Message(arbitration_id=0x141, data=bytes([0xA1, *[0] * 7]), is_extended_id=False)

    def host(bus: can.BusABC) -> None:
        for _ in range(2):
            bus.send(set_torque)
            assert bus.recv(0.2) is None

    lines = run_beside(host, "unknown", "v2.35", "--node", "1").stderr.splitlines()
    assert len(lines) == 2
    assert lines[1].startswith("canwright: Node(v2.35, 1) does not answer SetTorqueRequest(node=1, iq")
    assert lines[1].endswith(
        "SetTorqueReply depends on series, which is not given; pass Parameters(series=...); here, give --set PARAMETER=VALUE"
    )


def test_a_lost_bus_ends_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise can.CanOperationError("adapter\n  unplugged.")

    monkeypatch.setattr("can.interfaces.virtual.VirtualBus._recv_internal", fail)
    result = run("v2.35", "--node", "1", "-i", "virtual", "-c", "lost")
    assert result.exit_code == 2
    assert result.stderr.splitlines()[1:] == ["canwright: the bus does not work any more: adapter unplugged"]
    assert result.stdout.startswith("0 frames received")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--node", "1"), "write the one to simulate: canwright simulate EDITION"),
        (("v2.53", "--node", "1"), "there is no edition `v2.53`; did you mean `v2.35`?"),
        (("v2.35", "v2.36", "--node", "1"), "`v2.36` is not a value; write NAME=VALUE"),
        (("v2.35", "voltag=48", "--node", "1"), "no reply contains `voltag`; did you mean `voltage`?"),
        (("v2.35", "voltage=high", "--node", "1"), "voltage=high: `high` is not a number"),
        (
            ("v2.35", "iq=2.5", "--node", "1"),
            "iq=2.5: `iq` depends on `series`, which is missing; give --set series=MF|MG|MH|MS",
        ),
        (("v2.35", "--node", "0..4"), "--node 0..4: mwd_motor v2.35 has no node 0; its nodes are 1..32"),
        (("v2.35", "--node", "first"), "--node first: `first` is not a node; write nodes as 5,7 or 1..8"),
        (("v2.35", "--node", "1", "--loss", "101%"), "`101%` is not a share from 0 to 1; write it as 1% or 0.01"),
        (("v2.35", "--node", "1", "--loss", "often"), "`often` is not a share from 0 to 1"),
        (("v2.35", "--node", "1", "--set", "series=MX"), "--set series=MX is not a parameter and its value"),
        (
            ("v2.35", "--node", "1", "--behaviour", f"{runpy.__file__}:Mot"),
            "there is no class `Mot` in the file; ",
        ),
        (("v2.35", "--node", "1", "--behaviour", "absent.py:Motor"), "FileNotFoundError: [Errno 2] No such file"),
        (("v2.35", "--node", "1", "--bus-kwargs", "port"), "--bus-kwargs port: write NAME=VALUE"),
        (("v2.35", "--node", "1"), "give -i socketcan -c can0 -b 1000000, or write can.conf"),
        (("v2.35", "--node", "1", "-i", "virtul"), 'Unknown interface type "virtul"; did you mean `virtual`?'),
        (("v2.35", "--node", "1", "-i", "socketcan", "-c", "absent9"), "the bus cannot be opened: "),
    ],
)
def test_wrong_arguments_end_with_a_sentence(
    arguments: tuple[str, ...], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    result = run(*arguments)
    assert (result.exit_code, says in result.stderr) == (2, True), result.output


def test_the_bus_can_be_in_the_configuration_file_of_python_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "can.conf").write_text("[default]\ninterface = virtual\nchannel = absent\n")
    opened: list[str] = []

    class Bus:
        def __init__(self, **arguments: object) -> None:
            opened.append(str(can.util.load_config(config=arguments)))
            raise can.CanInitializationError("no device")

    monkeypatch.setattr(can, "Bus", Bus)
    result = run("v2.35", "--node", "1", "-b", "500000")
    assert (result.exit_code, result.stderr) == (2, "canwright: the bus cannot be opened: no device\n")
    assert "'interface': 'virtual'" in opened[0] and "'channel': 'absent'" in opened[0] and "500000" in opened[0]
