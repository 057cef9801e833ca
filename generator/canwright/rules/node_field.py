"""The field that holds the node is one bare number, and always there."""

from __future__ import annotations

from ..model.layout import Field, NodeRole
from ..model.types import Encoding
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    for message in subject.edition.all_messages():
        found = [f for f in message.layout.fields if isinstance(f.role, NodeRole)]
        for i, field in enumerate(found):
            reason = f"`{found[0].name}` holds the node already" if i else _unfit(field)
            if reason:
                yield Finding((*field.path, "holds"), reason, "mark one unsigned number without scale", key=True)


def _unfit(field: Field) -> str:
    if field.is_array or field.only:
        return f"`{field.name}` holds no node that can be compared: it is an array, or not always there"
    if not field.type.is_plain or field.type.encoding is not Encoding.UNSIGNED:
        return f"`{field.name}` holds no node: it is no unsigned number without a scale"
    return ""
