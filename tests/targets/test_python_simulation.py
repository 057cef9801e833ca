"""The simulated nodes of the generated package: what they answer, store and do not do, alone and with the client."""

from __future__ import annotations

import asyncio
import json
import threading
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import can
import pytest
from canwright.conformance import modules
from canwright.conformance.adapter import CanFrame, write_files
from canwright.conformance.python import PythonAdapter
from canwright.conformance.reference import ReferenceAdapter
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.python.target import PythonTarget

from ..samples import sampled
from ..spec_texts import ROOT, SPECS, called
from .live_bus import Clock

NAMES = ("v2_35", "v2_36_2025_03", "nodes", "client", "simulation")


@pytest.fixture(scope="module")
def package() -> dict[str, ModuleType]:
    """The committed package."""
    return dict(
        zip(NAMES, modules.load(ROOT / "generated/python", *(f"mwd_motor.{name}" for name in NAMES)), strict=True)
    )


@pytest.mark.parametrize("spec", sampled(SPECS, 3), ids=called)
def test_every_golden_request_is_answered(spec: Path, tmp_path: Path) -> None:
    """The reply of a simulated node to each request of the golden frames answers it, by the reference; the number fits."""
    item = specification(spec)
    folder = write_files(PythonTarget().generate([item], {}), tmp_path)
    names = (item.edition.identifier, "nodes", "simulation")
    module, nodes, simulation = modules.load(folder, *(f"{item.edition.family}.{name}" for name in names))
    package, reference = PythonAdapter(item.edition, module), ReferenceAdapter(item.edition)
    asked: Counter[str] = Counter()
    assert item.frames is not None
    for golden in item.frames.frames:
        command = item.edition.command(golden.command)
        if golden.direction is not Direction.REQUEST or golden.decode_only:
            continue
        node = golden.node or (command.from_each[0] if command.from_each else 1)
        known = package.parameters(golden.parameters)
        simulated = simulation.SimulatedNode(nodes.Node(module, node, known))
        sent = can.Message(
            arbitration_id=golden.id,
            data=golden.data,
            is_extended_id=golden.extended,
            is_remote_frame=golden.remote,
            is_fd=item.edition.bus.frame_format.is_fd,
        )
        request = simulated.decode(sent)
        if request is None:  # a shorter frame, or a node that does not have the command
            continue
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            replies = simulated.answer(request)
        if warned:
            assert "not given; pass Parameters" in str(warned[0].message)
            continue
        first = [reply for reply in command.replies if not reply.is_alternative]
        assert len(replies) == sum(reply.frames for reply in first), golden
        for reply in replies:
            frame = CanFrame(reply.can_id, reply.encode(), extended=reply.EXTENDED, remote=reply.REMOTE)
            given = CanFrame(golden.id, golden.data, extended=golden.extended, remote=golden.remote)
            assert reference.answers(given, frame, golden.parameters) is None, (golden, reply)
            asked[golden.command] += 1
    wanted = [c for c in item.edition.commands if c.request and c.replies and c.implemented]
    assert not wanted or asked, item.edition.family


def _nodes(package: dict[str, ModuleType], edition: str) -> tuple[Any, list[Any]]:
    module = package[edition]
    known = module.Parameters(series=module.Series.MG, encoder_bits=14)
    return module, [package["nodes"].Node(module, number, known) for number in (1, 2, 3, 4)]


@pytest.fixture
def buses() -> Iterator[tuple[can.BusABC, can.BusABC]]:
    with can.Bus("simulated", interface="virtual") as host, can.Bus("simulated", interface="virtual") as node:
        yield host, node


Buses = tuple[can.BusABC, can.BusABC]


