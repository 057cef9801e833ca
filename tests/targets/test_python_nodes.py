"""A bus whose nodes speak different editions, on a real python-can bus."""

from __future__ import annotations

import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import can
import pytest
from canwright.conformance import modules

from ..spec_texts import MINIMAL, ROOT
from .test_python import write

NAMES = ("v2_35", "v2_35_2024_02", "v2_36_2025_03", "nodes", "python_can", "_codec")


@pytest.fixture(scope="module")
def package() -> Iterator[dict[str, ModuleType]]:
    """The committed package, all editions in one process, whatever other tests have imported under its name."""
    imported = {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "mwd_motor"}
    sys.path.insert(0, str(ROOT / "generated/python"))
    yield {name: import_module(f"mwd_motor.{name}") for name in NAMES}
    sys.path.remove(str(ROOT / "generated/python"))
    for name in [name for name in sys.modules if name.split(".")[0] == "mwd_motor"]:
        del sys.modules[name]
    sys.modules.update(imported)


@pytest.fixture(scope="module")
def nodes(package: dict[str, ModuleType]) -> Any:
    old, middle, new = (package[name] for name in NAMES[:3])
    make = package["nodes"].Node
    known = old.Parameters(series=old.Series.MG, encoder_bits=18)
    return package["nodes"].Nodes([make(old, 1, known), make(middle, 2), make(new, 3)])


# 48.7 V as 0.1 V in DATA[3..4] from the first, 48.72 V as 0.01 V in DATA[2..3] from the others, on their own ids
REPLIES = [
    (0x141, "9A 32 00 E7 01 00 00 00", 1, 48.7),
    (0x142, "9A 32 08 13 64 00 00 00", 2, 48.72),
    (0x183, "9A 32 08 13 64 00 10 00", 3, 48.72),
]


def test_three_editions_on_one_bus(nodes: Any, package: dict[str, ModuleType]) -> None:
    from_message = package["python_can"].from_message
    with (
        can.Bus("nodes", interface="virtual") as sender,
        can.Bus("nodes", interface="virtual") as receiver,
    ):
        for can_id, data, *_ in REPLIES:
            sender.send(can.Message(arbitration_id=can_id, data=bytes.fromhex(data), is_extended_id=False))
        for _, _, node, voltage in REPLIES:
            frame = receiver.recv(1)
            assert frame is not None
            read = from_message(frame, nodes.decode_reply)
            assert (read.node, read.voltage) == (node, voltage)


def test_a_request_is_read_by_the_edition_of_its_node(nodes: Any) -> None:
    # 0x95 clears the angle in one edition, sets it in the next, and sets the zero in the last
    requests = [nodes.decode_request(0x140 + n, bytes.fromhex("95 00 00 00 10 27 00 00")) for n in (1, 2, 3)]
    assert [type(m).__name__ for m in requests] == ["ClearAngleRequest", "SetAngleRequest", "SetZeroRamRequest"]
    assert requests[1].angle == 100.0


def test_a_message_of_another_edition_is_refused(nodes: Any, package: dict[str, ModuleType]) -> None:
    old, middle = package["v2_35"], package["v2_35_2024_02"]
    first, second, _ = nodes
    assert first.make(old.SetTorqueRequest, iq=2.5).encode() == bytes.fromhex("A1 00 00 00 9B 00 00 00")
    assert first.make(old.ReadStatus1Request).can_id == 0x141
    with pytest.raises(TypeError, match=r"is of another edition than Node\(v2.35-2024-02, 2\)"):
        second.make(old.SetTorqueRequest, iq=2.5)
    with pytest.raises(TypeError, match="use its Parameters"):
        package["nodes"].Node(middle, 1, old.Parameters())


def test_a_command_that_the_node_does_not_have_is_refused(nodes: Any, package: dict[str, ModuleType]) -> None:
    """Its parameters decide; a node whose series is unknown can have any command."""
    old, codec, make = package["v2_35"], package["_codec"], package["nodes"].Node
    first, _, _ = nodes
    with pytest.raises(codec.CodecError) as caught:
        first.make(old.SetPowerRequest, power=200)
    assert str(caught.value) == ("SetPowerRequest is available with series=Series.MS, not Series.MG")
    assert caught.value.refusal is codec.Refusal.NOT_AVAILABLE
    # a bus can carry the frame nevertheless
    assert first.decode_request(0x141, bytes.fromhex("A0000000C8000000")).power == 200
    for known in (None, old.Parameters(series=old.Series.MS), old.Parameters(encoder_bits=18)):
        assert make(old, 1, known).make(old.SetPowerRequest, power=200).power == 200


