"""What tells messages apart in C: parts of bytes, a second key, bits of the id, lengths, and constants."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest
from canwright.conformance.adapter import CanFrame, Decoded, Refused
from canwright.model.edition import Edition
from canwright.model.layout import Segment, Space
from canwright.model.message import Command, Direction, Key, KeyRole, Message
from canwright.model.refusal import Refusal
from canwright.model.types import Order
from canwright.project.loader import specification
from canwright.targets.base import EditionInput

from ..conformance.adapters.c import CAdapter

SPEC = """\
canwright: 1
family: keys
edition: v1
addresses:
  it: {id: 0x10000 + node, nodes: 0..3, extended: true}
selector: {at: 0, raw: u4}
types:
  high: {raw: u4}
  small: {raw: i3}
  pair: {raw: u16, byte_order: big}
commands:
  first: {code: 1, request: {high: {at: 0.4, type: high}}, reply: echo}
  second: {code: 1, request: {high: {at: 0.4, type: high}, pair: {at: 4, type: pair}}, reply: echo}
  third: {code: 2, request: {small: {at: id.20, type: small}, pair: {at: 4, type: pair}}, reply: echo}
  short: {code: 3, request: {dlc: 2, layout: {high: {at: 1.2, type: high}}}, reply: none}
  fixed: {code: 4, request: {mark: {at: 1.3, raw: i9, constant: -2}, high: {at: 0.4, type: high}}, reply: none}
"""

INDEX = {"first": 0x0201, "second": 0x0302}
"""The second key of the commands that share a code: 16 bits in bytes 2 and 3, the high byte first."""

NODE_2 = 0x10002


def second_key(value: int) -> Key:
    segments = (Segment(3, 0, 8, 0), Segment(2, 0, 8, 8))
    return Key(
        name="index",
        role=KeyRole.INDEX,
        space=Space.DATA,
        order=Order.BIG,
        width=16,
        segments=segments,
        value=value,
    )


def with_second_keys(edition: Edition) -> Edition:
    """The edition with a second key where two commands share a code."""

    def message(original: Message) -> Message:
        if original.command not in INDEX:
            return original
        keys = (*original.keys, second_key(INDEX[original.command]))
        return dataclasses.replace(original, keys=keys, identifying_codes=(original.keys[0].value,))

    return with_messages(edition, message)


def with_messages(edition: Edition, changed: Callable[[Message], Message]) -> Edition:
    """The edition with other requests and replies."""

    def command(original: Command) -> Command:
        replies = tuple(dataclasses.replace(reply, message=changed(reply.message)) for reply in original.replies)
        return dataclasses.replace(original, request=original.request and changed(original.request), replies=replies)

    return dataclasses.replace(edition, commands=tuple(map(command, edition.commands)))


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> CAdapter:
    folder = tmp_path_factory.mktemp("keys")
    file = folder / "spec.yaml"
    file.write_text(SPEC.replace("second: {code: 1", "second: {code: 5"), "utf-8")
    edition = specification(file).edition
    second = edition.command("second").request
    assert second is not None
    edition = _recoded(edition)
    return CAdapter.create(EditionInput(with_second_keys(edition), None), folder)


def _recoded(edition: Edition) -> Edition:
    """`second` with the code of `first`, which no rule of the language allows without a second key."""

    def message(original: Message) -> Message:
        if original.command != "second":
            return original
        return dataclasses.replace(
            original, keys=(dataclasses.replace(original.keys[0], value=1),), identifying_codes=(1,)
        )

    return with_messages(edition, message)


FRAMES = [
    ("first", {"high": 9}, NODE_2, "91 00 02 01 00 00 00 00"),
    ("second", {"high": 15, "pair": 0x1234}, NODE_2, "F1 00 03 02 12 34 00 00"),
    ("third", {"small": -3, "pair": 0xABCD}, NODE_2 | 5 << 20, "02 00 00 00 AB CD 00 00"),
    ("short", {"high": 10}, NODE_2, "03 28"),
    ("fixed", {"high": 7}, NODE_2, "74 F0 0F 00 00 00 00 00"),
]


@pytest.mark.parametrize(("command", "raw", "id_", "data"), FRAMES, ids=[f[0] for f in FRAMES])
def test_decoding_an_encoded_request_returns_its_raw_integers(
    command: str, raw: dict[str, int], id_: int, data: str, target: CAdapter
) -> None:
    frame = CanFrame(id_, bytes.fromhex(data), extended=True)
    assert target.encode_raw(Direction.REQUEST, command, 2, raw, {}) == CanFrame(frame.id, frame.data, extended=True)
    decoded = target.decode(Direction.REQUEST, frame, {}, None)
    assert decoded == Decoded(command, 2, raw, {name: float(value) for name, value in raw.items()})


REFUSED = [
    ("another second key", NODE_2, "91 00 02 02 00 00 00 00", Refusal.UNKNOWN_CODE),
    ("another first key", NODE_2, "0F 00 02 01 00 00 00 00", Refusal.UNKNOWN_CODE),
    ("no such node", 0x10004, "91 00 02 01 00 00 00 00", Refusal.UNKNOWN_ID),
    ("bits of the id that no field has", NODE_2 | 1 << 23, "02 00 00 00 00 00 00 00", Refusal.UNKNOWN_ID),
    ("a field of another message in the id", NODE_2 | 1 << 20, "91 00 02 01 00 00 00 00", Refusal.UNKNOWN_ID),
    ("no message has this length", NODE_2, "91 00 02 01 00 00 00", Refusal.WRONG_LENGTH),
    ("the code of a message of another length", NODE_2, "03 28 00 00 00 00 00 00", Refusal.WRONG_LENGTH),
    ("a constant that differs", NODE_2, "74 F8 0F 00 00 00 00 00", Refusal.WRONG_CONSTANT),
]


@pytest.mark.parametrize(("id_", "data", "says"), [r[1:] for r in REFUSED], ids=[r[0] for r in REFUSED])
def test_refused(id_: int, data: str, says: Refusal, target: CAdapter) -> None:
    frame = CanFrame(id_, bytes.fromhex(data), extended=True)
    assert target.decode(Direction.REQUEST, frame, {}, None) == Refused(says)


@pytest.mark.parametrize(("id_", "data", "says"), [r[1:] for r in REFUSED[:6]], ids=[r[0] for r in REFUSED[:6]])
def test_an_invalid_reply_is_rejected_with_its_reason(id_: int, data: str, says: Refusal, target: CAdapter) -> None:
    frame = CanFrame(id_, bytes.fromhex(data), extended=True)
    command = "third" if data.startswith("02") else "first"
    assert target.decode(Direction.REPLY, frame, {}, command) == Refused(says)


def test_the_second_key_tells_whose_answer_it_is(target: CAdapter) -> None:
    first = CanFrame(NODE_2, bytes.fromhex("91 00 02 01 00 00 00 00"), extended=True)
    second = CanFrame(NODE_2, bytes.fromhex("91 00 03 02 00 00 00 00"), extended=True)
    assert target.answers(first, first) is None
    assert target.answers(first, second) == Refused(Refusal.NOT_ANSWER)
    assert target.answers(second, second._replace(id=NODE_2 + 1)) == Refused(Refusal.NOT_ANSWER)
