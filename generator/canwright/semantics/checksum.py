"""The checksum of a frame: which bytes enter a register, in which order, and how the register changes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

from ..model.checksum import Arithmetic, ConstantBytes, DataBytes, IdBytes
from ..model.layout import ChecksumRole, Field, Segment, Space
from ..model.message import Message
from ..model.types import Order


class FrameByte(NamedTuple):
    """Eight bits of a frame, each at its position in a byte; bits without a segment are 0. There is at least one."""

    space: Space
    segments: tuple[Segment, ...]

    @property
    def is_whole(self) -> bool:
        """Whether it is a data byte with all of its bits."""
        return self.space is Space.DATA and sum(segment.width for segment in self.segments) == 8


class ChecksumPlan(NamedTuple):
    """A checksum as operations on a register of `width` bits, at least 8, whose value is `init` at first.

    Each of the `inputs` in turn, a byte of the frame or a constant, changes the register:
    - sum, xor: it is added, or applied with exclusive or;
    - crc: it is applied to the highest 8 bits with exclusive or; then, 8 times, the register is shifted left, and `poly`
      applied to it if the bit shifted out was 1;
    - crc with `is_reflected`: it is applied to the lowest 8 bits; the register is shifted right.

    The checksum is `register >> shift ^ xor_out`.
    """

    arithmetic: Arithmetic
    width: int
    poly: int
    init: int
    is_reflected: bool
    shift: int
    xor_out: int
    inputs: tuple[FrameByte | int, ...]

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1

    @property
    def runs(self) -> Sequence[range | Sequence[FrameByte | int]]:
        """The inputs in parts: ranges of whole data bytes in ascending order, and all others between them."""
        runs: list[range | list[FrameByte | int]] = []
        for part in self.inputs:
            last = runs[-1] if runs else None
            if isinstance(part, FrameByte) and part.is_whole:
                byte = part.segments[0].byte
                if isinstance(last, range) and last.stop == byte:
                    runs[-1] = range(last.start, byte + 1)
                else:
                    runs.append(range(byte, byte + 1))
            elif isinstance(last, list):
                last.append(part)
            else:
                runs.append([part])
        return runs

    def next(self, register: int, byte: int) -> int:
        """The register after one more byte."""
        if self.arithmetic is Arithmetic.SUM:
            return register + byte & self.mask
        if self.arithmetic is Arithmetic.XOR:
            return register ^ byte
        register ^= byte if self.is_reflected else byte << self.width - 8
        for _ in range(8):
            if self.is_reflected:
                register = register >> 1 ^ (self.poly if register & 1 else 0)
            else:
                register = (register << 1 & self.mask) ^ (self.poly if register >> self.width - 1 else 0)
        return register


@lru_cache(maxsize=4096)
def checksum_plan(message: Message, field: Field, role: ChecksumRole) -> ChecksumPlan:
    """The plan of a checksum of a message; constants before all other bytes are part of its initial value."""
    of, own = role.algorithm, field.elements[0].segments
    width = of.width or field.type.width
    register = max(width, 8) if of.arithmetic is Arithmetic.CRC else width
    shift = 0 if of.is_reflected else register - width
    inputs: list[FrameByte | int] = []
    for part in role.inputs:
        if isinstance(part, ConstantBytes):
            inputs += part.data
        elif isinstance(part, DataBytes):
            inputs += [_data_byte(byte, own) for byte in range(part.first, part.last + 1)]
        else:
            inputs += _id_bytes(message, part)
    start = ChecksumPlan(
        arithmetic=of.arithmetic,
        width=register,
        poly=_reversed(of.poly, width) if of.is_reflected else of.poly << shift,
        init=_reversed(of.init, width) if of.is_reflected else of.init << shift,
        is_reflected=of.is_reflected,
        shift=shift,
        xor_out=of.xor_out,
        inputs=(),
    )
    init = start.init
    for constant in role.leading:
        init = start.next(init, constant)
    return start._replace(init=init, inputs=tuple(inputs[len(role.leading) :]))


def _data_byte(byte: int, own: Iterable[Segment]) -> FrameByte | int:
    """A data byte without the bits of the checksum itself; 0 if it has no others."""
    taken = sum((1 << s.width) - 1 << s.low for s in own if s.byte == byte)
    free = [bit for bit in range(8) if not taken >> bit & 1]
    if not free:
        return 0
    starts = [bit for bit in free if bit - 1 not in free]
    ends = [bit + 1 for bit in free if bit + 1 not in free]
    return FrameByte(
        Space.DATA, tuple(Segment(byte, low, end - low, low) for low, end in zip(starts, ends, strict=True))
    )


def _id_bytes(message: Message, part: IdBytes) -> Sequence[FrameByte]:
    """The bytes of the id, 2 of 11 bits and 4 of 29, lowest or highest first; or the lowest one."""
    width = 29 if message.id.extended else 11
    each = [FrameByte(Space.ID, (Segment(0, low, min(8, width - low), 0),)) for low in range(0, width, 8)]
    if part.is_low:
        return each[:1]
    return each if part.order is Order.LITTLE else each[::-1]


def _reversed(number: int, width: int) -> int:
    return int(f"{number:0{width}b}"[::-1], 2)
