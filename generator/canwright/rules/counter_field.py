"""A counter is an unsigned number without a type, and no array."""

from __future__ import annotations

from ..model.layout import CounterRole, Field
from ..model.types import Encoding
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    fields = {field.path: field for message in subject.edition.all_messages() for field in message.layout.fields}
    for path, field in fields.items():
        problem = _problem(field) if field.counter else ""
        if problem:
            yield Finding((*path, CounterRole.key), f"`{field.name}` cannot be a counter: {problem}", HINT, key=True)


HINT = "write, for example, raw: u4, counter: 0..14"


def _problem(field: Field) -> str:
    type_ = field.type
    if type_.path[0] == "types" or field.is_array:
        return "it has a type" if type_.path[0] == "types" else "it is an array"
    return "it is not unsigned" if type_.encoding is not Encoding.UNSIGNED else ""
