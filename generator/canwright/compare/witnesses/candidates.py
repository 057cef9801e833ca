"""Raw integers and frames to try: boundary values, and frames that reach each decision of the other edition."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping

from ...model.joined import JoinedText
from ...model.layout import Field, Space
from ...model.message import BitRun, Direction, Message
from ...model.types import Assignment, Encoding, Type
from ...semantics.bits import data_bits, placed
from ...semantics.decoder import Decoder, Identified, Rejection, subject_value
from ...semantics.dispatch import DispatchNode, Select
from ...semantics.encoder import Encoder
from ...semantics.frame import CanFrame, Raw, read_bits, required_raw
from ...semantics.valid_raws import end_of

MAX_FRAMES = 64
"""So many frames of one message are tried for the decisions of the other edition."""
MAX_FIELDS = 4
"""So many fields of a message are varied and shown."""
MAX_MEMBERS = 256
"""So many members of an enum are tried; of two editions, those that differ come first."""


def raws(encoder: Encoder, field: Field, counterpart: Field) -> Iterator[int]:
    """Raw integers that a field can be sent with, ends of ranges and members in both editions among them."""
    required = required_raw(counterpart)
    demanded = () if required is None else (required,)
    ends = _float_ends(encoder, field, counterpart)
    for raw in dict.fromkeys((*_raws(field.type, counterpart.type, encoder.assignment), *ends, *demanded)):
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
    yield from (t.joined.padding for t in (source, target) if isinstance(t.joined, JoinedText))
    for type_ in (source, target):
        span = type_.raw_range.at(assignment)
        for end in (span.low, span.high) if span else ():
            at = end_of(end, assignment)
            if at is not None:
                yield from (math.floor(at), math.ceil(at), math.floor(at) - 1, math.ceil(at) + 1)
        yield from (*type_.raw_limits, *type_.number_limits)
        yield from (raw for no_value in type_.no_values for raw in (no_value.raws[0], no_value.raws[-1]))
        yield from (m.value for m in type_.enum)
        yield from (1 << m.value for m in type_.flags)


def _float_ends(encoder: Encoder, field: Field, counterpart: Field) -> Iterator[int]:
    """The bit patterns of both ends of the ranges of floats, and of the floats beside these."""
    for type_ in (field.type, counterpart.type) if field.type.encoding is Encoding.FLOAT else ():
        span = type_.raw_range.at(encoder.assignment) if type_.encoding is Encoding.FLOAT else None
        for end in (span.low, span.high) if span else ():
            at = end_of(end, encoder.assignment)
            raw = None if at is None else encoder.nearest_raw(field, at)
            if isinstance(raw, int):
                yield from (raw, raw - 1, raw + 1)


def _allows(encoder: Encoder, field: Field, raw: int) -> bool:
    return encoder.rejects_raw(field, [raw] * len(field.elements) if field.is_array else raw) is None


class Sender:
    """Encodes a message of a node under some parameters.

    `base` has a raw integer for each field; None if the fields are unknown or one has no allowed value.
    """

    def __init__(self, encoder: Encoder, message: Message, node: int | None) -> None:
        self.encoder, self.message, self.node = encoder, message, node
        self.fields = encoder.fields(message) or {}
        self.base = None if encoder.fields(message) is None else self._base()

    def _base(self) -> Mapping[str, Raw] | None:
        chosen: dict[str, Raw] = {}
        for name, field in self.fields.items():
            first = (self.node or 0) & (1 << field.type.width) - 1 if field.is_node else 0
            raw = first if _allows(self.encoder, field, first) else next(raws(self.encoder, field, field), None)
            if raw is None:
                return None
            chosen[name] = [raw] * len(field.elements) if field.is_array else raw
        return chosen

    def encode(self, raws: Mapping[str, Raw] | None) -> CanFrame | None:
        """The frame with these raw integers; None if it cannot be sent."""
        if raws is None:
            return None
        frame = self.encoder.encode_raws(self.message, self.node if self.message.id.nodes else None, raws)
        return frame if isinstance(frame, CanFrame) else None

    def sends(self, decoder: Decoder, frame: CanFrame) -> bool:
        """Whether a frame, as its own edition decodes it, is one that is sent."""
        decoded = decoder.decode_as(self.message, frame, self.encoder.assignment)
        return not isinstance(decoded, Rejection) and self.encode(decoded.raws) == frame

    def samples(self) -> Iterator[CanFrame]:
        """A frame, and further ones with other values in the fields in the id."""
        in_id = (field for field in self.fields.values() if field.space is Space.ID and not field.is_array)
        return self._with({field: raws(self.encoder, field, field) for field in in_id})

    def variations(self) -> Iterator[CanFrame]:
        """A frame, and further ones with another value in one of the first fields."""
        varied = (f for f in first_fields(self.encoder, self.message) if not f.is_array and not f.is_node)
        return self._with({f: itertools.islice(self._other_raws(f), 1) for f in varied})

    def _other_raws(self, field: Field) -> Iterator[int]:
        return (raw for raw in raws(self.encoder, field, field) if self.base and raw != self.base[field.name])

    def _with(self, varied: Mapping[Field, Iterable[int]]) -> Iterator[CanFrame]:
        """The frame with the base alone, then with each raw integer of some fields."""
        if self.base is not None:
            changed = ({**self.base, field.name: raw} for field, raws_of in varied.items() for raw in raws_of)
            yield from filter(None, map(self.encode, (self.base, *changed)))

    @property
    def variable_bits(self) -> int:
        """The data bits of the fields whose values the sender chooses, as a mask."""
        return data_bits((f.space, e.segments) for f in self.fields.values() for e in f.elements)


def first_fields(encoder: Encoder, message: Message) -> list[Field]:
    """The fields of a message that are varied and shown: the first ones, by their bits."""
    fields = (encoder.fields(message) or {}).values()
    return sorted(fields, key=lambda field: (field.space, field.elements[0].bits))[:MAX_FIELDS]


def reaching(decoder: Decoder, direction: Direction, frame: CanFrame, variable: int) -> Iterator[CanFrame]:
    """Frames as this one, with other values in `variable` data bits, for each decision on them; at most `MAX_FRAMES`."""
    node = decoder.decisions(direction, frame)
    if node is None or frame.remote:
        yield frame
        return
    yield from itertools.islice(_leaves(node, frame, variable), MAX_FRAMES)


def _leaves(node: DispatchNode, frame: CanFrame, variable: int) -> Iterator[CanFrame]:
    """A frame for each leaf that the variable bits can reach."""
    while isinstance(node, Select):
        subject = node.subject
        if isinstance(subject, BitRun):
            mask = data_bits([(subject.space, subject.segments)]) & (1 << len(frame.data) * 8) - 1
            if mask & variable:
                yield from _choices(node, subject, frame, variable, mask)
                return
        node = node.by_value.get(subject_value(subject, frame), node.otherwise)
    yield frame


def _choices(select: Select, subject: BitRun, frame: CanFrame, variable: int, mask: int) -> Iterator[CanFrame]:
    data, current = int.from_bytes(frame.data, "little"), read_bits(subject, frame)
    unlisted = next((v for v in (current, 0, 1, (1 << subject.width) - 1, 85) if v not in select.by_value), current)
    for value in dict.fromkeys((current, unlisted, *select.by_value)):
        changed = data & ~mask | placed(subject.segments, value)
        if changed.bit_length() <= len(frame.data) * 8 and not (changed ^ data) & ~variable:
            known = select.by_value.get(value)  # without one, later decisions can be on the same bits
            then, left = (select.otherwise, variable) if known is None else (known, variable & ~mask)
            yield from _leaves(then, with_data(frame, changed), left)


def with_data(frame: CanFrame, data: int) -> CanFrame:
    """A frame with other data, a little-endian integer; bytes beyond its length are dropped."""
    size = len(frame.data)
    return frame._replace(data=(data & (1 << size * 8) - 1).to_bytes(size, "little"))


def with_first_key(message: Message, frame: CanFrame, value: int) -> CanFrame:
    """A frame of a message with another value of its first key."""
    key = message.keys[0]
    mask, bits = placed(key.segments, -1), placed(key.segments, value)
    if key.space is Space.ID:
        return frame._replace(id=frame.id & ~mask | bits)
    return with_data(frame, int.from_bytes(frame.data, "little") & ~mask | bits)


def message_of(decoder: Decoder, direction: Direction, frame: CanFrame) -> Message | None:
    """The message that a frame is; None if it is rejected."""
    result = decoder.identify(direction, frame)
    return result.message if isinstance(result, Identified) else None