def test_a_broadcast_made_by_a_node_is_for_every_node(nodes: Any, package: dict[str, ModuleType]) -> None:
    first, _, _ = nodes
    broadcast = first.make(package["v2_35"].BroadcastTorqueRequest, iq=(1, 0, 0, -1))
    assert (broadcast.can_id, broadcast.node) == (0x280, None)
    # 1 A is raw 62.5 of 0.016 A, away from zero 63
    assert broadcast.encode() == bytes.fromhex("3F 00 00 00 00 00 C1 FF")
    with pytest.raises(TypeError, match="node"):
        first.make(package["v2_35"].BroadcastTorqueRequest, node=1, iq=(1, 0, 0, -1))


def test_a_node_sets_its_number_and_its_parameters(nodes: Any, package: dict[str, ModuleType]) -> None:
    first, _, _ = nodes
    for name, value in (("node", 3), ("parameters", package["v2_35"].UNKNOWN)):
        with pytest.raises(TypeError, match=rf"^Node\(v2.35, 1\) sets {name} itself; leave it out$"):
            first.make(package["v2_35"].SetTorqueRequest, iq=1, **{name: value})


def test_a_request_to_nodes_of_two_editions_is_refused(package: dict[str, ModuleType]) -> None:
    """Nodes that differ in the ids of their replies only."""
    old, middle, new = (package[name] for name in NAMES[:3])
    make, codec = package["nodes"].Node, package["_codec"]
    first, second, third = make(old, 1), make(middle, 2), make(new, 1)
    data = b"\x9a" + bytes(7)
    for order in ((first, second, third), (third, second, first)):
        bus = package["nodes"].Nodes(order)
        assert bus.nodes_of("request", 0x141) == tuple(node for node in order if node is not second)
        with pytest.raises(codec.CodecError, match=r"^0x141 is a request of Node.* and of Node.*; decode it") as caught:
            bus.decode_request(0x141, data)
        assert caught.value.refusal is codec.Refusal.UNKNOWN_NODE
        assert [node.decode_request(0x141, data).node for node in bus.nodes_of("request", 0x141)] == [1, 1]
        assert type(bus.decode_request(0x142, data)) is middle.ReadStatus1Request


def test_a_broadcast_is_decoded_with_the_parameters_that_all_nodes_share(package: dict[str, ModuleType]) -> None:
    old = package["v2_35"]
    mf, mg = (old.Parameters(series=series, encoder_bits=18) for series in (old.Series.MF, old.Series.MG))
    for second, shared in ((mg, mg), (mf, old.Parameters(encoder_bits=18)), (None, old.UNKNOWN)):
        bus = package["nodes"].Nodes([package["nodes"].Node(old, 1, mg), package["nodes"].Node(old, 2, second)])
        broadcast = bus.decode_request(0x280, bytes.fromhex("3F 00 00 00 00 00 C1 FF"))
        assert (broadcast.iq_raw, broadcast.parameters) == ((63, 0, 0, -63), shared)


def test_a_reply_of_an_unknown_node_is_rejected(nodes: Any, package: dict[str, ModuleType]) -> None:
    for can_id in (0x181, 0x143, 0x144, 0x7FF):
        with pytest.raises(package["_codec"].CodecError, match="no node of this bus") as caught:
            nodes.decode_reply(can_id, bytes.fromhex("9A 32 08 13 64 00 10 00"))
        assert caught.value.refusal is package["_codec"].Refusal.UNKNOWN_ID


