"""CAN frames: their bits, the raw integers of fields, and the comparison with a message."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

from ..model import formatting
from ..model.golden_frames import CheckedFrame
from ..model.layout import ConstantRole, Field, ParameterRole, Segment, Space, Variant
from ..model.message import BitRun, IdRule, Message
from ..model.types import NO_PARAMETERS, Assignment, Encoding, Type, number_of
from .bits import placed
from .checksum import ChecksumPlan
from .dispatch import has_rest, node_of_id
from .plan import AcceptedKey, message_plan

Raw = int | list[int]


class CanFrame(NamedTuple):
    """A frame on the bus; `extended` means a 29-bit id, `remote` a frame without data that requests some."""

    id: int
    data: bytes
    extended: bool = False
    remote: bool = False


def can_frame(frame: CheckedFrame) -> CanFrame:
    """The frame of a golden frame or of another entry beside it."""
    return CanFrame(frame.id, frame.data, frame.extended, frame.remote)


def read_bits(bits: BitRun, frame: CanFrame) -> int:
    """Bits of a frame as an unsigned integer; bytes beyond its data count as 0."""
    return _read(bits.segments, bits.space, frame)


def _read(segments: Sequence[Segment], space: Space, frame: CanFrame) -> int:
    raw = 0
    for s in segments:
        source = frame.id if space is Space.ID else frame.data[s.byte] if s.byte < len(frame.data) else 0
        raw |= (source >> s.low & (1 << s.width) - 1) << s.raw_low
    return raw


Parts = tuple[tuple[int, int, int], ...]
"""Shift and mask of bits in a little-endian integer, and their position in the raw integer."""


def parts_of(segments: Iterable[Segment]) -> Parts:
    """The bits of some segments in the id, or in the data as one integer; consecutive segments are joined."""
    parts: list[tuple[int, int, int]] = []
    for s in sorted(segments, key=lambda s: s.raw_low):
        shift, mask = s.byte * 8 + s.low, (1 << s.width) - 1
        if parts:
            before, known, low = parts[-1]
            width = known.bit_length()
            if (before + width, low + width) == (shift, s.raw_low):
                parts[-1] = (before, known | mask << width, low)
                continue
        parts.append((shift, mask, s.raw_low))
    return tuple(parts)


def bits_at(parts: Parts, source: int) -> int:
    """The bits of an integer, as an unsigned raw integer."""
    bits = 0
    for shift, mask, low in parts:
        bits |= (source >> shift & mask) << low
    return bits


def raws(variant: Variant, frame: CanFrame) -> dict[str, Raw]:
    """The raw integer of each value of a variant."""
    return {f.name: raw_of(f, frame) for f in variant.given}


def checksum_of(plan: ChecksumPlan, frame: CanFrame) -> int:
    """The checksum of a frame."""
    register = plan.init
    for part in plan.inputs:
        byte = part if isinstance(part, int) else _read(part.segments, part.space, frame)
        register = plan.next(register, byte)
    return register >> plan.shift ^ plan.xor_out


def with_checksum(message: Message, frame: CanFrame) -> CanFrame:
    """A frame as long as a message, with its checksum."""
    step = message_plan(message).checksum
    if step is None:
        return frame
    segments = step.field.elements[0].segments
    data = int.from_bytes(frame.data, "little") & ~placed(segments, -1)
    data |= placed(segments, checksum_of(step.checksum, frame))
    return frame._replace(data=data.to_bytes(len(frame.data), "little"))


def raw_of(field: Field, frame: CanFrame) -> Raw:
    """The raw integer of a field, a list for an array."""
    integers = [signed(field.type, _read(e.segments, field.space, frame)) for e in field.elements]
    return integers if field.is_array else integers[0]


def signed(type_: Type, raw: int) -> int:
    """The raw integer of a type whose bits are an unsigned integer."""
    if type_.encoding is Encoding.SIGNED and raw >> (type_.width - 1):
        return raw - (1 << type_.width)
    return raw


def required_raw(field: Field, assignment: Assignment = NO_PARAMETERS) -> int | None:
    """The only raw integer that a receiver accepts; None if it accepts more, or if a parameter is missing."""
    if isinstance(field.role, ParameterRole):
        return parameter_raw(field.role.parameter, assignment)
    return field.role.raw if isinstance(field.role, ConstantRole) else None


def wrong_constants(fields: Iterable[Field], frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> list[Field]:
    """The constant fields with another value in a frame."""
    required = ((field, required_raw(field, assignment)) for field in fields)
    return [field for field, raw in required if raw is not None and differs(field, raw, frame)]


def differs(field: Field, raw: int, frame: CanFrame) -> bool:
    """Whether an element of a field has another raw integer in a frame."""
    actual = raw_of(field, frame)
    return any(element != raw for element in actual) if isinstance(actual, list) else actual != raw


def node_in_id(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> int | None:
    """The node in the id of a frame of this message; None without one."""
    return node_of_id(message.id, frame.id & ~message.id_mask, assignment)


def parameter_raw(parameter: str, assignment: Assignment) -> int | None:
    """The raw integer of a constant that is a parameter; None if that is missing."""
    number = number_of(assignment, parameter)
    return None if number is None or number.denominator != 1 else int(number)


def sent_id(message: Message, node: int | None, assignment: Assignment = NO_PARAMETERS) -> int | None:
    """The id of the frames of this message and node; None if it contains a value of the sender, or an unknown parameter."""
    rule = message.id.at(assignment)
    if rule is None:
        return None
    id_ = rule.base + (node or 0) * rule.node_step
    id_ |= sum(placed(key.segments, key.value) for key in message.keys if key.space is Space.ID)
    sent = message_plan(message).sent
    for field in message.layout.fields:
        if field.space is not Space.ID:
            continue
        raw = node if field.is_node else sent.get(field, required_raw(field, assignment))
        if raw is None:
            return None
        id_ |= placed((s for element in field.elements for s in element.segments), raw)
    return id_


def node_of(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> int | None:
    """The node of a frame of this message, in its id or in its data; None without one."""
    bits = message.node_in_data
    return node_in_id(message, frame, assignment) if bits is None else read_bits(bits, frame)


def code_of(message: Message, frame: CanFrame) -> int | None:
    """The code that a frame of this message has; None if it can have no other one."""
    return read_bits(message.keys[0], frame) if message_plan(message).codes else None


def has_usual_code(message: Message, frame: CanFrame) -> bool:
    """Whether a frame of this message has the code that is sent unless another is given."""
    return code_of(message, frame) in (None, *(key.value for key in message.keys[:1]))


def has_id(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> bool:
    """Whether the id of a frame is one of the message's, keys in the id included."""
    if not all(_has_key(accepted, frame) for accepted in message_plan(message).keys if accepted.key.space is Space.ID):
        return False
    return has_id_rule(message, frame, assignment)


