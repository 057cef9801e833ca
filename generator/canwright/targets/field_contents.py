"""What pages, the tables of hand-over, comments in DBC files and `canwright show` state of the steps of a message."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from ..model import formatting
from ..model.exhaustive import assert_never
from ..model.layout import Field
from ..model.message import Message
from ..semantics.plan import (
    CheckAvailable,
    CheckChecksum,
    CheckCode,
    CheckConstant,
    CheckField,
    CheckMeaning,
    CheckNode,
    CheckParameter,
    ChooseFields,
    NeedParameter,
    ReadField,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
    message_plan,
)


class Content(NamedTuple):
    """What a field that users do not give contains: a raw integer, the value of a parameter, or a checksum."""

    written: int | str
    kind: Literal["constant", "checksum", "reserved"]
    """Receivers require a constant or a checksum, and ignore what is reserved."""


def contents(message: Message) -> Mapping[Field, Content]:
    """The contents of the fields that users do not give: all that is stated of the steps that check or write these."""
    plan = message_plan(message)
    stated: dict[Field, Content] = {}
    for step in (*plan.encoding, *plan.decoding):
        match step:
            case WriteFixed():
                if step.field:
                    stated[step.field] = Content(step.raw, "reserved")
            case CheckConstant():
                stated[step.field] = Content(step.raw, "constant")
            case CheckParameter():
                stated[step.field] = Content(step.parameter, "constant")
            case CheckChecksum():
                stated[step.field] = Content(formatting.checksum(step.role), "checksum")
            case WriteParameter() | WriteChecksum():
                pass  # every receiver checks these
            case CheckAvailable() | CheckCode() | CheckNode() | NeedParameter() | ChooseFields() | WriteCode():
                pass  # facts of the message, rows of its keys, conditions of fields
            case CheckField() | ReadField() | WriteField():
                pass  # rows of the fields that users give, with their ranges
            case CheckMeaning():
                pass  # the rows of the other message have its values
            case _:
                assert_never(step)
    return stated
