"""Values whose frame is identified as another message: all that dispatch confuses, and nothing else, is rejected."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.model.edition import Edition
from canwright.model.golden_frames import Value
from canwright.model.layout import Field
from canwright.model.message import Message
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.semantics.confusion import required_bits
from canwright.semantics.decoder import Decoder, Identified, Rejection
from canwright.semantics.encoder import Encoder
from canwright.semantics.frame import Raw, signed

from ..spec_texts import SPECS

HEAD = """\
canwright: 1
family: joint
edition: v1
byte_order: big
addresses: {joint: {request: node, reply: 0x7F, nodes: 1..15}}
"""
MARKED = (
    HEAD
    + """\
types:
  p: {raw: u16, unit: rad, scale: 25/65535, offset: -12.5}
  v: {raw: u12, unit: rad/s, scale: 90/4095, offset: -45}
  t: {raw: i12, unit: Nm, scale: 18/2048}
commands:
  enable: {request: {marker: {at: 0, raw: u40, constant: 0xFFFFFFFFF0}, rest: {at: 5, raw: u24, constant: 7}}, reply: none}
  control: {request: {p: {at: 0, type: p}, v: {at: 2, type: v}, t: {at: 3.3, type: t}}, reply: none}
"""
)
PAGES = (
    HEAD
    + """\
selector: {at: 0, raw: u8}
types: {page: {raw: u8, PAGES}}
commands:
  stop: {code: 3, request: none, reply: {why: {at: 1, raw: u8}}}
  short: {code: 5, request: none, reply: {layout: {why: {at: 1, raw: u8}}, dlc: 2}}
  cells: {request: none, reply: {page: {at: 0, type: page}, cell: {at: 1, raw: u8}}}
"""
)


def edition(text: str, folder: Path) -> Edition:
    spec = folder / "joint.yaml"
    spec.write_text(text, "utf-8")
    return specification(spec).edition


def outcome(encoder: Encoder, message: Message, raws: Mapping[str, Raw]) -> str:
    node = None if message.id.nodes is None else message.id.nodes[-1]
    encoded = encoder.encode_raws(message, node, raws)
    return encoded.reason.value if isinstance(encoded, Rejection) else encoded.data.hex()


def test_the_fixed_bytes_of_another_command_are_rejected(tmp_path: Path) -> None:
    joint = edition(MARKED.replace(", rest: {at: 5, raw: u24, constant: 7}", ""), tmp_path)
    control = joint.command("control").request
    assert control is not None
    encoder = Encoder({})
    assert outcome(encoder, control, {"p": 0xFFFF, "v": 0xFFF, "t": -1}) == "fffffffff" + "f000000"
    assert outcome(encoder, control, {"p": 0xFFFF, "v": 0xFFF, "t": -16}) == "wrong_message"
    # 12.5 rad, 45 rad/s and raw -16 are those raw integers
    values: dict[str, Value] = {"p": Fraction(25, 2), "v": Fraction(45), "t": Fraction(-16 * 18, 2048)}
    rejected = encoder.encode_values(control, 1, values)
    assert isinstance(rejected, Rejection)
    assert rejected.text == "control_request with these values is the request of enable: FF FF FF FF F0 00 00 00"


def test_bits_that_no_frame_has_make_no_confusion(tmp_path: Path) -> None:
    """The fields of `control` end before the last constant of `enable`, so its bytes there are 0."""
    control = edition(MARKED, tmp_path).command("control").request
    assert control is not None
    assert control.confusions == ()


@pytest.mark.parametrize(
    ("pages", "codes"),
    [
        ("raw_range: 0..255", [3, 5]),
        ("raw_range: 4..255", [5]),
        ("raw_range: 6..255", []),
        ("raw_range: 0..4", [3]),
        ("enum: {a: 0, b: 3}", [3]),
        ("flags: {a: 0, b: 2}", [5]),
        ("raw_range: 6..255, no_value: {unknown: 3}", [3]),
    ],
)
def test_pages_with_the_value_of_a_code_are_rejected(tmp_path: Path, pages: str, codes: list[int]) -> None:
    """Of another length, too: a receiver rejects such a frame because of its length."""
    cells = edition(PAGES.replace("PAGES", pages), tmp_path).command("cells").reply
    assert cells is not None
    assert [values for c in cells.confusions for _, (values,) in c.conditions] == codes
    first = [outcome(Encoder({}), cells, {"page": page, "cell": 1}) for page in range(256)]
    assert [page for page, said in enumerate(first) if said == "wrong_message"] == codes


def test_a_constant_of_the_id_is_confused_with_a_field_there(tmp_path: Path) -> None:
    text = """\
canwright: 1
family: gate
edition: v1
addresses: {gate: {id: 0x18000000, extended: true}}
commands:
  alarm: {request: none, reply: {kind: {at: id.8, raw: u8, constant: 0x21}, level: {at: 0, raw: u8}}}
  level: {request: none, reply: {kind: {at: id.8, raw: u8}, level: {at: 1, raw: u8}}}
"""
    level = edition(text, tmp_path).command("level").reply
    assert level is not None
    said = [outcome(Encoder({}), level, {"kind": kind, "level": 1}) for kind in (0x20, 0x21)]
    assert said == ["0001000000000000", "wrong_message"]


def _random_raws(message: Message, dice: random.Random) -> dict[str, Raw]:
    """Raw integers of all fields, often those of a confusion."""
    raws: dict[str, Raw] = {}
    for field in message.layout.fields:
        if field.is_given:
            bits = [dice.choice((0, 1, dice.getrandbits(field.type.width))) for _ in field.elements]
            each = [signed(field.type, raw & (1 << field.type.width) - 1) for raw in bits]
            raws[field.name] = each if field.is_array else each[0]
    for field, mask, raw in _required(message, dice):
        if not field.is_array and isinstance(was := raws[field.name], int):
            raws[field.name] = signed(field.type, was & (1 << field.type.width) - 1 & ~mask | raw)
    return raws


def _required(message: Message, dice: random.Random) -> Iterator[tuple[Field, int, int]]:
    if message.confusions and dice.random() < 0.5:
        chosen = dice.choice(message.confusions)
        yield from required_bits(message, [(bits, dice.choice(values)) for bits, values in chosen.conditions])


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: f"{spec.parent.name}-{spec.stem}")
def test_a_frame_that_is_sent_is_identified_as_its_message(spec: Path) -> None:
    """The confusions come from the keys of messages; the decisions of the dispatch plan agree."""
    subject, encoder, dice = specification(spec).edition, Encoder({}), random.Random(7)
    decoder = Decoder(subject)
    for message in subject.all_messages():
        if message.layout.parameters or message.parameters or message.id.parameter:
            continue
        if message.keys and message.keys[0].value not in message.identifying_codes:
            continue
        node = None if message.id.nodes is None else message.id.nodes[-1]
        for _ in range(20):
            frame = encoder.encode_raws(message, node, _random_raws(message, dice))
            if isinstance(frame, Rejection):
                assert frame.reason in (Refusal.OUT_OF_RANGE, Refusal.NOT_FINITE, Refusal.WRONG_MESSAGE)
                continue
            identified = decoder.identify(message.direction, frame)
            assert isinstance(identified, Identified)
            assert identified.message is message
