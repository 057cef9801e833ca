"""Resolver of golden frames: what a file contains, with parameters as the edition types them.

The parts of a frame that the spec determines need not be written: they are completed here, and rules check those written.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

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
    Sourced,
)
from ..model.joined import JoinedText
from ..model.message import Direction, Message
from ..model.types import Assignment, Text
from ..semantics.frame import CanFrame, Raw, node_in_id, raws, sent_id

S = TypeVar("S", bound=Sourced)


def resolve_golden_frames(edition: Edition, written: schema.GoldenFramesSpec) -> GoldenFrames:
    """The golden frames of an edition. Rules check whether they agree with it."""
    return GoldenFrames(
        sources=_sources(written),
        frames=[_frame(edition, frame) for frame in written.frames],
        refused=[
            _resolved(RefusedFrame, edition, entry)
            if isinstance(entry, schema.RefusedFrameSpec)
            else _resolved(RefusedValues, edition, entry, field_name=entry.field)
            for entry in written.refused
        ],
        exchanges=[
            _resolved(
                Exchange,
                edition,
                entry,
                request=CheckedFrame(**vars(entry.request)),
                reply=CheckedFrame(**vars(entry.reply)),
            )
            for entry in written.exchanges
        ],
    )


class MissingPart(NamedTuple):
    """A key of a frame that neither the file nor the spec determines."""

    position: int
    key: str
    text: str


def missing_parts(edition: Edition, written: schema.GoldenFramesSpec) -> Iterator[MissingPart]:
    """Nodes and ids that must be written."""
    for index, frame in enumerate(written.frames):
        message = _message(edition, frame)
        if message is None:
            continue
        header = _header(edition, message, frame)
        nodes = message.id.nodes
        if header.node is None and nodes is not None and frame.id is None:
            yield MissingPart(
                index, "node", f"`node` is missing; the nodes of {message.name} are {nodes[0]}..{nodes[-1]}"
            )
        elif header.id is None and message.id.at(typed_parameters(edition, frame.parameters)) is None:
            text = f"the id of {message.name} depends on `{message.id.parameter}`; add it to `parameters`"
            yield MissingPart(index, "parameters", text)
        elif header.id is None:
            yield MissingPart(index, "id", f"`id` is missing; the id of {message.name} contains a field with a value")


class _Header(NamedTuple):
    """The id of a frame, its format and its node, written or completed; None if they are not determined."""

    id: int | None
    extended: bool
    remote: bool
    node: int | None


def _direction(frame: schema.GoldenFrameSpec) -> Direction:
    return Direction.REQUEST if frame.request else Direction.REPLY


def _command(frame: schema.GoldenFrameSpec) -> str:
    """The command of a frame; empty unless there is exactly one."""
    return "" if frame.request and frame.reply else frame.request or frame.reply or ""


def _message(edition: Edition, frame: schema.GoldenFrameSpec) -> Message | None:
    """The message of a frame; None for an unknown one, which a rule reports."""
    try:
        return edition.command(_command(frame)).message(_direction(frame))
    except KeyError:
        return None


def _header(edition: Edition, message: Message, frame: schema.GoldenFrameSpec) -> _Header:
    assignment = typed_parameters(edition, frame.parameters)
    extended = message.id.extended if frame.extended is None else frame.extended
    remote = message.remote if frame.remote is None else frame.remote
    node, nodes = frame.node, message.id.nodes
    if node is None and nodes is not None and len(nodes) == 1:
        node = nodes[0]
    if nodes is None and message.node_in_data:
        node = None  # the node is a field
    elif node is None and frame.id is not None:
        node = node_in_id(message, CanFrame(frame.id, frame.data), assignment)
    return _Header(sent_id(message, node, assignment) if frame.id is None else frame.id, extended, remote, node)


def _frame(edition: Edition, frame: schema.GoldenFrameSpec) -> GoldenFrame:
    """A frame with the parts that the spec determines."""
    facts: dict[str, Any] = {"direction": _direction(frame), "command": _command(frame)}
    message = _message(edition, frame)
    if message is None:
        header = _Header(frame.id or 0, bool(frame.extended), bool(frame.remote), frame.node)
    else:
        header = _header(edition, message, frame)
        can = CanFrame(header.id or 0, frame.data, header.extended, header.remote)
        facts["raw"] = {**_completed_raws(message, frame, can, edition), **frame.raw, **_node_raw(message, frame)}
    return _resolved(GoldenFrame, edition, frame, **facts, **header._asdict())


def _node_raw(message: Message, frame: schema.GoldenFrameSpec) -> Mapping[str, Raw]:
    """The raw integer of the field that contains the node, if the file states the node."""
    bits = message.node_in_data
    return {} if bits is None or frame.node is None else {bits.name: frame.node}


def _completed_raws(
    message: Message, frame: schema.GoldenFrameSpec, can: CanFrame, edition: Edition
) -> Mapping[str, Raw]:
    """The raw integers in the frame of fields that are not in `raw`: those with a value or a name, and the node."""
    variant = message.layout.variant(typed_parameters(edition, frame.parameters))
    if variant is None:
        return {}
    nodes = {field.name for field in variant.fields if field.is_node}
    return {name: raw for name, raw in raws(variant, can).items() if name in frame.values or name in nodes}


def _resolved(kind: type[S], edition: Edition, entry: schema.SourcedSpec, **differing: Any) -> S:
    """An entry of the model: what is written under the same names, and what is `differing`."""
    parameters = typed_parameters(edition, entry.parameters)
    facts = {
        **vars(entry),
        "source": entry.source or "",
        "note": _texts(entry.note or {}),
        "parameters": parameters,
        **differing,
    }
    if "values" in facts:
        facts["values"] = _texts_of(edition, facts)
    return kind(**{field.name: facts[field.name] for field in dataclasses.fields(kind)})


def _texts_of(edition: Edition, facts: Mapping[str, Any]) -> Mapping[str, Any]:
    """The values, in which a text in quotes that looks like a number is a text where the field has one."""
    try:
        message = edition.command(facts["command"]).message(facts.get("direction") or facts["encode"])
    except KeyError:
        message = None
    fields = message.layout.fields if message else ()
    texts = {field.name for field in fields if isinstance(field.type.joined, JoinedText)}
    return {
        name: value.text if name in texts and isinstance(value, notation.QuotedNumber) else value
        for name, value in facts["values"].items()
    }


def typed_parameters(edition: Edition, written: Mapping[str, int | str]) -> Assignment:
    """Parameters with numbers as fractions and choices by name; an invalid number stays a text, which a rule reports."""
    numbers = {parameter.name for parameter in edition.parameters if not parameter.is_choice}
    return {name: _number(value) if name in numbers else str(value) for name, value in written.items()}


def _number(value: int | str) -> Fraction | str:
    try:
        return notation.rational(str(value))
    except ValueError:
        return str(value)


def _texts(text: WrittenText) -> Text:
    """A text in each language; a plain text is in English."""
    return {"en": text} if isinstance(text, str) else {str(language): said for language, said in text.items()}


def _sources(written: schema.GoldenFramesSpec) -> Mapping[str, Text | str]:
    """The texts of the sources; a plain text is for all languages."""
    return {name: text if isinstance(text, str) else _texts(text) for name, text in written.sources.items()}
