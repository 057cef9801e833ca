"""A reply as a careful programmer writes it in Python without a generator: the other side of `tests.bench.python`."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

FRAME = struct.Struct("<BbhhH")
CODE, DLC = 0xA1, 8
BASE, NODES = 0x140, range(1, 33)
AMPERES = 33 / 2048
DEGREES = 360 / 65536


@dataclass(frozen=True, slots=True)
class TorqueReply:
    """The reply to the torque command of an MG motor."""

    node: int
    temperature: int
    iq_raw: int
    speed: int
    encoder_raw: int

    @classmethod
    def of(cls, node: int, *, temperature: float, iq: float, speed: float, encoder: float) -> TorqueReply:
        """The reply with values in units."""
        if node not in NODES:
            raise ValueError(f"there is no node {node}")
        return cls(
            node,
            _raw("temperature", temperature, 1, -128, 127),
            _raw("iq", iq, AMPERES, -2048, 2048),
            _raw("speed", speed, 1, -32768, 32767),
            _raw("encoder", encoder, DEGREES, 0, 65535),
        )

    @property
    def iq(self) -> float:
        """In A."""
        return self.iq_raw * AMPERES

    def data(self) -> bytes:
        """The data bytes."""
        return FRAME.pack(CODE, self.temperature, self.iq_raw, self.speed, self.encoder_raw)


def _raw(name: str, value: float, scale: float, low: int, high: int) -> int:
    raw = math.floor(value / scale + 0.5)
    if not low <= raw <= high:
        raise ValueError(f"{name}={value} is out of range {low * scale}..{high * scale}")
    return raw


def decode(can_id: int, data: bytes) -> TorqueReply:
    """The reply in a frame. Raises ValueError."""
    node = can_id - BASE
    if node not in NODES:
        raise ValueError(f"no reply has the id 0x{can_id:X}")
    if len(data) != DLC:
        raise ValueError(f"0x{can_id:X} has {len(data)} data bytes, not {DLC}")
    code, temperature, iq, speed, encoder = FRAME.unpack(data)
    if code != CODE:
        raise ValueError(f"0x{can_id:X} has the unknown code 0x{code:02X}")
    return TorqueReply(node, temperature, iq, speed, encoder)
