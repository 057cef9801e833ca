"""A variable of a node that requests write is read by a reply, and all its fields have one unit and one kind of values."""

from __future__ import annotations

from ..diagnostics.diagnostic import near
from ..model.layout import Field
from ..model.message import Direction
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    written: dict[str, Field] = {}
    read: dict[str, Field] = {}
    for message in subject.edition.all_messages():
        for field in message.layout.fields:
            if field.variable is not None and not field.is_given:
                text = f"`{field.name}` is no value, so it neither reads nor writes a variable"
                yield Finding((*field.path, "variable"), text, "remove `variable`")
            elif message.direction is Direction.REPLY:
                read.setdefault(field.variable or field.name, field)
            elif field.variable is not None:
                written.setdefault(field.variable, field)
    for name, field in written.items():
        path = (*field.path, "variable")
        if name not in read:
            likely = near(name, read)
            hint = f"did you mean `{likely}`?" if likely else "write `variable` in a reply, too, or remove it here"
            yield Finding(path, f"no reply reads `{name}`", hint)
        elif _kind(field) != _kind(read[name]):
            text = f"`{name}` is {_kind(field)} here, and {_kind(read[name])} where `{read[name].name}` reads it"
            hint = "write another name if these are two variables"
            yield Finding(path, text, hint, related=(RelatedItem(read[name].path, read[name].name, key=True),))


def _kind(field: Field) -> str:
    """What the values of a variable are, for people."""
    if field.type.enum or field.type.flags:
        return "an enum" if field.type.enum else "flags"
    return f"a number in {field.type.unit}" if field.type.unit else "a plain number"
