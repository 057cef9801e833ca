"""Raw integers and frames to try: boundary values, and frames that reach each decision of the other edition."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from ...model.layout import Field, NodeRole, Segment, Space
from ...model.message import BitRun, Direction, Message
from ...model.types import Assignment, Bound, Encoding, Type, number_of
from ...semantics.bits import data_bits
from ...semantics.decoder import Decoder, Identified
from ...semantics.dispatch import DispatchNode, Length, MaskedId, Select
from ...semantics.encoder import Encoder
from ...semantics.frame import CanFrame, Raw, read_bits

MAX_FRAMES = 64
"""So many frames of one message are tried for the decisions of the other edition."""
MAX_MEMBERS = 256
"""So many members of an enum are tried; of two editions, those that differ come first."""


def raws(encoder: Encoder, field: Field, counterpart: Field) -> Iterator[int]:
    """Raw integers that a field can be sent with, ends of ranges and members in both editions among them."""
    demanded = () if not counterpart.role.is_checked else (counterpart.role.required_raw,)
    for raw in dict.fromkeys((*_raws(field.type, counterpart.type, encoder.assignment), *demanded)):
        if _allows(encoder, field, raw):
            yield raw


def raws_of_each_bit(encoder: Encoder, field: Field) -> Iterator[int]:
    """As `raws`, with each bit alone, too."""
    yield from raws(encoder, field, field)
    if field.type.is_number:
        yield from (raw for raw in (1 << bit for bit in range(field.type.width)) if _allows(encoder, field, raw))


def _raws(source: Type, target: Type, assignment: Assignment) -> Iterator[int]:
    if source.enum or source.flags:
        named = {m.value for t in (source, target) for m in (t.enum or t.flags)}
        differing = {(m.name, m.value) for m in source.enum or source.flags} ^ {
            (m.name, m.value) for m in target.enum or target.flags
        }
        first = sorted(value for _, value in differing)
        values = list(dict.fromkeys((*first, *sorted(named))))[:MAX_MEMBERS]
        yield from (values if source.enum else (1 << value for value in values if 0 <= value < source.width))
        if source.flags:
            yield from (0, sum(1 << m.value for m in source.flags))
        return
    if source.encoding is Encoding.FLOAT:
        yield from ({32: (0x3F800000, 0xC2C80000, 0), 64: (0x3FF << 52, 0xC059 << 48, 0)}[source.width])
    yield from (1, 100, -1, 0)
    for type_ in (source, target):
        span = type_.raw_range.at(assignment)
        for end in (span.low, span.high) if span else ():
            at = end_of(end, assignment)
            if at is not None:
                yield from (math.floor(at), math.ceil(at), math.floor(at) - 1, math.ceil(at) + 1)
        yield from type_.raw_limits
        yield from (m.value for m in type_.enum)
        yield from (1 << m.value for m in type_.flags)


def end_of(bound: Bound, assignment: Assignment) -> Fraction | None:
    """The end of a range under some parameters; None if it depends on another one."""
    number = number_of(assignment, bound.parameter)
    return bound.at({} if number is None else {bound.parameter or "": number})


def base_raws(encoder: Encoder, message: Message, node: int | None) -> dict[str, Raw] | None:
    """A raw integer for each field of a message; None if its fields are unknown or one has no allowed value."""
    fields = encoder.fields(message)
    if fields is None:
        return None
    chosen: dict[str, Raw] = {}
    for name, field in fields.items():
        first = (node or 0) & (1 << field.type.width) - 1 if isinstance(field.role, NodeRole) else 0
        raw = first if _allows(encoder, field, first) else next(raws(encoder, field, field), None)
        if raw is None:
            return None
        chosen[name] = [raw] * len(field.elements) if field.is_array else raw
    return chosen


def _allows(encoder: Encoder, field: Field, raw: int) -> bool:
    return encoder.rejects_raw(field, [raw] * len(field.elements) if field.is_array else raw) is None


def variable_bits(encoder: Encoder, message: Message) -> int:
    """The data bits of the fields of a message whose values the sender chooses, as a mask."""
    fields = (encoder.fields(message) or {}).values()
    return data_bits((f.space, e.segments) for f in fields for e in f.elements)


def reaching(decoder: Decoder, direction: Direction, frame: CanFrame, variable: int) -> Iterator[CanFrame]:
    """Frames as this one, with other values in `variable` data bits, for each decision on them; at most `MAX_FRAMES`."""
    node = decoder.decisions(direction, frame)
    if node is None or frame.remote:
        yield frame
        return
    size = len(frame.data)
    left = MAX_FRAMES
    for data in _data(node, frame, int.from_bytes(frame.data, "little"), variable):
        yield CanFrame(frame.id, data.to_bytes(size, "little"), frame.extended)
        left -= 1
        if not left:
            return


def _data(node: DispatchNode, frame: CanFrame, data: int, variable: int) -> Iterator[int]:
    """The data of a frame for each leaf that the variable bits can reach."""
    while isinstance(node, Select):
        subject = node.subject
        if isinstance(subject, Length):
            node = node.by_value.get(len(frame.data), node.otherwise)
        elif isinstance(subject, MaskedId):
            node = node.by_value.get(frame.id & subject.mask, node.otherwise)
        else:
            now = CanFrame(frame.id, data.to_bytes(len(frame.data), "little"), frame.extended)
            mask = data_bits([(subject.space, subject.segments)]) & ((1 << len(frame.data) * 8) - 1)
            if mask & variable:
                yield from _choices(node, subject, frame, data, variable, mask)
                return
            node = node.by_value.get(read_bits(subject, now), node.otherwise)
    yield data


def _choices(select: Select, subject: BitRun, frame: CanFrame, data: int, variable: int, mask: int) -> Iterator[int]:
    now = CanFrame(frame.id, data.to_bytes(len(frame.data), "little"), frame.extended)
    current = read_bits(subject, now)
    unlisted = next((v for v in (current, 0, 1, (1 << subject.width) - 1, 85) if v not in select.by_value), current)
    for value in dict.fromkeys((current, unlisted, *select.by_value)):
        changed = data & ~mask | placed(subject.segments, value)
        if changed.bit_length() <= len(frame.data) * 8 and not (changed ^ data) & ~variable:
            known = select.by_value.get(value)
            if known is not None:
                yield from _data(known, frame, changed, variable & ~mask)
            else:  # later decisions can be on the same bits
                yield from _data(select.otherwise, frame, changed, variable)


def placed(segments: tuple[Segment, ...], value: int) -> int:
    """The data with a value in some bits and 0 in all others, as a little-endian integer."""
    return sum((value >> s.raw_low & (1 << s.width) - 1) << s.low + s.byte * 8 for s in segments)


def with_first_key(message: Message, frame: CanFrame, value: int) -> CanFrame:
    """A frame of a message with another value of its first key."""
    key = message.keys[0]
    if key.space is Space.ID:
        mask = sum(((1 << s.width) - 1) << s.low for s in key.segments)
        return CanFrame(frame.id & ~mask | placed(key.segments, value), frame.data, frame.extended, frame.remote)
    data = int.from_bytes(frame.data, "little") & ~data_bits([(key.space, key.segments)])
    changed = (data | placed(key.segments, value)).to_bytes(len(frame.data), "little")
    return CanFrame(frame.id, changed, frame.extended, frame.remote)


def message_of(decoder: Decoder, direction: Direction, frame: CanFrame) -> Message | None:
    """The message that a frame is; None if it is rejected."""
    result = decoder.identify(direction, frame)
    return result.message if isinstance(result, Identified) else None
