"""The checksum of a layout as a function, which packing and decoding call."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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


class CrcView:
    """A function for one more byte of a CRC: bit by bit, or with a table of 16 `entries` of the type `kind`.

    With it, `applied` is the register with the byte, and `step` the register `next` after four of its bits.
    """

    def __init__(self, names: Names, plan: ChecksumPlan) -> None:
        poly, width = f"0x{plan.poly:X}u", plan.width
        kind = next(bits_ for bits_ in (8, 16, 32) if width <= bits_)
        self.name, self.kind = names.crc(plan), f"uint{kind}_t"
        order = ", lowest bit first" if plan.is_reflected else ""
        self.doc = f"A CRC register of {width} bits after one more byte{order}; by a table with CANWRIGHT_CRC_TABLE."
        firsts = (n << 4 if plan.is_reflected else n for n in range(16))
        self.entries = [f"0x{plan.next(0, first):0{kind // 4}X}u" for first in firsts]
        if plan.is_reflected:
            self.applied, self.step = "crc ^ byte", "(next >> 4) ^ table[next & 0xFu]"
            self.bit_by_bit = call("canwright_crc_reflected", "crc", "byte", poly)
        else:
            left = "next << 4" if width == 32 else f"(next << 4) & 0x{plan.mask:X}u"
            self.applied = f"crc ^ {f'((uint32_t)byte << {width - 8})' if width > 8 else 'byte'}"
            self.step = f"({left}) ^ table[next >> {width - 4}]"
            self.bit_by_bit = call("canwright_crc", "crc", "byte", poly, f"{width}u")


class ChecksumView:
    """The checksum of a layout: its initial value, the steps and the result of the function; the writes of packing."""

    def __init__(self, names: Names, check: CheckChecksum) -> None:
        field, plan = check.field, check.checksum
        segments, width = field.elements[0].segments, field.type.width
        self.crc = CrcView(names, plan) if plan.arithmetic is Arithmetic.CRC else None
        """The function for its bytes; None if it is no CRC."""
        self.doc = f"The checksum of a frame in `{field.name}`: {formatting.checksum(check.role)}."
        self.init = f"0x{plan.init:X}u"
        self.steps = [step for run in plan.runs for step in _steps(plan, self.crc, run)]
        self.has_loops = any(step.last for step in self.steps)
        self.result = _result(plan)
        self.writes = list(bits.write(field.space, segments, width, VARIABLE))


def _steps(plan: ChecksumPlan, crc: CrcView | None, run: range | Sequence[FrameByte | int]) -> Iterator[ChecksumStep]:
    if not isinstance(run, range):
        yield from (ChecksumStep(_next(plan, crc, _byte(part))) for part in run)
    elif len(run) == 1:
        yield ChecksumStep(_next(plan, crc, f"frame->data[{run.start}]"))
    else:
        yield ChecksumStep(_next(plan, crc, "frame->data[i]"), run.start, run.stop - 1)


def _byte(part: FrameByte | int) -> str:
    return f"0x{part:02X}u" if isinstance(part, int) else bits.read(part.space, part.segments, 8)


def _next(plan: ChecksumPlan, crc: CrcView | None, byte: str) -> str:
    if crc is None:
        return f"{VARIABLE} {'+' if plan.arithmetic is Arithmetic.SUM else '^'}= {byte}"
    return f"{VARIABLE} = {call(crc.name, VARIABLE, f'(uint8_t){operand(byte)}' if ' ' in byte else byte)}"


def _result(plan: ChecksumPlan) -> str:
    result = f"{VARIABLE} >> {plan.shift}" if plan.shift else VARIABLE
    if plan.arithmetic is Arithmetic.SUM and plan.width < 32:
        result = f"{operand(result)} & 0x{plan.mask:X}u"
    return f"{operand(result)} ^ 0x{plan.xor_out:X}u" if plan.xor_out else result
