"""What a DBC file does not express of the steps of a message: the guide states it, and conformance counts the cases."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ...model.exhaustive import assert_never
from ...semantics.plan import (
    CheckAvailable,
    CheckChecksum,
    CheckCode,
    CheckConstant,
    CheckField,
    CheckMeaning,
    CheckNode,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    EncodingStep,
    NeedParameter,
    ReadField,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
)

LIMITS: Mapping[str, str] = MappingProxyType(
    {
        "constants": "A DBC does not require the value of a constant, does not ignore reserved bits (an id with reserved bits "
        "is listed as sent), and does not exclude enum values without a name.",
        "confusion": "A file does not reject values with which receivers identify a frame as another message. The other "
        "outputs do (`wrong_message`).",
        "checksums": "A DBC neither computes nor checks a checksum: it is a plain signal, whose comment states the algorithm. "
        "Fill it in yourself before you send, or encode with one of the bindings.",
    }
)
"""The limits of the format that steps exceed, by name."""


def limit(step: DecodingStep | EncodingStep) -> str:
    """The name of the limit that a step exceeds; empty for a step that files express, or that needs no statement in them."""
    match step:
        case CheckConstant() | CheckParameter():
            return "constants"
        case CheckChecksum() | WriteChecksum():
            return "checksums"
        case CheckMeaning():
            return "confusion"
        case CheckAvailable() | CheckCode() | CheckNode() | NeedParameter() | ChooseFields():
            return ""  # there are files, messages and signals for what exists alone
        case ReadField() | CheckField() | WriteField() | WriteFixed() | WriteCode() | WriteParameter():
            return ""  # signals with their limits and start values
        case _:
            assert_never(step)
