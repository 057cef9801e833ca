"""Entries in the notation of golden frames: frames of a log, for review, and skeletons without bytes, to fill in.

No bytes are printed that were not recorded: the bytes of a golden frame are evidence only if the spec did not make them.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ..diagnostics.unicode_safety import visible
from ..document import ambiguous
from ..language.notation import BLANK
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Message
from ..model.types import Assignment, Parameter
from ..semantics.decoder import Decoded, Decoder, Rejection, Value
from ..semantics.encoder import Encoder
from ..semantics.frame import CanFrame, Raw, sent_id
from ..semantics.valid_raws import FlagBits, NamedRaws, RawInterval, end_of, valid_raws, width_limits
from .rows import needed

_WIDTH = 120


def golden_text(
    edition: Edition, message: Message, frame: CanFrame, assignment: Assignment, *, has_values: bool = True
) -> str | None:
    """An entry of `frames` without a source; None if the frame is not decoded under these parameters.

    Without values, a comment before the entry has those of the spec.
    """
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
    raws = {name: str(raw) for name, raw in decoded.raws.items()}
    values = _values(decoded, assignment)
    parts += _facts(edition, message, assignment, *((raws, values) if has_values else ({}, {})))
    encoder = Encoder(assignment)
    is_sent = encoder.encode_raws(message, decoded.node, decoded.raws, decoded.code) == frame
    if not is_sent or _is_written_otherwise(decoded, encoder):
        parts.append("decode_only: true")
    comment = visible(f"raw: {_mapping(raws)}, values: {_mapping(values)}")
    return _wrapped(parts) if has_values or not raws else f"  # by the spec: {comment}\n{_wrapped(parts)}"


def _is_written_otherwise(decoded: Decoded, encoder: Encoder) -> bool:
    """Whether a text or a name is sent as other raw integers: bytes follow the end of a text, or a name has a range of them."""
    for field in (field for field in decoded.variant.fields if field.name in decoded.values):
        value, raw = decoded.values[field.name], decoded.raws[field.name]
        if isinstance(value, str) and encoder.field_raw(field, value) != raw:
            return True
        elements = zip(value, raw, strict=True) if isinstance(value, list) and isinstance(raw, list) else ()
        if any(isinstance(name, str) and encoder.nearest_raw(field, name) != there for name, there in elements):
            return True
    return False


def skeleton_text(edition: Edition, message: Message, assignment: Assignment, source: str) -> str | None:
    """An entry of `frames` with values at the ends of their ranges, and blanks for its bytes.

    None if the fields depend on a parameter that is not given.
    """
    encoder = Encoder(assignment)
    fields = encoder.fields(message)
    if fields is None:
        return None
    node = _example_node(message)
    raws: dict[str, Raw] = {}
    for name, field in fields.items():
        raw = (node or 0) if field.is_node else end_raw(encoder, field)
        raws[name] = [raw] * len(field.elements) if field.is_array else raw
    sent = encoder.encode_raws(message, node, raws)
    decoded = Decoder(edition).decode_as(message, sent, assignment) if isinstance(sent, CanFrame) else sent
    values = {} if isinstance(decoded, Rejection) else _values(decoded, assignment)
    own = [name for name, field in fields.items() if not field.is_node]
    rest = {name: str(raws[name]) for name in own if values.get(name) in (None, "none")}
    return _wrapped(
        [
            f"{message.direction.value}: {_text(message.command)}",
            *([f"node: {node}"] if node is not None else []),
            *([f"id: {BLANK}"] if sent_id(message, node) is None else []),
            f'data: "{" ".join([BLANK] * message.length)}"',
            *_facts(edition, message, assignment, rest, {name: values[name] for name in own if name not in rest}),
            f"source: {_text(source)}",
        ]
    )


def _example_node(message: Message) -> int | None:
    """The lowest node of a message above 0; None without one."""
    nodes = message.id.nodes
    if nodes is None:
        return 1 if message.node_in_data else None
    return next((node for node in nodes if node), nodes[0])


def end_raw(encoder: Encoder, field: Field) -> int:
    """The raw integer at an end of the range of a field: the lowest below 0, or the highest."""
    valid = valid_raws(field.type).at(encoder.assignment) or width_limits(field.type)
    if isinstance(valid, NamedRaws):
        return valid.values[-1]
    if isinstance(valid, FlagBits):
        return 1 << valid.mask.bit_length() - 1
    if isinstance(valid, RawInterval):
        low_end, high_end = (
            end_of(bound, encoder.assignment) if bound else None for bound in (valid.low_bound, valid.high_bound)
        )
        low = valid.low if low_end is None else max(valid.low, math.ceil(low_end))
        high = valid.high if high_end is None else min(valid.high, math.floor(high_end))
        raw: int | Rejection = low if low < 0 else high
    else:
        end = end_of(valid.scaled.low, encoder.assignment) if valid.scaled else None
        raw = encoder.nearest_raw(field, _EXAMPLE_FLOAT if end is None else end)
    return 0 if isinstance(raw, Rejection) or encoder.rejects_raw(field, raw) else raw


_EXAMPLE_FLOAT = Fraction(-3, 2)
"""The value of a float without a range."""


def _values(decoded: Decoded, assignment: Assignment) -> dict[str, str]:
    """The values of a frame that the parameters suffice for."""
    values = {
        field.name: _value(decoded.values[field.name])
        for field in decoded.variant.fields
        if field.is_given
        and (
            isinstance(decoded.values.get(field.name), str)
            or all(name in assignment for name in needed(field.type, assignment))
        )
    }
    return {name: text for name, text in values.items() if len(text) <= _WIDTH}  # the language rejects longer numbers


def _facts(
    edition: Edition, message: Message, assignment: Assignment, raws: Mapping[str, str], values: Mapping[str, str]
) -> list[str]:
    """The keys of an entry after its bytes."""
    used = {
        name: _parameter(edition.parameter(name), formatting.parameter_value(assignment[name]))
        for name in _used(edition, message, assignment)
    }
    keys = (("parameters", used), ("raw", raws), ("values", values))
    return [f"{key}: {_mapping(items)}" for key, items in keys if items]


def _used(edition: Edition, message: Message, assignment: Assignment) -> Iterator[str]:
    """The given parameters that the message depends on, and those in ids and constants."""
    numbers = (name for field in message.layout.fields for name in field.type.numbers)
    in_ids = (parameter.name for parameter in edition.parameters if parameter.whole)
    return (name for name in dict.fromkeys((*message.layout.parameters, *numbers, *in_ids)) if name in assignment)


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


_LAST_ESCAPED = 0xFFFF
"""The last character that one escape of JSON stands for; YAML has another one for those beyond."""


def _text(text: str) -> str:
    """A text as a YAML scalar, in quotes if it may be read as something else."""
    return (
        json.dumps(text, ensure_ascii=max(map(ord, text), default=0) <= _LAST_ESCAPED)
        if ambiguous.ambiguity(text) or not text.isidentifier()
        else text
    )


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
