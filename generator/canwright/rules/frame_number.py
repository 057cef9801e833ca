"""The field with the number of a frame, in a reply of several frames, is an unsigned number that can have each value."""

from __future__ import annotations

from ..model.layout import Field
from ..model.types import Encoding
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for message in subject.edition.all_messages():
        if message.sequence is not None:
            name, last = message.sequence.field, message.sequence.numbers[-1]
            field = next((f for f in message.layout.fields if f.name == name), None)
            reason = _mismatch(name, field, last)
            if reason:
                hint = "name a field of the reply that is an unsigned number without a scale"
                yield Finding((*message.path, "frames", name), reason, hint, key=True)


def _mismatch(name: str, field: Field | None, last: int) -> str:
    if field is None:
        return f"the reply has no field `{name}`"
    if field.is_array or field.only or not field.is_given:
        return f"`{name}` cannot contain the number of the frame: it is no single value that each frame has"
    if not field.type.is_plain or field.type.encoding is not Encoding.UNSIGNED:
        return f"`{name}` cannot contain the number of the frame: it is not an unsigned number without a scale"
    if last >> field.type.width:
        return f"the last number {last} exceeds {(1 << field.type.width) - 1}, the maximum of `{name}`"
    return ""
