"""What a frame means, straight from the model: exact and plain, one frame at a time.

This is for looking at frames while generating or checking. Programs use the generated bindings.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import or_
from typing import NamedTuple

from ..language import notation
from ..model import formatting
from ..model.layout import Field, Segment, Space, Variant
from ..model.message import BitRun, IdRule, Key, Message
from ..model.types import Assignment, Encoding, Linear, Type

Raw = int | list[int]
Value = Fraction | str | list[str] | None


@dataclass(frozen=True)
class CanFrame:
    """A frame as it was on the bus; `extended` means a 29-bit id, `remote` a frame that asks for data."""

    id: int
    data: bytes
    extended: bool = False
    remote: bool = False


def has_id(message: Message, frame: CanFrame) -> bool:
    """Whether the id of a frame is one of the message's, keys in the id included."""
    if (message.id.extended, message.remote) != (frame.extended, frame.remote):
        return False
    if not all(_key_holds(message, i, frame) for i, key in enumerate(message.keys) if key.space is Space.ID):
        return False
    rest = frame.id & ~message.id_mask
    return rest == message.id.base if message.id.nodes is None else node(message.id, rest) is not None


def by_rule(messages: Iterable[Message]) -> list[list[Message]]:
    """The messages of each rule from node to id, in the order in which the rule of a frame is looked for.

    An id that is written out goes before one of which a code or a field is a part, a small part before a large one.
    """
    groups: dict[tuple[IdRule, bool], list[Message]] = {}
    for message in messages:
        groups.setdefault((message.id, message.remote), []).append(message)
    return sorted(groups.values(), key=lambda group: open_bits(group).bit_count())


def open_bits(messages: Iterable[Message]) -> int:
    """Bits of the id that keys and fields of some of these messages fill."""
    return reduce(or_, (message.id_mask for message in messages), 0)


def is_message(message: Message, frame: CanFrame) -> bool:
    """Whether a frame has the id, the length and the keys of a message."""
    if len(frame.data) != message.dlc and not frame.remote:
        return False
    return has_id(message, frame) and all(_key_holds(message, i, frame) for i in range(len(message.keys)))


class Difference(NamedTuple):
    """The part of a frame that is not that of a message, and what is wrong with it."""

    part: str
    text: str


def difference(message: Message, frame: CanFrame) -> Difference | None:
    """Why a frame is not a message; None when it is."""
    if is_message(message, frame):
        return None
    if frame.extended is not message.id.extended:
        return Difference("extended", f"{message.name} has {'a 29-bit' if message.id.extended else 'an 11-bit'} id")
    if frame.remote is not message.remote:
        return Difference("remote", f"{message.name} is {'a' if message.remote else 'no'} remote frame")
    if not has_id(message, frame):
        return Difference("id", f"0x{frame.id:X} is no id of {message.name}")
    if len(frame.data) != message.dlc and not frame.remote:
        return Difference(
            "length", f"{formatting.counted(len(frame.data), 'byte')}, but {message.name} has {message.dlc}"
        )
    key = next(key for i, key in enumerate(message.keys) if not _key_holds(message, i, frame))
    found = f"{formatting.place(key.space, key.segments)} is 0x{held(key, frame):02X}"
    return Difference("keys", f"{found}, but {message.name} has 0x{key.value:02X}")


def node(rule: IdRule, id_: int) -> int | None:
    """The node of an id without the bits of keys and fields; None when there is none."""
    if rule.nodes is None:
        return None
    found, beside = divmod(id_ - rule.base, rule.node_step)
    return found if not beside and found in rule.nodes else None


def node_of(message: Message, frame: CanFrame) -> int | None:
    """The node that a frame of this message is of."""
    return node(message.id, frame.id & ~message.id_mask)


def held(bits: BitRun, frame: CanFrame) -> int:
    """The unsigned integer that some bits hold in a frame."""
    return _bits(bits.segments, bits.space, frame)


def data_bits(places: Iterable[tuple[Space, Sequence[Segment]]]) -> int:
    """The bits of the data that some places take, as a mask, the first byte lowest."""
    taken = 0
    for space, segments in places:
        for s in segments if space is Space.DATA else ():
            taken |= ((1 << s.width) - 1) << (s.byte * 8 + s.low)
    return taken


def raws(variant: Variant, frame: CanFrame) -> dict[str, Raw]:
    """The raw integer of each field, constants left out."""
    return {f.name: raw_of(f, frame) for f in variant.fields if f.fixed is None}


def raw_of(field: Field, frame: CanFrame) -> Raw:
    """The raw integer of a field, a list for an array."""
    found = [_signed(field.type, _bits(e.segments, field.space, frame)) for e in field.elements]
    return found if field.is_array else found[0]


def wrong_constants(fields: Iterable[Field], frame: CanFrame) -> list[Field]:
    """The fields that should hold a constant and hold something else."""
    return [f for f in fields if f.demanded is not None and raw_of(f, frame) != f.demanded]


def value_of(type_: Type, raw: int, assignment: Assignment) -> Value:
    """The value of a raw integer: a number in the unit, a member's name, the names of flags; None when there is none."""
    if type_.enum:
        return next((member.name for member in type_.enum if member.value == raw), None)
    if type_.flags:
        return [flag.name for flag in type_.flags if raw >> flag.value & 1]
    linear = linear_of(type_, assignment)
    if linear is None:
        return None
    if type_.encoding is Encoding.FLOAT:
        code = {32: ("<I", "<f"), 64: ("<Q", "<d")}[type_.width]
        (number,) = struct.unpack(code[1], struct.pack(code[0], raw))
        if number != number or number in (float("inf"), float("-inf")):
            return None
        return Fraction(number) * linear.scale + linear.offset
    number = raw * linear.scale
    return number + linear.offset if linear.offset else number


def linear_of(type_: Type, assignment: Assignment) -> Linear | None:
    """Scale and offset under parameters; None where there are none, or a number that they need is not above 0."""
    linear = type_.linear.at(assignment)
    if linear is None or linear.times is None:
        return linear
    try:
        number = notation.rational(assignment.get(linear.times, ""))
    except ValueError:
        return None
    return linear.at({linear.times: number}) if number > 0 else None


def _key_holds(message: Message, index: int, frame: CanFrame) -> bool:
    key: Key = message.keys[index]
    found = held(key, frame)
    return found == key.value or (index == 0 and found in (*message.accept, *message.claims))


def _bits(segments: Sequence[Segment], space: Space, frame: CanFrame) -> int:
    found = 0
    for s in segments:
        source = frame.id if space is Space.ID else frame.data[s.byte] if s.byte < len(frame.data) else 0
        found |= (source >> s.low & (1 << s.width) - 1) << s.raw_low
    return found


def _signed(type_: Type, raw: int) -> int:
    if type_.encoding is Encoding.SIGNED and raw >> (type_.width - 1):
        return raw - (1 << type_.width)
    return raw
