"""The checksum of a layout as a function, which packing and decoding call."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...model import formatting
from ...model.checksum import Arithmetic
from ...semantics.checksum import ChecksumPlan, FrameByte
from ...semantics.plan import CheckChecksum
from . import bits
from .expressions import call, operand
from .names import Names

VARIABLE = "checksum"
"""The variable whose value packing writes."""


class ChecksumStep(NamedTuple):
    """A statement for one more byte; with `last`, for each of the data bytes `frame->data[i]` from `first` on."""

    statement: str
    first: int = 0
    last: int = 0


class CrcView(NamedTuple):
    """A function for one more byte of a CRC: bit by bit, or with a table of 16 `entries` of the type `kind`.

    With it, `applied` is the register with the byte, and `step` the register `next` after four of its bits.
    """

    name: str
    doc: str
    kind: str
    entries: tuple[str, ...]
    applied: str
    step: str
    bit_by_bit: str


class ChecksumView(NamedTuple):
    """The function for its bytes if it is a CRC; the initial value, the steps and the result of the function; the writes of packing, and the field of a frame."""

    crc: CrcView | None
    doc: str
    init: str
    steps: tuple[ChecksumStep, ...]
    result: str
    writes: tuple[bits.Write, ...]
    read: str

    @property
    def has_loops(self) -> bool:
        return any(step.last for step in self.steps)


def checksum_view(names: Names, check: CheckChecksum) -> ChecksumView:
    field, plan = check.field, check.checksum
    segments, width = field.elements[0].segments, field.type.width
    crc = _crc(names, plan) if plan.arithmetic is Arithmetic.CRC else None
    return ChecksumView(
        crc=crc,
        doc=f"The checksum of a frame in `{field.name}`: {formatting.checksum(check.role)}.",
        init=f"0x{plan.init:X}u",
        steps=tuple(_steps(plan, crc)),
        result=_result(plan),
        writes=tuple(bits.write_segments(field.space, segments, width, VARIABLE)),
        read=operand(bits.read_segments(field.space, segments, width)),
    )


def _crc(names: Names, plan: ChecksumPlan) -> CrcView:
    poly, width = f"0x{plan.poly:X}u", plan.width
    given = ("crc", "byte", poly) if plan.is_reflected else ("crc", "byte", poly, f"{width}u")
    kind = next(bits_ for bits_ in (8, 16, 32) if width <= bits_)
    reflected = ", lowest bit first" if plan.is_reflected else ""
    index = "next & 0xFu" if plan.is_reflected else f"next >> {width - 4}"
    left = "next << 4" if width == 32 else f"(next << 4) & 0x{plan.mask:X}u"
    high = f"((uint32_t)byte << {width - 8})" if width > 8 else "byte"
    return CrcView(
        name=names.crc(plan),
        doc=f"A CRC register of {width} bits after one more byte{reflected}; by a table with CANWRIGHT_CRC_TABLE.",
        kind=f"uint{kind}_t",
        entries=tuple(f"0x{plan.next(0, n << 4 if plan.is_reflected else n):0{kind // 4}X}u" for n in range(16)),
        applied="crc ^ byte" if plan.is_reflected else f"crc ^ {high}",
        step=f"({'next >> 4' if plan.is_reflected else left}) ^ table[{index}]",
        bit_by_bit=call("canwright_crc_reflected" if plan.is_reflected else "canwright_crc", *given),
    )


def _steps(plan: ChecksumPlan, crc: CrcView | None) -> Iterator[ChecksumStep]:
    for run in plan.runs:
        if not isinstance(run, range):
            yield from (ChecksumStep(_next(plan, crc, _byte(part))) for part in run)
        elif len(run) == 1:
            yield ChecksumStep(_next(plan, crc, f"frame->data[{run.start}]"))
        else:
            yield ChecksumStep(_next(plan, crc, "frame->data[i]"), run.start, run.stop - 1)


def _byte(part: FrameByte | int) -> str:
    return f"0x{part:02X}u" if isinstance(part, int) else bits.read_segments(part.space, part.segments, 8)


def _next(plan: ChecksumPlan, crc: CrcView | None, byte: str) -> str:
    if crc is None:
        return f"{VARIABLE} {'+' if plan.arithmetic is Arithmetic.SUM else '^'}= {byte}"
    return f"{VARIABLE} = {call(crc.name, VARIABLE, f'(uint8_t){operand(byte)}' if ' ' in byte else byte)}"


def _result(plan: ChecksumPlan) -> str:
    result = f"({VARIABLE} >> {plan.shift})" if plan.shift else VARIABLE
    if plan.arithmetic is Arithmetic.SUM and plan.width < 32:
        result = f"({result} & 0x{plan.mask:X}u)"
    result = f"{result} ^ 0x{plan.xor_out:X}u" if plan.xor_out else result
    return result.removeprefix("(").removesuffix(")") if not plan.xor_out else result