@pytest.fixture(scope="module")
def valves(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """An edition whose service requests have one id: their node is in the data, or the low four bits of its number are."""
    spec = ROOT / "tests/specs/valve/v1.yaml"
    return modules.load(write(tmp_path_factory.mktemp("valve"), spec), "valve.v1", "valve.nodes")


def test_the_node_in_the_data(valves: Any) -> None:
    v1, nodes = valves
    first, second = nodes.Node(v1, 37), nodes.Node(v1, 5)
    bus = nodes.Nodes([first, second])
    request = second.make(v1.ReadSerialRequest)
    assert (request.valve, request.node, request.can_id) == (5, 5, 0x7E5)
    assert repr(request) == "ReadSerialRequest(valve=5)"
    assert v1.decode_request(request.can_id, request.encode()) == request
    for node in bus:
        data = node.make(v1.ReadSerialRequest).encode()
        assert bus.nodes_of("request", 0x7E5, data) == (node,)
        assert bus.decode_request(0x7E5, data).node == v1.node_of("request", 0x7E5, data) == node.node
    assert bus.nodes_of("request", 0x7E5) == (first, second) and v1.node_of("request", 0x7E5) is None
    with pytest.raises(v1.CodecError, match="is of no node of this bus") as caught:
        bus.decode_request(0x7E5, v1.ReadSerialRequest(valve=6).encode())
    assert caught.value.refusal is v1.Refusal.UNKNOWN_NODE
    with pytest.raises(v1.CodecError, match="unknown code") as caught:
        bus.decode_request(0x7E5, bytes(8))
    assert caught.value.refusal is v1.Refusal.UNKNOWN_CODE
    with pytest.raises(TypeError, match=r"^Node\(v1, 5\) sets valve itself; leave it out$"):
        second.make(v1.ReadSerialRequest, valve=5)


def test_the_low_bits_of_a_node_do_not_identify_it(valves: Any) -> None:
    v1, nodes = valves
    bus = nodes.Nodes([nodes.Node(v1, 37), nodes.Node(v1, 5)])
    reply = next(iter(bus)).make(v1.ReadVersionReply, version=7)
    assert (reply.valve, reply.node) == (37 & 15, None)
    assert bus.nodes_of("reply", 0x7E4, reply.encode()) == tuple(bus)
    assert bus.decode_reply(0x7E4, reply.encode()) == reply
    request = nodes.Node(v1, 37).make(v1.ReadVersionRequest)
    assert v1.decode_answer(request, 0x7E4, reply.encode()) == reply


def test_a_frame_is_decoded_with_the_parameters_of_the_node_in_its_data(tmp_path: Path) -> None:
    spec = ROOT / "tests/verification/specs/doser/v1.yaml"
    v1, nodes = modules.load(write(tmp_path, spec), "doser.v1", "doser.nodes")
    pair = [nodes.Node(v1, number, v1.Parameters(cylinder=number * 10)) for number in (2, 4)]
    for node in pair:
        request = node.make(v1.DoseRequest, volume=5)
        assert (request.doser, request.parameters) == (node.node, node.parameters)
        read = nodes.Nodes(pair).decode_request(0x60, request.encode())
        assert read == request and read.volume == 5


def test_two_nodes_on_one_id_are_refused(package: dict[str, ModuleType]) -> None:
    make = package["nodes"].Node
    with pytest.raises(ValueError, match="both reply with the id 0x141"):
        package["nodes"].Nodes([make(package["v2_35"], 1), make(package["v2_35_2024_02"], 1)])
    package["nodes"].Nodes([make(package["v2_35"], 1), make(package["v2_36_2025_03"], 1)])


def test_a_full_bus_costs_no_more_than_its_editions(package: dict[str, ModuleType]) -> None:
    """Each edition is asked once an id, and no id is tried out when the nodes are put together."""
    asked: list[str] = []

    class Counted:
        """An edition that notes what it is asked."""

        def __init__(self, edition: ModuleType) -> None:
            self.edition = edition

        def __getattr__(self, name: str) -> Any:
            asked.append(name)
            return getattr(self.edition, name)

    editions = [Counted(package[name]) for name in ("v2_35", "v2_36_2025_03")]
    bus = package["nodes"].Nodes([package["nodes"].Node(editions[n % 2], n) for n in range(1, 33)])
    assert "node_bits_of" not in asked
    asked.clear()
    reply = bus.decode_reply(0x180 + 31, bytes.fromhex("9A 32 08 13 64 00 10 00"))
    assert (reply.node, reply.voltage) == (31, 48.72)
    assert asked.count("node_bits_of") == 2
    bus.decode_reply(0x180 + 31, bytes.fromhex("9A 32 08 13 64 00 10 00"))
    assert asked.count("node_bits_of") == 2


def test_two_nodes_on_one_29_bit_id_are_refused(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    ids = "{id: 0x1000 + node, nodes: 1..4, extended: true}"
    spec.write_text(MINIMAL.replace("{id: 0x100 + node, nodes: 1..4}", ids), "utf-8")
    write(tmp_path, spec)
    program = (
        "from lamp import v1\n"
        "from lamp.nodes import Node, Nodes\n"
        "Nodes([Node(v1, 1), Node(v1, 2)])\n"
        "try:\n"
        "    Nodes([Node(v1, 1), Node(v1, 2), Node(v1, 1)])\n"
        "except ValueError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "both reply with the id 0x1001" in done.stdout


class Line:
    """A bus that returns own frames or not, with a node that replies to each frame."""

    def __init__(self, returned: bool, answer: Callable[[can.Message], Sequence[can.Message]]) -> None:
        self.returned, self.answer, self.queue = returned, answer, deque[can.Message]()
        self.is_full = False

    def send(self, frame: can.Message) -> None:
        if self.is_full:
            raise can.CanOperationError("the queue is full")
        self.queue += [frame] * self.returned + list(self.answer(frame))

    def recv(self, timeout: float) -> can.Message | None:
        return self.queue.popleft() if self.queue else None


def _times(count: int, frame: can.Message) -> Sequence[can.Message]:
    return [frame] * count


def _always(answer: Sequence[can.Message], frame: can.Message) -> Sequence[can.Message]:
    return answer


STATUS = can.Message(arbitration_id=0x141, data=bytes.fromhex("9A3200E701000000"), is_extended_id=False)


@pytest.mark.parametrize("returned", [False, True])
def test_own_frames_are_no_replies(returned: bool, package: dict[str, ModuleType]) -> None:
    """The node echoes, is silent, and echoes again; a frame that equals the request is a reply once the copy came."""
    old, python_can = package["v2_35"], package["python_can"]
    probe, request = old.ReadStatus1Request(node=1), old.MotorOnRequest(node=1)
    line = Line(returned, lambda frame: [STATUS])
    own = python_can.OwnFrames.learn(line, probe, partial(old.decode_answer, probe), 1)
    assert own.are_returned is returned and not line.queue

    def ask() -> list[Any]:
        own.send(request)
        frames = list(iter(partial(line.recv, 0), None))
        decode = partial(old.decode_answer, request)
        return [python_can.from_message(frame, decode) for frame in frames if not own.is_own(frame)]

    for echoes in (1, 0, 0, 1, 2):
        line.answer = partial(_times, echoes)
        assert ask() == [old.MotorOnReply(node=1)] * echoes
    line.is_full = True
    with pytest.raises(can.CanOperationError):
        own.send(request)
    assert not own.is_own(python_can.to_message(request))


@pytest.mark.parametrize("power", [200, -1])
@pytest.mark.parametrize("returned", [False, True])
def test_a_request_of_a_second_host_is_taken_for_a_reply(
    returned: bool, power: int, package: dict[str, ModuleType]
) -> None:
    """As the README states. The own request is no reply, nor is it with a node alone; a late reply answers the next request."""
    old, python_can = package["v2_35"], package["python_can"]
    request, second = old.SetPowerRequest(node=1, power=200), old.SetPowerRequest(node=1, power=power)
    reply = can.Message(arbitration_id=0x141, data=bytes.fromhex("A032C800F4010080"), is_extended_id=False)
    known = old.Parameters(series=old.Series.MS)
    decode = partial(old.decode_answer, request)
    with (
        can.Bus("hosts", interface="virtual", receive_own_messages=returned) as bus,
        can.Bus("hosts", interface="virtual") as other_host,
        can.Bus("hosts", interface="virtual") as node,
    ):
        own = python_can.OwnFrames(bus, are_returned=returned)

        def replies() -> list[Any]:
            frames = iter(partial(bus.recv, 0), None)
            return [python_can.from_message(frame, decode, known) for frame in frames if not own.is_own(frame)]

        own.send(request)
        node.send(reply)
        answer = python_can.from_message(reply, decode, known)
        assert replies() == [answer]
        own.send(request)
        other_host.send(python_can.to_message(second))
        node.send(reply)
        assert replies() == [old.decode_reply(0x141, second.encode(), known), answer]
        own.send(request)
        assert replies() == []
        own.send(request)
        node.send(reply)
        assert replies() == [answer]


def test_nothing_is_learnt_from_a_silent_bus(package: dict[str, ModuleType]) -> None:
    old, own_frames = package["v2_35"], package["python_can"].OwnFrames
    probe = old.ReadStatus1Request(node=1)
    decode = partial(old.decode_answer, probe)
    unrelated = can.Message(arbitration_id=0x141, data=b"other", is_extended_id=False)
    for answer in ([], [unrelated], [can.Message(arbitration_id=0x141, data=STATUS.data, is_error_frame=True)]):
        with pytest.raises(TimeoutError, match=r"^no reply to ReadStatus1Request\(node=1\)$"):
            own_frames.learn(Line(False, partial(_always, answer)), probe, decode, 0.01)
    assert own_frames.learn(Line(True, lambda frame: []), probe, decode, 0.01).are_returned
    # a driver may deliver the copy after the reply
    late = Line(False, lambda frame: [STATUS, frame])
    assert own_frames.learn(late, probe, decode, 0.01).are_returned