def test_a_client_moves_reads_and_writes(package: dict[str, ModuleType], buses: Buses) -> None:
    """What is written is read again, in units; a motor that is off answers and does not execute."""
    new, nodes = _nodes(package, "v2_36_2025_03")
    done: list[str] = []

    class Motor(package["simulation"].Behaviour):  # type: ignore[misc]
        def command(self, node: Any, request: Any) -> bool:
            done.append(request.COMMAND)
            if isinstance(request, new.SetTorqueRequest):
                node.values["iq"] = request.iq
            return True

    simulation = package["simulation"].Simulation(buses[1], nodes, Motor, voltage=48, temperature=30)
    with simulation, package["client"].Client(buses[0], nodes, allow="motion", timeout=10) as client:
        status = client.request(new.ReadStatus1Request(node=1))
        assert (status.voltage, status.temperature, status.motor_state) == (48, 30, new.MotorState.ON)
        assert client.request(nodes[0].make(new.SetTorqueRequest, iq=2.5)).iq == pytest.approx(2.5, abs=66 / 4096)
        client.request(new.BrakeRequest(node=1, action=new.BrakeAction.RELEASE))
        state = client.request(new.BrakeRequest(node=1, action=new.BrakeAction.READ)).state
        assert state is new.BrakeState.RELEASED  # reading writes nothing
        written = new.WriteControlParameterRamMaxSpeedRequest(node=2, max_speed=500)
        assert client.request(written).max_speed == 500
        assert client.request(new.ReadControlParameterMaxSpeedRequest(node=2)).max_speed == 500
        assert client.request(new.ReadControlParameterMaxSpeedRequest(node=3)).max_speed == 0
        assert simulation[2].values["control_parameters.max_speed"] == 500
        client.request(new.MotorOffRequest(node=1))
        assert client.request(nodes[0].make(new.SetTorqueRequest, iq=9)).iq == pytest.approx(2.5, abs=66 / 4096)
        client.request(nodes[0].make(new.MoveByAngleRequest, increment=90))  # an increment that is not executed is none
        assert client.request(new.ReadStatus1Request(node=1)).motor_state is new.MotorState.OFF
        assert done.count("set_torque") == 1 and "move_by_angle" not in done
        simulation[1].values["iq"] = 1000  # more than the field can have
        assert client.request(nodes[0].make(new.SetTorqueRequest, iq=0)).raw()["iq"] == 32767
    assert simulation.received == simulation.answered
    assert simulation.rejected == 0


def test_a_broadcast_has_a_reply_of_each_node(package: dict[str, ModuleType], buses: Buses) -> None:
    old, nodes = _nodes(package, "v2_35")
    with (
        package["simulation"].Simulation(buses[1], nodes, voltage=48),
        package["client"].Client(buses[0], nodes, allow="motion", timeout=10) as client,
    ):
        replies = client.gather(old.BroadcastTorqueRequest(iq=(1, 2, 3, 4)))
        assert [reply.node for reply in replies] == [1, 2, 3, 4]


class _Frames:
    """A bus that keeps what is sent."""

    def __init__(self) -> None:
        self.sent: list[can.Message] = []

    def send(self, message: can.Message) -> None:
        self.sent.append(message)


def _asked(package: dict[str, ModuleType], count: int, **faults: Any) -> tuple[Any, list[str]]:
    """What a simulation of node 1 sends after each of some reads of the voltage, 1 ms apart."""
    _, nodes = _nodes(package, "v2_35")
    bus = _Frames()
    wrong = package["simulation"].Faults(**faults)
    simulation = package["simulation"].Simulation(bus, nodes[:1], voltage=48, faults=wrong)
    read = can.Message(arbitration_id=0x141, data=bytes.fromhex("9A00000000000000"), is_extended_id=False)
    for number in range(count):
        simulation.receive(read, number / 1000)
        simulation.flush(number / 1000)
    return simulation, [bytes(message.data).hex() for message in bus.sent]


RIGHT, ASKED = "9a0000e001000000", "9a00000000000000"


