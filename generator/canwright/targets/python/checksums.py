"""Checksums: the functions that compute them, and the statements that check and write them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass

from ...model.checksum import Arithmetic
from ...model.layout import Space
from ...model.message import Message
from ...semantics.checksum import ChecksumPlan, FrameByte
from ...semantics.plan import CheckChecksum, message_plan
from . import bits, code, text
from .imports import Imports


@dataclass(frozen=True)
class Checksums:
    """The checksums of one edition; `functions` are the calls that make their functions, each with its name."""

    imports: Imports
    functions: dict[str, str] = dataclasses.field(default_factory=dict)

    def check(self, step: CheckChecksum, dlc: int) -> code.Code:
        """The statement of `unpack` that checks a checksum."""
        read = bits.read(bits.place("", step.field, step.field.elements[0]), dlc)
        computed = self._computed(step.checksum, dlc)
        return code.call(self.imports.use("checksum"), (read, computed, text.literal(step.field.name)))

    def insert(self, message: Message) -> Iterator[code.Code]:
        """The statements that return `data` with the checksum of a message in bits that are 0."""
        step = message_plan(message).checksum
        assert step is not None
        if any(isinstance(part, FrameByte) and part.space is Space.ID for part in step.checksum.inputs):
            yield "can_id = self.can_id"
        yield self._computed(step.checksum, message.dlc, "found = ")
        place = bits.place("found", step.field, step.field.elements[0])
        first, count, length = place.first_byte, place.width // 8, message.dlc
        if place.whole_bytes:
            before = f"data[:{first}] + " if first else ""
            after = f" + data[{first + count}:]" if first + count < length else ""
            yield f'return {before}found.to_bytes({count}, "{place.order.value}"){after}'
        else:
            of_data = f'int.from_bytes(data, "{place.order.value}")'
            yield f'return ({of_data} | {bits.write(place, length)}).to_bytes({length}, "{place.order.value}")'

    def _computed(self, plan: ChecksumPlan, length: int, before: str = "") -> code.Parts:
        """The expression of the checksum of `data` and `can_id`; `before` precedes it on its line."""
        arguments = [f"0x{plan.init:X}", f"0x{plan.xor_out:X}"]
        if plan.arithmetic is not Arithmetic.XOR:
            arguments.insert(0, str(plan.width))
        if plan.arithmetic is Arithmetic.CRC:
            arguments.insert(1, f"0x{plan.poly:X}")
            arguments += [f"shift={plan.shift}"] * bool(plan.shift) + ["reflected=True"] * plan.is_reflected
        make = f"{self.imports.use(f'{plan.arithmetic.value}_of')}({', '.join(arguments)})"
        name = self.functions.setdefault(make, f"_CHECKSUM_{len(self.functions) + 1}")
        first, *more = _inputs(plan, length)
        return code.Parts(f"{before}{name}", (first, *(f"+ {part}" for part in more)))


def _inputs(plan: ChecksumPlan, length: int) -> Iterator[str]:
    """The expressions of the bytes: slices of `data`, and single bytes."""
    for run in plan.runs:
        if isinstance(run, range):
            yield "data" if run == range(length) else f"data[{run.start}:{run.stop}]"
        else:
            yield f"bytes({code.tuple_of(map(_byte, run))})"


def _byte(part: FrameByte | int) -> str:
    if isinstance(part, int):
        return f"0x{part:02X}"
    reads = []
    for s in part.segments:
        source = "can_id" if part.space is Space.ID else f"data[{s.byte}]"
        shift = s.low - s.raw_low
        reads.append(f"{f'{source} >> {shift}' if shift else source} & 0x{(1 << s.width) - 1 << s.raw_low:X}")
    return " | ".join(reads)
