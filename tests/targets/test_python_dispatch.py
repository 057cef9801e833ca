"""The look-ups of the generated dispatch, against a plain walk of its routes and against the reference decoder."""

from __future__ import annotations

import array
from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from canwright.conformance.python import load
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.semantics.decoder import Decoder, Rejection
from canwright.semantics.frame import CanFrame, node_of
from canwright.targets.python.text import class_name

from ..resolve.test_tables import TABLE
from ..semantics.random_frames import random_frames
from ..semantics.test_dispatch import LENGTHS, PLACES, UNUSED
from ..spec_texts import MINIMAL, ROOT, SPECS, called
from .test_python import write

FRAMES = 1000

EXTENDED = MINIMAL.replace("nodes: 1..4", "nodes: 1..4, extended: true")
MANY_NODES = MINIMAL.replace("0x100 + node, nodes: 1..4", "0x1000 + node, nodes: 0..60000, extended: true")
UNUSUAL = {
    "places": PLACES,
    "lengths": LENGTHS,
    "unused": UNUSED,
    "table": TABLE,
    "29-bit": EXTENDED,
    "many": MANY_NODES,
}


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_random_and_golden_frames(spec: Path, tmp_path: Path) -> None:
    item = specification(spec)
    assert item.frames is not None
    golden = [CanFrame(f.id, f.data, f.extended, f.remote) for f in item.frames.frames]
    compare(load(write(tmp_path, spec), item.edition), item.edition, [*golden, *random_frames(item.edition, FRAMES)])