def has_id_rule(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> bool:
    """Whether the id of a frame is one of the message's, whatever its keys are."""
    if (message.id.extended, message.remote) != (frame.extended, frame.remote):
        return False
    return has_rest(message.id, frame.id & ~message.id_mask, assignment)


def sent_id_rule(message: Message) -> IdRule:
    """The id rule of a message as it is sent: with its keys, and with the fields in the id that always have the same value."""
    places = [(key.segments, key.value) for key in message.keys if key.space is Space.ID]
    sent = message_plan(message).sent.items()
    places += [(field.elements[0].segments, raw) for field, raw in sent if field.space is Space.ID]
    return replace(message.id, base=message.id.base | sum(placed(segments, raw) for segments, raw in places))


def is_message(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> bool:
    """Whether a frame has the id, the length and the keys of a message."""
    if len(frame.data) != message.dlc and not frame.remote:
        return False
    return has_id(message, frame, assignment) and all(
        _has_key(accepted, frame) for accepted in message_plan(message).keys
    )


class Difference(NamedTuple):
    """The part of a frame that differs from a message, and a sentence about it."""

    part: str
    text: str


def difference(message: Message, frame: CanFrame, assignment: Assignment = NO_PARAMETERS) -> Difference | None:
    """The first difference between a frame and a message; None if the frame is that message."""
    if is_message(message, frame, assignment):
        return None
    if frame.extended is not message.id.extended:
        return Difference("extended", f"{message.name} has {'a 29-bit' if message.id.extended else 'an 11-bit'} id")
    if frame.remote is not message.remote:
        return Difference("remote", f"{message.name} is a {'remote' if message.remote else 'data'} frame")
    if not has_id_rule(message, frame, assignment):
        if message.id.at(assignment) is None:
            return Difference(
                "parameter", f"the id of {message.name} depends on `{message.id.parameter}`, which is missing"
            )
        return Difference("id", f"0x{frame.id:X} is not an id of {message.name}")
    if len(frame.data) != message.dlc and not frame.remote:
        return Difference(
            "length", f"{formatting.counted(len(frame.data), 'byte')}, but {message.name} has {message.dlc}"
        )
    key = next(accepted.key for accepted in message_plan(message).keys if not _has_key(accepted, frame))
    actual = f"{formatting.place(key.space, key.segments)} is 0x{read_bits(key, frame):02X}"
    return Difference("keys", f"{actual}, but {message.name} has 0x{key.value:02X}")


def _has_key(accepted: AcceptedKey, frame: CanFrame) -> bool:
    return read_bits(accepted.key, frame) in accepted.values
