"""The golden frames cross a python-can bus, and the other side reads them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from canwright.conformance.adapter import write_files
from canwright.conformance.modules import load
from canwright.conformance.python import PythonAdapter
from canwright.model.golden_frames import GoldenFrame
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.semantics.frame import CanFrame, code_of, node_of
from canwright.targets.python.target import PythonTarget

from ..spec_texts import ROOT, SPECS, called


@pytest.fixture
def buses(request: pytest.FixtureRequest) -> Iterator[tuple[can.BusABC, can.BusABC]]:
    channel = request.node.name
    host = can.Bus(interface="virtual", channel=channel)
    node = can.Bus(interface="virtual", channel=channel)
    yield host, node
    host.shutdown()
    node.shutdown()


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_golden_frames_cross_a_python_can_bus(
    spec: Path, buses: tuple[can.BusABC, can.BusABC], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = specification(spec)
    assert item.frames is not None
    for output in PythonTarget().generate([item], {}):
        file = tmp_path / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in [name for name in sys.modules if name.split(".")[0] == item.edition.family]:
        monkeypatch.delitem(sys.modules, name)
    module = __import__(f"{item.edition.family}.{item.edition.identifier}", fromlist=["*"])
    python_can = __import__(f"{item.edition.family}.python_can", fromlist=["*"])
    adapter = PythonAdapter(item.edition, module)
    host, node = buses
    crossed = 0
    for frame in item.frames.frames:
        sender, receiver = (host, node) if frame.direction is Direction.REQUEST else (node, host)
        decode = module.decode_request if frame.direction is Direction.REQUEST else module.decode_reply
        parameters = adapter.parameters(frame.parameters)
        if frame.decode_only:
            sender.send(can.Message(arbitration_id=frame.id, data=frame.data, is_extended_id=frame.extended))
        else:
            sender.send(python_can.to_message(_message(adapter, frame)))
        received = receiver.recv(timeout=1)
        assert received is not None
        assert (received.arbitration_id, bytes(received.data)) == (frame.id, frame.data)
        message = python_can.from_message(received, decode, parameters)
        raw = {name: list(value) if isinstance(value, tuple) else int(value) for name, value in message.raw().items()}
        name = f"{message.COMMAND}_{message.DIRECTION}"
        expected = next(candidate for candidate in item.edition.messages(frame.direction) if candidate.name == name)
        expected_node = node_of(expected, CanFrame(frame.id, frame.data, frame.extended))
        if expected.id.parameter is not None and expected.id.nodes is not None:  # the id needs its parameter
            expected_node = frame.node
        assert (message.node, raw) == (expected_node, dict(frame.raw))
        crossed += 1
    assert crossed == len(item.frames.frames) > 0


def _message(adapter: PythonAdapter, frame: GoldenFrame) -> object:
    message = adapter.message_of(frame.direction, frame.command)
    code = code_of(message, CanFrame(frame.id, frame.data, frame.extended, frame.remote))
    return adapter.message(frame.direction, frame.command, frame.node, frame.raw, frame.parameters, code)


@pytest.mark.parametrize(("spec", "switches_rate"), [("servo", True), ("tank", False)])
def test_frames_of_can_fd(spec: str, switches_rate: bool, tmp_path: Path) -> None:
    item = specification(ROOT / f"tests/specs/{spec}/v1.yaml")
    folder = write_files(PythonTarget().generate([item], {}), tmp_path)
    module, python_can = load(folder, f"{spec}.v1", f"{spec}.python_can")
    assert item.frames is not None
    for golden in (frame for frame in item.frames.frames if not frame.decode_only):
        decode = module.decode_request if golden.direction is Direction.REQUEST else module.decode_reply
        received = can.Message(
            arbitration_id=golden.id, is_extended_id=golden.extended, data=golden.data, is_fd=len(golden.data) > 8
        )
        frame = python_can.to_message(python_can.from_message(received, decode))
        assert (frame.is_fd, frame.bitrate_switch, frame.dlc) == (True, switches_rate, len(golden.data))
        assert (frame.arbitration_id, bytes(frame.data)) == (golden.id, golden.data)


def test_error_and_fd_frames_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "generated/python"))
    for name in [name for name in sys.modules if name.split(".")[0] == "mwd_motor"]:
        monkeypatch.delitem(sys.modules, name)
    module = __import__("mwd_motor.v2_35", fromlist=["*"])
    python_can = __import__("mwd_motor.python_can", fromlist=["*"])
    for flags in ({"is_error_frame": True}, {"is_fd": True}, {"is_remote_frame": True}, {"is_extended_id": True}):
        frame = can.Message(
            arbitration_id=0x141,
            data=None if "is_remote_frame" in flags else b"\x9a" + bytes(7),
            **{"is_extended_id": False, **flags},
        )
        with pytest.raises(ValueError, match="0x141") as caught:
            python_can.from_message(frame, module.decode_reply)
        assert caught.value.refusal.value == "unknown_id"  # type: ignore[attr-defined]
