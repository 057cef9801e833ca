"""A frame in the notation of golden frames, for review."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ..document import ambiguous
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Message
from ..model.types import Assignment, Parameter
from ..semantics.decoder import Decoder, Rejection, Value
from ..semantics.encoder import Encoder
from ..semantics.frame import CanFrame
from .rows import needed

UNVERIFIED = "unverified"
"""The source that is printed; it is rejected until someone names the source of the bytes and values."""
_WIDTH = 120


def golden_text(edition: Edition, message: Message, frame: CanFrame, assignment: Assignment) -> str | None:
    """An entry of `frames`; None if the frame is not decoded under these parameters."""
    decoded = Decoder(edition).decode_as(message, frame, assignment)
    if isinstance(decoded, Rejection):
        return None
    parts = [
        f"{message.direction.value}: {_text(message.command)}",
        *([f"node: {decoded.node}"] if decoded.node is not None else []),
        f"id: 0x{frame.id:X}",
        *(["extended: true"] if frame.extended else []),
        *(["remote: true"] if frame.remote else []),
        f'data: "{frame.data.hex(" ").upper()}"',
    ]
    values = {
        field.name: _value(decoded.values[field.name])
        for field in decoded.variant.fields
        if field.role.is_value and all(name in assignment for name in needed(field.type, assignment))
    }
    values = {name: text for name, text in values.items() if len(text) <= _WIDTH}  # the language rejects longer numbers
    raws = {name: str(raw) for name, raw in decoded.raws.items()}
    used = {
        name: _parameter(edition.parameter(name), formatting.parameter_value(assignment[name]))
        for name in _used(message, assignment)
    }
    parts += [
        f"{key}: {_mapping(one)}" for key, one in (("parameters", used), ("raw", raws), ("values", values)) if one
    ]
    if Encoder(assignment).encode_raws(message, decoded.node, decoded.raws) != frame:
        parts.append("decode_only: true")
    return _wrapped([*parts, f"source: {UNVERIFIED}"])


def _used(message: Message, assignment: Assignment) -> Iterator[str]:
    """The given parameters that the message depends on."""
    numbers = (name for field in message.layout.fields for name in field.type.numbers)
    return (name for name in dict.fromkeys((*message.layout.parameters, *numbers)) if name in assignment)


def _mapping(items: Mapping[str, str]) -> str:
    return f"{{{', '.join(f'{_text(name)}: {item}' for name, item in items.items())}}}"


def _value(value: Value | list[Value]) -> str:
    """A value: a number, a name, a list of them, or `none`."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, Fraction):
        return formatting.exact(value)
    return "none" if value is None else _text(value)


def _parameter(parameter: Parameter, value: str) -> str:
    return _text(value) if parameter.is_choice and not parameter.is_numeric else value


def _text(text: str) -> str:
    """A text as a YAML scalar, in quotes if it may be read as something else."""
    return json.dumps(text) if ambiguous.ambiguity(text) or not text.isidentifier() else text


def _wrapped(parts: Sequence[str]) -> str:
    """An item of a list, in lines of at most 120 characters; a part that is longer is broken between its items."""
    lines = ["  - {"]
    for i, part in enumerate(parts):
        whole = part + ("}" if i + 1 == len(parts) else ",")
        pieces = [whole] if len(whole) < _WIDTH - 5 else re.split("(?<=,) ", whole)
        for piece in pieces:
            if len(lines[-1]) + len(piece) + 1 > _WIDTH:
                lines.append("    ")
            lines[-1] += piece if lines[-1].endswith("{") else f" {piece}"
    return "\n".join(lines) + "\n"
