"""Resolver of golden frames: what a file contains, with parameters as the edition types them."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TypedDict

from ..language import golden_frames as schema, notation
from ..language.scalar_types import Text as WrittenText
from ..model.edition import Edition
from ..model.golden_frames import (
    CheckedFrame,
    Exchange,
    GoldenFrame,
    GoldenFrames,
    RefusedFrame,
    RefusedValues,
)
from ..model.message import Direction
from ..model.types import Assignment, Text


class _Source(TypedDict):
    source: str
    manual: str
    note: Text
    parameters: Assignment


class _Bits(TypedDict):
    id: int
    extended: bool
    remote: bool
    data: bytes


def resolve_golden_frames(edition: Edition, written: schema.GoldenFramesSpec) -> GoldenFrames:
    """The golden frames of an edition. Rules check whether they agree with it."""
    return GoldenFrames(
        sources=_sources(written),
        frames=[_frame(edition, frame) for frame in written.frames],
        refused=[
            _refused_frame(edition, entry)
            if isinstance(entry, schema.RefusedFrameSpec)
            else _refused_values(edition, entry)
            for entry in written.refused
        ],
        exchanges=[
            Exchange(
                **_source(edition, entry),
                request=CheckedFrame(**_bits(entry.request)),
                reply=CheckedFrame(**_bits(entry.reply)),
                says=entry.says,
            )
            for entry in written.exchanges
        ],
    )


def typed_parameters(edition: Edition, written: Mapping[str, int | str]) -> Assignment:
    """Parameters with numbers as fractions and choices by name; an invalid number stays a text, which a rule reports."""
    numbers = {parameter.name for parameter in edition.parameters if not parameter.is_choice}
    return {name: _number(value) if name in numbers else str(value) for name, value in written.items()}


def _number(value: int | str) -> Fraction | str:
    try:
        return notation.rational(str(value))
    except ValueError:
        return str(value)


def _source(edition: Edition, entry: schema.SourcedSpec) -> _Source:
    return {
        "source": entry.source,
        "manual": entry.manual,
        "note": _texts(entry.note or {}),
        "parameters": typed_parameters(edition, entry.parameters),
    }


def _bits(frame: schema.GoldenFrameSpec | schema.RefusedFrameSpec | schema.CheckedFrameSpec) -> _Bits:
    return {"id": frame.id, "extended": frame.extended, "remote": frame.remote, "data": frame.data}


def _frame(edition: Edition, frame: schema.GoldenFrameSpec) -> GoldenFrame:
    return GoldenFrame(
        **_source(edition, frame),
        **_bits(frame),
        direction=Direction.REQUEST if frame.request else Direction.REPLY,
        command="" if frame.request and frame.reply else frame.request or frame.reply or "",
        node=frame.node,
        raw=frame.raw,
        values=frame.values,
        decode_only=frame.decode_only,
    )


def _refused_frame(edition: Edition, entry: schema.RefusedFrameSpec) -> RefusedFrame:
    return RefusedFrame(**_source(edition, entry), **_bits(entry), decode=entry.decode, says=entry.says)


def _refused_values(edition: Edition, entry: schema.RefusedValuesSpec) -> RefusedValues:
    return RefusedValues(
        **_source(edition, entry),
        encode=entry.encode,
        command=entry.command,
        node=entry.node,
        raw=entry.raw,
        values=entry.values,
        says=entry.says,
        field_name=entry.field,
    )


def _texts(text: WrittenText) -> Text:
    """A text in each language; a plain text is in English."""
    return {"en": text} if isinstance(text, str) else {str(language): said for language, said in text.items()}


def _sources(written: schema.GoldenFramesSpec) -> Mapping[str, Text | str]:
    """The texts of the sources; a plain text is for all languages."""
    return {name: text if isinstance(text, str) else _texts(text) for name, text in written.sources.items()}
