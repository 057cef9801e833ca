"""What the DBC adapter answers beyond the golden frames: refusals, and the cases that no DBC can say."""

from __future__ import annotations

import functools
from fractions import Fraction
from pathlib import Path

import pytest
from cantools.database.can import Message as CanMessage
from canwright.conformance.adapter import CanFrame, Cannot, Decoded, ExactValue, Parameters, Raw, Refused
from canwright.conformance.dbc import DbcAdapter
from canwright.conformance.dbc_file import DbcMessages, load
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.targets.dbc.target import DbcTarget

from ..spec_texts import ROOT, called

CASES = Path(__file__).parents[1] / "targets" / "dbc"


@functools.cache
def adapter(name: str) -> DbcAdapter:
    return DbcAdapter(specification(CASES / f"{name}.yaml"))


def read(data: str, parameters: Parameters, answering: str | None = None, id_: int = 0x101) -> Decoded | Refused:
    return adapter("tiny").decode(Direction.REPLY, CanFrame(id_, bytes.fromhex(data)), parameters, answering)


def write(command: str, values: dict[str, ExactValue], parameters: Parameters, node: int = 1) -> CanFrame | Refused:
    return adapter("tiny").encode_values(Direction.REQUEST, command, node, values, parameters)


def write_raw(direction: Direction, command: str, raw: dict[str, Raw], parameters: Parameters) -> CanFrame | Refused:
    return adapter("tiny").encode_raw(direction, command, 1, raw, parameters)


@pytest.mark.parametrize(
    ("data", "id_", "says"),
    [
        ("1A 00 00 00 00 00 00 00", 0x104, Refusal.UNKNOWN_ID),
        ("1A 00 00 00 00 00 00", 0x101, Refusal.WRONG_LENGTH),
        ("2D 00 00 00 00 00 00 00", 0x101, Refusal.UNKNOWN_CODE),
    ],
)
def test_frames_that_are_refused(data: str, id_: int, says: Refusal) -> None:
    assert read(data, {"size": "small"}, id_=id_) == Refused(says)


def test_an_extended_id_differs_from_the_standard_id_of_its_number() -> None:
    frame = CanFrame(0x101, bytes.fromhex("1A 00 00 00 00 00 00 00"), extended=True)
    assert adapter("tiny").decode(Direction.REPLY, frame, {}, None) == Refused(Refusal.UNKNOWN_ID)


def test_flags_are_decoded_as_raw_byte_and_names() -> None:
    result = read("1A 00 02 00 00 00 00 61", {"steps": 10})
    assert isinstance(result, Decoded)
    assert result.raw == {"turn": 0x200, "faults": 0x61}
    assert result.values == {"turn": 180.0, "faults": ["hot", "dead"]}


def test_a_value_without_a_known_scale_is_none() -> None:
    result = read("1A 00 02 00 00 00 00 61", {})
    assert isinstance(result, Decoded)
    assert result.values["turn"] is None


@pytest.mark.parametrize(
    ("values", "parameters", "expected"),
    [
        ({"dim": Fraction(5), "colour": "blue"}, {"size": "small"}, "1A 85 3E 00 00 00 00 00"),
        ({"dim": Fraction("5.005"), "colour": "blue"}, {"size": "small"}, Refused(Refusal.OUT_OF_RANGE, "dim")),
        ({"dim": "nan", "colour": "blue"}, {"size": "small"}, Refused(Refusal.NOT_FINITE, "dim")),
        ({"dim": Fraction(5), "colour": "green"}, {"size": "small"}, Refused(Refusal.OUT_OF_RANGE, "colour")),
    ],
)
def test_values_within_and_beyond_their_range(
    values: dict[str, ExactValue], parameters: Parameters, expected: str | Refused
) -> None:
    wanted = CanFrame(0x101, bytes.fromhex(expected)) if isinstance(expected, str) else expected
    assert write("shine", values, parameters) == wanted


def test_unknown_nodes_and_missing_parameters_are_rejected() -> None:
    turn: dict[str, ExactValue] = {"turn": Fraction(90), "power": Fraction(0)}
    assert write("turn", turn, {"steps": 12}, node=4) == Refused(Refusal.UNKNOWN_NODE)
    assert write("turn", turn, {}) == Refused(Refusal.MISSING_PARAMETER, "turn")
    assert write("turn", turn, {"steps": 12}) == CanFrame(0x101, bytes.fromhex("1B 00 00 00 64 00 00 04"))
    too_much: dict[str, ExactValue] = {"turn": Fraction(90), "power": Fraction(1)}
    assert write("turn", too_much, {"steps": 12, "rating": 1}) == Refused(Refusal.OUT_OF_RANGE, "power")


