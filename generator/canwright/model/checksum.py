"""Checksums: the algorithms, and the bytes of a frame over which one is computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from .types import Order


class Arithmetic(str, Enum):
    """How each further byte changes a checksum."""

    CRC = "crc"
    SUM = "sum"
    XOR = "xor"


@dataclass(frozen=True)
class Algorithm:
    """A checksum by its parameters, as the public catalogues of CRCs state them.

    `poly` is that of a CRC without its highest bit. `is_reflected` means that bytes enter and the result leaves with bit 0
    first. Negative numbers have all higher bits set; `of_width` limits them to the width.
    """

    arithmetic: Arithmetic
    width: int | None = None
    """The number of bits; None for a sum, which has as many as its field."""
    poly: int = 0
    init: int = 0
    is_reflected: bool = False
    xor_out: int = 0

    def of_width(self, width: int) -> Algorithm:
        """The algorithm with a width, and no number beyond it."""
        mask = (1 << width) - 1
        return replace(self, width=width, poly=self.poly & mask, init=self.init & mask, xor_out=self.xor_out & mask)


def _crc(width: int, poly: int, init: int = 0, xor_out: int = 0, *, is_reflected: bool = False) -> Algorithm:
    return Algorithm(Arithmetic.CRC, width, poly, init, is_reflected, xor_out)


AlgorithmName = Literal[
    "crc8_sae_j1850",
    "crc8_8h2f",
    "crc8_smbus",
    "crc8_maxim",
    "crc16_ccitt_false",
    "crc16_xmodem",
    "crc16_kermit",
    "crc16_x25",
    "crc16_modbus",
    "crc32",
    "sum",
    "sum_inverted",
    "sum_negated",
    "xor",
    "xor_inverted",
]

ALGORITHMS: dict[AlgorithmName, Algorithm] = {
    "crc8_sae_j1850": _crc(8, 0x1D, 0xFF, 0xFF),
    "crc8_8h2f": _crc(8, 0x2F, 0xFF, 0xFF),
    "crc8_smbus": _crc(8, 0x07),
    "crc8_maxim": _crc(8, 0x31, is_reflected=True),
    "crc16_ccitt_false": _crc(16, 0x1021, 0xFFFF),
    "crc16_xmodem": _crc(16, 0x1021),
    "crc16_kermit": _crc(16, 0x1021, is_reflected=True),
    "crc16_x25": _crc(16, 0x1021, 0xFFFF, 0xFFFF, is_reflected=True),
    "crc16_modbus": _crc(16, 0x8005, 0xFFFF, is_reflected=True),
    "crc32": _crc(32, 0x04C11DB7, 0xFFFFFFFF, 0xFFFFFFFF, is_reflected=True),
    "sum": Algorithm(Arithmetic.SUM),
    "sum_inverted": Algorithm(Arithmetic.SUM, xor_out=-1),
    "sum_negated": Algorithm(Arithmetic.SUM, init=-1, xor_out=-1),
    "xor": Algorithm(Arithmetic.XOR, 8),
    "xor_inverted": Algorithm(Arithmetic.XOR, 8, xor_out=-1),
}
"""The algorithms that have a name in the language. With `sum_negated`, the sum of all bytes and the checksum is 0."""

MAX_WIDTH = 32
"""The maximum number of bits of a checksum."""


@dataclass(frozen=True)
class DataBytes:
    """Data bytes, both ends included; bits of the checksum itself count as 0."""

    first: int
    last: int


@dataclass(frozen=True)
class IdBytes:
    """The CAN id: 2 bytes for 11 bits, 4 bytes for 29 bits, in this order; or its lowest byte only."""

    order: Order
    is_low: bool


@dataclass(frozen=True)
class ConstantBytes:
    """Bytes that are not in the frame, such as a data id."""

    data: bytes


Input = DataBytes | IdBytes | ConstantBytes
