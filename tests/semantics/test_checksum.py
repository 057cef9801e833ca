"""Checksums of `123456789`, as the catalogue of CRC algorithms (reveng.sourceforge.io/crc-catalogue) lists them, and sums."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest
from canwright.model.checksum import ALGORITHMS, AlgorithmName
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.semantics.decoder import Decoded, Decoder, Rejection
from canwright.semantics.encoder import Encoder
from canwright.semantics.frame import CanFrame

from ..spec_texts import edition

SPEC = """\
canwright: 1
family: lamp
edition: v1
addresses: {{lamp: {{id: {id}, extended: {extended}}}}}
commands:
  dim:
    request:
      level: {{at: 0, raw: u32}}
      check: {{at: 4, raw: u{width}, byte_order: {order}, checksum: {{{checksum}}}}}
    reply: none
"""
NAMED = {
    "crc8_sae_j1850": 0x4B,
    "crc8_8h2f": 0xDF,
    "crc8_smbus": 0xF4,
    "crc8_maxim": 0xA1,
    "crc16_ccitt_false": 0x29B1,
    "crc16_xmodem": 0x31C3,
    "crc16_kermit": 0x2189,
    "crc16_x25": 0x906E,
    "crc16_modbus": 0x4B37,
    "crc32": 0xCBF43926,
    "sum": 0xDD,  # 0x31 + ... + 0x39 = 477
    "sum_inverted": 0x22,
    "sum_negated": 0x23,
    "xor": 0x31,
    "xor_inverted": 0xCE,
}
"""The check values of the named algorithms; sums have 8 bits."""
BY_PARAMETERS = {
    "CRC-3/GSM": (3, "poly: 0x3, xor_out: 0x7", 0x4),
    "CRC-4/G-704": (4, "poly: 0x3, reflected: true", 0x7),
    "CRC-5/USB": (5, "poly: 0x05, init: 0x1F, reflected: true, xor_out: 0x1F", 0x19),
    "CRC-10/ATM": (10, "poly: 0x233", 0x199),
    "CRC-15/CAN": (15, "poly: 0x4599", 0x059E),
    "CRC-16/RIELLO": (16, "poly: 0x1021, init: 0xB2AA, reflected: true", 0x63D0),
    "CRC-16/TMS37157": (16, "poly: 0x1021, init: 0x89EC, reflected: true", 0x26B1),
    "CRC-24/OPENPGP": (24, "poly: 0x864CFB, init: 0xB704CE", 0x21CF02),
    "CRC-32/AUTOSAR": (
        32,
        "poly: 0xF4ACFB13, init: 0xFFFFFFFF, reflected: true, xor_out: 0xFFFFFFFF",
        0x1697D06A,
    ),
}
"""Some others: their width, their parameters and their check value."""


def encoded(
    folder: Path,
    width: int,
    checksum: str,
    level: int,
    id_: int = 0x100,
    *,
    extended: bool = False,
    order: str = "little",
) -> CanFrame:
    """The frame of a level."""
    text = SPEC.format(id=id_, extended=str(extended).lower(), width=width, checksum=checksum, order=order)
    message = edition(folder, text).command("dim").request
    assert message is not None
    frame = Encoder({}).encode_raws(message, None, {"level": level})
    assert isinstance(frame, CanFrame)
    return frame


def check_value(frame: CanFrame) -> int:
    return int.from_bytes(frame.data[4:], "little")


def test_every_named_algorithm_has_a_check_value() -> None:
    assert list(NAMED) == list(ALGORITHMS) == list(get_args(AlgorithmName))


@pytest.mark.parametrize(
    ("width", "checksum", "expected"),
    [
        *(
            pytest.param(ALGORITHMS[name].width or 8, f"algorithm: {name}", NAMED[name], id=name)
            for name in get_args(AlgorithmName)
        ),
        *(pytest.param(*case, id=name) for name, case in BY_PARAMETERS.items()),
    ],
)
def test_the_check_values_of_the_catalogue(tmp_path: Path, width: int, checksum: str, expected: int) -> None:
    """The first five bytes are constants, the last four are data; then also the first as data and the last as constants."""
    tail = int.from_bytes(b"6789", "little")
    assert check_value(encoded(tmp_path, width, f'{checksum}, over: ["31 32 33 34 35", 0..3]', tail)) == expected
    head = int.from_bytes(b"1234", "little")
    assert check_value(encoded(tmp_path, width, f'{checksum}, over: [0..3, "35 36 37 38 39"]', head)) == expected


def test_a_sum_has_the_width_of_its_field_and_a_negated_one_gives_zero(tmp_path: Path) -> None:
    assert check_value(encoded(tmp_path, 16, "algorithm: sum, over: 0..3", 0xFFFFFFFF)) == 4 * 0xFF
    assert check_value(encoded(tmp_path, 4, "algorithm: sum, over: 0..3", 0x01020305)) == 0xB
    frame = encoded(tmp_path, 8, "algorithm: sum_negated, over: 0..3", 0x12F456C8)
    assert sum(frame.data[:5]) & 0xFF == 0


@pytest.mark.parametrize(
    ("part", "id_", "extended", "order", "bytes_of_id"),
    [
        ("id", 0x123, False, "little", "23 01"),
        ("id", 0x123, False, "big", "01 23"),
        ("id", 0x18EF0102, True, "little", "02 01 EF 18"),
        ("id", 0x18EF0102, True, "big", "18 EF 01 02"),
        ("id_low", 0x123, False, "little", "23"),
        ("id_low", 0x123, False, "big", "23"),
        ("id_low", 0x18EF0102, True, "big", "02"),
    ],
)
def test_the_bytes_of_the_id(tmp_path: Path, part: str, id_: int, extended: bool, order: str, bytes_of_id: str) -> None:
    over_id = f"algorithm: crc8_smbus, over: [{part}, 0..3]"
    with_id = encoded(tmp_path, 8, over_id, 7, id_, extended=extended, order=order)
    constant = encoded(tmp_path, 8, f'algorithm: crc8_smbus, over: ["{bytes_of_id}", 0..3]', 7)
    assert with_id.data == constant.data


def test_bits_of_the_checksum_itself_count_as_0(tmp_path: Path) -> None:
    inside = encoded(tmp_path, 8, "algorithm: crc8_smbus, over: 0..7", 7)
    assert inside.data == encoded(tmp_path, 8, 'algorithm: crc8_smbus, over: [0..3, "00", 5..7]', 7).data


def test_a_wrong_checksum_is_rejected(tmp_path: Path) -> None:
    text = SPEC.format(
        id=0x100, extended="false", width=8, order="big", checksum="algorithm: crc8_sae_j1850, over: 0..3"
    )
    decoder = Decoder(edition(tmp_path, text))
    message = decoder.edition.command("dim").request
    assert message is not None
    frame = Encoder({}).encode_raws(message, None, {"level": 5})
    assert isinstance(frame, CanFrame) and isinstance(decoder.decode(Direction.REQUEST, frame, {}), Decoded)
    for bit in range(40):
        data = (int.from_bytes(frame.data, "little") ^ 1 << bit).to_bytes(8, "little")
        decoded = decoder.decode(Direction.REQUEST, frame._replace(data=data), {})
        assert isinstance(decoded, Rejection)
        assert (decoded.reason, decoded.field) == (Refusal.WRONG_CHECKSUM, "check")