@pytest.mark.parametrize(
    ("exception", "case"),
    [
        ("exchanges", lambda: adapter("tiny").answers(CanFrame(0x101, bytes(8)), CanFrame(0x101, bytes(8)))),
        ("shared_code", lambda: read("1A 00 00 00 00 00 00 00", {}, "turn")),
        ("other_value", lambda: write("shine", {"dim": Fraction(0), "colour": "red"}, {"size": "big"})),
        ("unnamed", lambda: write_raw(Direction.REQUEST, "shine", {"dim": 0, "colour": 3}, {"size": "small"})),
        ("unnamed", lambda: write_raw(Direction.REPLY, "shine", {"turn": 0, "faults": 2}, {})),
        ("rounding", lambda: write("shine", {"dim": Fraction("0.0025"), "colour": "red"}, {"size": "small"})),
        ("rounding", lambda: write("shine", {"dim": Fraction("5.002"), "colour": "red"}, {"size": "small"})),
        (
            "constants",
            lambda: adapter("packed").decode(Direction.REQUEST, CanFrame(0x2C, bytes(8), extended=True), {}, None),
        ),
        (
            "reserved_in_id",
            lambda: DbcAdapter(specification(ROOT / "tests/specs/cells/v1.yaml")).decode(
                Direction.REPLY, CanFrame(0x1D05FF41, bytes(8), extended=True), {}, None
            ),
        ),
        (
            "unknown_range",
            lambda: DbcAdapter(specification(ROOT / "spec/mwd_motor/v2.36-2025-03.yaml")).encode_raw(
                Direction.REQUEST, "stage_stored_setting_max_power", 1, {"max_power": -1}, {}
            ),
        ),
        ("reply_limits", lambda: write_raw(Direction.REPLY, "gauge", {"dim": 1001}, {"size": "small"})),
        (
            "confusion",
            lambda: DbcAdapter(specification(ROOT / "tests/specs/joint/v1.yaml")).encode_raw(
                *(Direction.REPLY, "control", None),
                {"fault": 0, "joint": 3, "position": 51, "speed": 0, "torque": 0, "temperature": 0},
                {},
            ),
        ),
        ("lengths", lambda: write("short", {}, {})),
        ("left_out", lambda: adapter("packed").encode_raw(Direction.REQUEST, "read_precise", 1, {}, {})),
        (
            "not_finite",
            lambda: adapter("packed").encode_values(Direction.REPLY, "read_precise", 1, {"precise": "inf"}, {}),
        ),
    ],
)
def test_what_a_dbc_cannot_express_is_a_named_exception(exception: str, case: functools.partial[object]) -> None:
    assert exception in DbcAdapter.cannot
    with pytest.raises(Cannot) as raised:
        case()
    assert raised.value.name == exception


def all_of(message: CanMessage) -> tuple[object, ...]:
    """Everything that a file says of a message."""
    signals = [
        (
            *(s.name, s.start, s.length, s.byte_order, s.is_signed, s.is_multiplexer, s.multiplexer_ids),
            *(repr(s.conversion), s.minimum, s.maximum, s.unit, s.comment, s.receivers, s.raw_initial),
        )
        for s in message.signals
    ]
    ids = (message.name, message.frame_id, message.is_extended_frame, message.length)
    return (*ids, message.senders, message.comment, signals)


@pytest.mark.parametrize("spec", [ROOT / "spec/mwd_motor/v2.35.yaml", ROOT / "tests/specs/cells/v1.yaml"], ids=called)
def test_a_message_loaded_alone_equals_that_of_the_whole_file(spec: Path) -> None:
    outputs = [
        output for output in DbcTarget().generate([specification(spec)], {}) if output.path.endswith("-reply.dbc")
    ]
    text = outputs[0].text
    wholes, parts = load(text).messages, DbcMessages(text)
    assert [message.name for message in wholes] == list(parts.names)
    for whole in wholes:
        assert all_of(parts.message(parts.names[whole.name])) == all_of(whole)
