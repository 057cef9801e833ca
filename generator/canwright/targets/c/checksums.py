"""The checksum of a layout as a function, which packing and decoding call."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...model import formatting
from ...model.checksum import Arithmetic
from ...model.layout import ChecksumRole
from ...semantics.checksum import ChecksumPlan, FrameByte
from ...semantics.plan import CheckChecksum
from . import bits
from .expressions import call, operand

VARIABLE = "checksum"
"""The variable whose value packing writes."""


class ChecksumStep(NamedTuple):
    """A statement for one more byte; with `last`, for each of the data bytes `frame->data[i]` from `first` on."""

    statement: str
    first: int = 0
    last: int = 0


class ChecksumView(NamedTuple):
    """The initial value, the steps and the result of the function; the writes of packing, and the field of a frame."""

    doc: str
    init: str
    steps: tuple[ChecksumStep, ...]
    result: str
    writes: tuple[bits.Write, ...]
    read: str

    @property
    def has_loops(self) -> bool:
        return any(step.last for step in self.steps)


def checksum_view(check: CheckChecksum) -> ChecksumView:
    field, plan = check.field, check.checksum
    role = field.role
    assert isinstance(role, ChecksumRole)
    segments, width = field.elements[0].segments, field.type.width
    return ChecksumView(
        doc=f"The checksum of a frame in `{field.name}`: {formatting.checksum(role)}.",
        init=f"0x{plan.init:X}u",
        steps=tuple(_steps(plan)),
        result=_result(plan),
        writes=tuple(bits.write_segments(field.space, segments, width, VARIABLE)),
        read=operand(bits.read_segments(field.space, segments, width)),
    )


def _steps(plan: ChecksumPlan) -> Iterator[ChecksumStep]:
    for run in plan.runs:
        if not isinstance(run, range):
            yield from (ChecksumStep(_next(plan, _byte(part))) for part in run)
        elif len(run) == 1:
            yield ChecksumStep(_next(plan, f"frame->data[{run.start}]"))
        else:
            yield ChecksumStep(_next(plan, "frame->data[i]"), run.start, run.stop - 1)


def _byte(part: FrameByte | int) -> str:
    return f"0x{part:02X}u" if isinstance(part, int) else bits.read_segments(part.space, part.segments, 8)


def _next(plan: ChecksumPlan, byte: str) -> str:
    if plan.arithmetic is not Arithmetic.CRC:
        return f"{VARIABLE} {'+' if plan.arithmetic is Arithmetic.SUM else '^'}= {byte}"
    given = f"(uint8_t){operand(byte)}" if " " in byte else byte
    if plan.is_reflected:
        return f"{VARIABLE} = {call('canwright_crc_reflected', VARIABLE, given, f'0x{plan.poly:X}u')}"
    return f"{VARIABLE} = {call('canwright_crc', VARIABLE, given, f'0x{plan.poly:X}u', f'{plan.width}u')}"


def _result(plan: ChecksumPlan) -> str:
    result = f"({VARIABLE} >> {plan.shift})" if plan.shift else VARIABLE
    if plan.arithmetic is Arithmetic.SUM and plan.width < 32:
        result = f"({result} & 0x{plan.mask:X}u)"
    result = f"{result} ^ 0x{plan.xor_out:X}u" if plan.xor_out else result
    return result.removeprefix("(").removesuffix(")") if not plan.xor_out else result