def test_faults_have_their_rates(package: dict[str, ModuleType]) -> None:
    """Of 4,000 requests, each fault happens as often as stated, within five standard deviations."""
    count, slack = 4000, 5 * (4000 * 0.1 * 0.9) ** 0.5
    assert _asked(package, count)[1] == [RIGHT] * count
    assert abs(len(_asked(package, count, loss=0.1)[1]) - count * 0.81) < slack
    assert abs(len(_asked(package, count, twice=0.1)[1]) - count * 1.1) < slack
    wrong = [data for data in _asked(package, count, corrupt=0.1)[1] if data != RIGHT]
    assert abs(len(wrong) - count * 0.1) < slack
    assert all((int(data, 16) ^ int(RIGHT, 16)).bit_count() == 1 for data in wrong)
    echoes = _asked(package, count, echo=0.1)[1]
    assert abs(echoes.count(ASKED) - count * 0.1) < slack
    assert echoes.count(RIGHT) == count
    simulation, replies = _asked(package, count, late=0.01, late_by=0.01)
    assert set(replies) == {RIGHT}
    assert count - 12 < len(replies) <= count  # the last ones may still be due
    simulation, replies = _asked(package, count, silence=0.01, silent_for=0.1)
    assert 1000 < len(replies) < 3000  # 100 answers, then 100 requests without one, on average
    simulation, replies = _asked(package, 1, power_loss=1.0)
    assert simulation[1].values["voltage"] == 48
    assert _asked(package, count, loss=0.1, twice=0.1, seed=2) != _asked(package, count, loss=0.1, twice=0.1, seed=3)


def test_power_loss_forgets_what_was_written(package: dict[str, ModuleType]) -> None:
    new, nodes = _nodes(package, "v2_36_2025_03")
    node = package["simulation"].SimulatedNode(nodes[0], voltage=48)
    node.answer(new.WriteControlParameterRamMaxSpeedRequest(node=1, max_speed=500))
    node.answer(new.MotorOffRequest(node=1))
    assert node.state == "off"
    node.power_on()
    assert (node.state, node.values) == ("on", {"voltage": 48, "motor_state": 0})


def test_mistakes_are_named(package: dict[str, ModuleType]) -> None:
    module, nodes = _nodes(package, "v2_35")
    with pytest.raises(ValueError, match=r"loss=2 is no rate from 0 to 1"):
        package["simulation"].Simulation(_Frames(), nodes, faults=package["simulation"].Faults(loss=2))
    request = module.SetPowerRequest(node=1, power=200)  # for motors of another series
    frame = can.Message(arbitration_id=request.can_id, data=request.encode(), is_extended_id=False)
    assert package["simulation"].SimulatedNode(nodes[0]).decode(frame) is None
    blank = package["simulation"].SimulatedNode(package["nodes"].Node(module, 1))
    with pytest.warns(UserWarning, match=r"does not answer ReadStatus2Request\(node=1\): .*series"):
        assert blank.answer(module.ReadStatus2Request(node=1)) == []


def test_a_lost_bus_ends_the_thread(package: dict[str, ModuleType]) -> None:
    _, nodes = _nodes(package, "v2_35")

    asked = threading.Event()

    class Lost(_Frames):
        def recv(self, timeout: float) -> None:
            asked.set()
            raise can.CanOperationError("gone")

    with (
        pytest.raises(can.CanOperationError, match="gone"),
        package["simulation"].Simulation(Lost(), nodes),
    ):
        assert asked.wait(5)


LAMP = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  set: {code: 0x11, request: {target: {at: 2, raw: u16, variable: level}}, reply: none}
  beat: {code: 0x10, request: none, reply: {layout: {level: {at: 2, raw: u16}}, every_ms: 100}}
