"""The field that contains the node is an unsigned number without a scale, and always exists."""

from __future__ import annotations

from ..model.layout import Field, NodeRole
from ..model.types import Encoding
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for message in subject.edition.all_messages():
        fields = [f for f in message.layout.fields if f.is_node]
        for i, field in enumerate(fields):
            reason = f"`{fields[0].name}` already contains the node" if i else _mismatch(field)
            if reason:
                yield Finding(
                    (*field.path, NodeRole.key),
                    reason,
                    "mark one field that is an unsigned number without a scale",
                    key=True,
                )


def _mismatch(field: Field) -> str:
    if field.is_array or field.only:
        return f"`{field.name}` cannot contain the node: it is an array, or depends on a parameter"
    if not field.type.is_plain or field.type.no_values or field.type.encoding is not Encoding.UNSIGNED:
        return f"`{field.name}` cannot contain the node: it is not an unsigned number without a scale"
    return ""
