"""No values make a frame that receivers identify as another message."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice, product

from ..model.formatting import exact
from ..model.golden_frames import GoldenFrames, RefusedValues
from ..model.layout import Field
from ..model.message import Confusion, Message
from ..model.refusal import Refusal
from ..semantics.confusion import required_bits
from ..semantics.decoder import value_of
from ..semantics.frame import signed
from .rule import CheckInput, Finding, Findings

SHOWN = 3
"""The maximum number of values of one confusion in a finding."""


def check(subject: CheckInput) -> Findings:
    for message in subject.edition.all_messages():
        if message.confusions and not _is_tested(subject.frames, message):
            direction = message.direction.value
            cases = (f"with {' or '.join(_values(message, c))} as `{c.command}`" for c in message.confusions)
            text = f"receivers identify this {direction} with some values as another one: {'; '.join(cases)}"
            entry = (
                f"{{encode: {direction}, command: {message.command}, raw: {{…}}, says: {Refusal.WRONG_MESSAGE.value}}}"
            )
            hint = f"narrow the range of a field, or state it under `refused` of the golden frames: {entry}"
            yield Finding(message.path, text, hint, key=True)


def _is_tested(frames: GoldenFrames | None, message: Message) -> bool:
    """Whether golden frames state that such values are rejected."""
    return frames is not None and any(
        isinstance(entry, RefusedValues)
        and (entry.says, entry.command, entry.encode) == (Refusal.WRONG_MESSAGE, message.command, message.direction)
        for entry in frames.refused
    )


def _values(message: Message, confusion: Confusion) -> Iterator[str]:
    """The values of the fields of a message with which it is another one."""
    cases = product(*(values for _, values in confusion.conditions))
    for values in islice(cases, SHOWN):
        runs = [run for run, _ in confusion.conditions]
        given = required_bits(message, list(zip(runs, values, strict=True)))
        yield ", ".join(_shown(field, mask, raw) for field, mask, raw in given)
    if next(cases, None) is not None:
        yield "…"


def _shown(field: Field, mask: int, raw: int) -> str:
    """A field with its raw integer and its value, or with some bits of it."""
    if mask != (1 << field.type.width) - 1:
        return f"0x{raw:X} in the bits 0x{mask:X} of `{field.name}`"
    value = value_of(field.type, signed(field.type, raw), {})
    return f"`{field.name}` {exact(value)}" if isinstance(value, Fraction) else f"`{field.name}` raw {raw}"