@pytest.mark.parametrize("name", UNUSUAL)
def test_random_frames_of_unusual_specs(name: str, tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(UNUSUAL[name], "utf-8")
    edition = specification(spec).edition
    compare(load(write(tmp_path, spec), edition), edition, random_frames(edition, FRAMES))


def compare(module: ModuleType, edition: Edition, frames: Iterable[CanFrame]) -> None:
    """Compares every frame in both directions; both messages and rejections have to occur."""
    decoder = Decoder(edition)
    seen: Counter[str] = Counter()
    for frame in frames:
        flags = {"extended": frame.extended, "remote": frame.remote}
        for direction, decode in ((Direction.REQUEST, module.decode_request), (Direction.REPLY, module.decode_reply)):
            actual = outcome(decode, frame.id, frame.data, **flags)
            assert actual == outcome(plain_decode, module, direction, frame), (direction, frame)
            reference = decoder.decode(direction, frame, {})
            if isinstance(reference, Rejection):
                assert actual[:1] == (reference.reason.value,), (direction, frame)
            else:
                assert actual[:2] == (class_name(reference.message.name), node_of(reference.message, frame)), (
                    direction,
                    frame,
                )
            seen[str(actual[0])] += 1
    assert "unknown_id" in seen and any(name[0].isupper() for name in seen)


def outcome(decode: Callable[..., Any], *arguments: object, **named: bool) -> tuple[object, ...]:
    """Class, node and raw integers of the message that a call returns, or reason, text and field of its rejection."""
    try:
        message = decode(*arguments, **named)
        return type(message).__name__, message.node, message.raw()
    except ValueError as error:
        assert error.__context__ is None
        return error.refusal.value, str(error), error.field  # type: ignore[attr-defined]


def plain_decode(module: ModuleType, direction: Direction, frame: CanFrame) -> Any:
    """Decodes a frame by trying the routes in their order."""
    dispatcher = module._dispatcher
    router = dispatcher.requests if direction is Direction.REQUEST else dispatcher.replies
    for route in router.routes:
        is_of_route, node = route.node(frame.id)
        if is_of_route and route.kind == (frame.extended, frame.remote):
            return route.message(frame.id, frame.data).unpack(node, frame.id, frame.data, module.UNKNOWN)
    return router.find(frame.id, frame.extended, frame.remote)


@pytest.fixture(scope="module")
def v2_35(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    spec = ROOT / "spec/mwd_motor/v2.35.yaml"
    return load(write(tmp_path_factory.mktemp("python"), spec), specification(spec).edition)


@pytest.fixture(scope="module")
def v2_36(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    spec = ROOT / "spec/mwd_motor/v2.36-2024-11.yaml"
    return load(write(tmp_path_factory.mktemp("python"), spec), specification(spec).edition)


def test_messages_with_data_bytes_as_keys_are_looked_up_without_routes(
    v2_36: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A message behind one key or behind two is found without the routes."""
    monkeypatch.setattr(type(v2_36._dispatcher.requests), "find", None)
    assert type(v2_36.decode_request(0x141, bytes.fromhex("9A 00 00 00 00 00 00 00"))) is v2_36.ReadStatus1Request
    read = v2_36.decode_reply(0x181, bytes.fromhex("C0 0A 01 00 02 00 03 00"))
    assert type(read) is v2_36.ReadControlParameterAnglePidReply


def test_the_answers_to_a_broadcast_come_from_its_nodes(v2_35: ModuleType) -> None:
    """Whether the request is known as a class or as a frame."""
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    data = bytes.fromhex("A1 32 9B 00 F4 01 00 80")
    request = v2_35.BroadcastTorqueRequest
    for node in range(1, 33):
        answer = (0x140 + node, data)
        calls: list[Callable[[], object]] = [
            partial(v2_35.decode_answer, request, *answer, known),
            partial(v2_35.check_reply, request.ID, bytes(8), *answer),
        ]
        for call in calls:
            if node <= 4:
                call()
            else:
                with pytest.raises(
                    v2_35.CodecError, match=f"to node 1 or 2 or 3 or 4, this came from node {node}$"
                ) as caught:
                    call()
                assert caught.value.refusal is v2_35.Refusal.NOT_ANSWER


DATA = bytes.fromhex("9A 19 60 09 96 00 00 00")
BUFFERS = [
    bytearray(DATA),
    memoryview(DATA),
    memoryview(bytearray(DATA)),
    memoryview(DATA).cast("c"),
    memoryview(DATA).cast("H"),
    memoryview(bytes(b for byte in DATA for b in (byte, 0xFF)))[::2],
    array.array("B", DATA),
    type("OtherBytes", (bytes,), {})(DATA),
]


@pytest.mark.parametrize("data", BUFFERS, ids=lambda data: type(data).__name__)
def test_any_bytes_like_data(data: Any, v2_36: ModuleType) -> None:
    request, reply = (0x141, b"\x9a" + bytes(7)), (0x181, data)
    wanted = v2_36.decode_reply(0x181, DATA)
    for message in (v2_36.decode_reply(*reply), v2_36.decode_answer(v2_36.ReadStatus1Request, *reply)):
        assert (message, hash(message), message.encode()) == (wanted, hash(wanted), wanted.encode())
        assert [type(raw) for raw in message.raw().values()] == [type(raw) for raw in wanted.raw().values()]
    v2_36.check_reply(*request, *reply)
    v2_36.check_reply(request[0], memoryview(request[1]), *reply)


@pytest.mark.parametrize("data", ["9A00000000000000", 8, [0x9A, 0, 0, 0, 0, 0, 0, 0], None])
def test_data_that_is_not_bytes_like(data: Any, v2_36: ModuleType) -> None:
    calls: list[Callable[[], object]] = [
        lambda: v2_36.decode_request(0x141, data),
        lambda: v2_36.decode_reply(0x181, data),
        lambda: v2_36.decode_answer(v2_36.ReadStatus1Request, 0x181, data),
        lambda: v2_36.check_reply(0x141, data, 0x181, DATA),
        lambda: v2_36.check_reply(0x141, DATA, 0x181, data),
    ]
    for call in calls:
        with pytest.raises(TypeError, match="bytes-like"):
            call()