"""


def _lamp(folder: Path, *names: str) -> list[ModuleType]:
    """Modules of the package of nodes that send cyclic frames."""
    spec = folder / "lamp.yaml"
    spec.write_text(LAMP, "utf-8")
    package = write_files(PythonTarget().generate([specification(spec)], {}), folder)
    return [*modules.load(package, *(f"lamp.{name}" for name in names))]


def test_cyclic_frames_come_at_their_period(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module, nodes, simulation = _lamp(tmp_path, "v1", "nodes", "simulation")
    clock = Clock()
    monkeypatch.setattr(simulation, "time", clock)
    bus = _Frames()
    lamp = simulation.Simulation(bus, [nodes.Node(module, 2)])
    lamp.receive(
        can.Message(arbitration_id=0x102, data=bytes.fromhex("1100340000000000"), is_extended_id=False), clock.now
    )
    for _ in range(1000):
        clock.now += 0.001
        lamp.step(clock.now)
        lamp.flush(clock.now)
    assert {bytes(message.data).hex() for message in bus.sent} == {"1000340000000000"}
    assert len(bus.sent) in (10, 11)


def test_frames_without_a_request_come_one_after_the_other(tmp_path: Path) -> None:
    """Also after the bus was lost, and with asyncio."""
    module, nodes, simulation, client, client_asyncio = _lamp(
        tmp_path, "v1", "nodes", "simulation", "client", "client_asyncio"
    )
    node = nodes.Node(module, 2)

    def lost(*_: object) -> None:
        raise can.CanOperationError("unplugged")

    def bus() -> can.BusABC:
        return can.Bus("lamps", interface="virtual")

    async def listen() -> list[Any]:
        with bus() as first, bus() as second:
            async with client_asyncio.AsyncClient(first, [node]) as listening:
                levels = [message.level async for message in listening.receive(0.25)]
                first.recv = lost  # type: ignore[method-assign, assignment]
                with pytest.raises(client.BusLost, match="unplugged"):
                    await anext(listening.receive(5))
                await listening.reopen(second)
                return [*levels, (await anext(listening.receive(5))).level]

    with bus() as far, simulation.Simulation(far, [node], level=7):
        with bus() as first, bus() as second, client.Client(first, [node]) as listening:
            assert [message.level for message in listening.receive(0.25)] in ([7] * 2, [7] * 3)
            first.recv = lost  # type: ignore[method-assign, assignment]
            with pytest.raises(client.BusLost, match="unplugged"):
                next(listening.receive(5))
            listening.reopen(second)
            assert next(listening.receive(5)).level == 7
        assert asyncio.run(listen()) in ([7] * 3, [7] * 4)


def test_settings_are_stored_and_restored(package: dict[str, ModuleType], buses: Buses) -> None:
    """A dump, as JSON, makes another node the same: only what differs is written, and read back."""
    old, nodes = _nodes(package, "v2_35")
    gains = {"angle_kp": 80, "angle_ki": 40, "speed_kp": 50, "speed_ki": 20, "iq_kp": 60, "iq_ki": 30}
    simulation = package["simulation"].Simulation(buses[1], nodes)
    simulation[1].values |= gains | {"acceleration": 800}
    simulation[2].values |= gains | {"iq_ki": 31}
    done: list[type] = []

    def note(node: Any, request: Any) -> bool:
        done.append(type(request))
        return True

    for number in (1, 2):
        simulation[number].behaviour.command = note
    with simulation, package["client"].Client(buses[0], nodes, timeout=10) as client:
        with pytest.raises(ValueError, match=r"node=None is none of this client; give one of \[1, 2, 3, 4\]"):
            client.dump()
        settings = json.loads(json.dumps(client.dump(1)))
        assert settings == gains | {"acceleration": 800}
        assert package["client"].differences(settings, client.dump(2)) == {"acceleration": (800, 0), "iq_ki": (30, 31)}
        done.clear()
        with pytest.raises(package["client"].ConsentError, match=r'ROM.* To allow this, give the call allow="wear"$'):
            client.restore({"iq_ki": 30}, 2, kept="rom")
        with pytest.raises(ValueError, match="no request that writes acceleration with kept='rom'"):
            client.restore(settings, 2, kept="rom", allow="wear")
        with pytest.raises(ValueError, match=r"Node\(v2.35, 2\) has no settings iq_kd, voltage"):
            client.restore({"voltage": 48, "iq_kd": 1}, 2)
        assert not [kind for kind in done if "Write" in kind.__name__]
        done.clear()
        assert client.restore(settings, 2) == {"iq_ki": (31, 30), "acceleration": (0, 800)}
        writes = [old.WritePidRamRequest, old.WriteAccelerationRamRequest]
        read_back = {old.ReadPidRequest, old.ReadAccelerationRequest}
        assert (done[2:4], {*done[4:]}) == (writes, read_back)
        done.clear()
        assert client.restore(settings, 2) == {}
        assert {*done} == read_back

        def forget(node: Any, request: Any) -> bool:
            if isinstance(request, old.ReadPidRequest):
                node.values["iq_ki"] = 29
            return True

        simulation[2].behaviour.command = forget
        with pytest.raises(package["client"].NotWritten, match=r"iq_ki of Node\(v2.35, 2\) is 29 after 5 was written"):
            client.restore({"iq_ki": 5}, 2)


def test_a_node_keeps_what_is_written_as_its_effects_say(package: dict[str, ModuleType], buses: Buses) -> None:
    new, nodes = _nodes(package, "v2_36_2025_03")
    simulation = package["simulation"].Simulation(buses[1], nodes, temperature=30)
    node, name = simulation[1], "stored_settings.max_speed"
    with simulation, package["client"].Client(buses[0], nodes, timeout=10) as client:
        first = client.dump(1)
        assert len([*first]) > 20
        wanted = first | {name: 500, "control_parameters.max_speed": 400}
        assert client.restore(wanted, 1) == {name: (0, 500), "control_parameters.max_speed": (0, 400)}
        node.power_on()
        assert client.dump(1) == first
        client.restore({name: 500}, 1, kept="staged")
        client.request(new.SaveStoredSettingsRequest(node=1), allow="wear")
        client.restore({name: 600}, 1)
        assert client.dump(1)[name] == 600
        node.power_on()
        assert (client.dump(1)[name], node.values["temperature"]) == (500, 30)
        with pytest.raises(package["client"].ConsentError, match="another id"):
            client.restore({"stored_settings.driver_id": 2, name: 700}, 1)
        assert client.dump(1)[name] == 500
    old, nodes = _nodes(package, "v2_35")
    simulated = package["simulation"].SimulatedNode(nodes[0])
    simulated.answer(nodes[0].make(old.WritePidRomRequest, **dict.fromkeys(old.WritePidRomRequest.VARIABLES, 9)))
    simulated.answer(nodes[0].make(old.WriteAccelerationRamRequest, acceleration=7))
    assert (simulated.values["iq_ki"], simulated.values["acceleration"]) == (9, 7)
    simulated.power_on()
    assert (simulated.values["iq_ki"], simulated.values.get("acceleration")) == (9, None)


VALUES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
types:
  angle: {raw: u12, unit: rad, scale: 25/4095, offset: -12.5}
  heat: {raw: u8, unit: degC, offset: -40, no_value: {unknown: 255}}
  warm: {raw: u8, unit: K, offset: 200}
  state: {raw: u8, enum: {lit: 1}}
commands:
  read:
    reply:
      angles: {at: 0, type: angle, array: 1..2}
      heat: {at: 3, type: heat}
      warm: {at: 4, type: warm}
      state: {at: 5, type: state}
      label: {at: 6, raw: ascii2}
"""


def test_a_value_that_is_not_given_is_the_one_nearest_to_zero(tmp_path: Path) -> None:
    """Where an offset belongs to a type, it is not the raw integer 0."""
    spec = tmp_path / "lamp.yaml"
    spec.write_text(VALUES, "utf-8")
    package = write_files(PythonTarget().generate([specification(spec)], {}), tmp_path)
    module, nodes, simulation = modules.load(package, "lamp.v1", "lamp.nodes", "lamp.simulation")
    lamp = simulation.SimulatedNode(nodes.Node(module, 1))
    (reply,) = lamp.answer(module.ReadRequest(node=1))
    assert reply.raw() == {"angles": (2048, 2048), "heat": 40, "warm": 0, "state": 1, "label": (0, 0)}
