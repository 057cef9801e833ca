"""Frames of a message that are identified as another one, because their fields have the values of its keys.

Encoders reject them: see `CheckMeaning` in `plan`.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..model.layout import Field, FixedRole, Space
from ..model.message import BitRun, Confusion, Message
from ..model.types import Encoding, Type
from .bits import placed
from .decoder import is_finite
from .dispatch import bits_of_key
from .frame import CanFrame, read_bits
from .valid_raws import FiniteFloats, FlagBits, NamedRaws, ValidRaws, valid_raws, width_limits

_DATA = 32
"""The position of the data in an integer with all bits of a frame; the id is before it."""


def is_confused(confusion: Confusion, frame: CanFrame) -> bool:
    """Whether a frame has the bits that identify it as the other message."""
    return all(read_bits(bits, frame) in values for bits, values in confusion.conditions)


def confusions(messages: Sequence[Message]) -> Mapping[Message, tuple[Confusion, ...]]:
    """The confusions of messages of one id rule, direction and kind of frame; those without any are not listed.

    The longest matching keys identify a frame, see `dispatch`: a message with all keys of another, and with further ones in
    bits that are fields there, takes those of its frames that have these values.
    """
    known = [_bits_of(message, message.keys[0].value if message.keys else 0) for message in messages]
    by_keys: dict[int, list[Message]] = {}
    for message, bits in zip(messages, known, strict=True):
        by_keys.setdefault(bits.keys, []).append(message)
    result: dict[Message, tuple[Confusion, ...]] = {}
    for message, bits in zip(messages, known, strict=True):
        further = (code for code in message.accepted_codes if code in message.identifying_codes)
        sent = [bits, *(_bits_of(message, code) for code in further)]
        if message.keys and message.keys[0].value not in message.identifying_codes:
            del sent[0]  # only its request identifies it
        rivals = (
            rival for keys, group in by_keys.items() if keys & bits.open and not bits.keys & ~keys for rival in group
        )
        values = tuple(confusion for rival in rivals for confusion in _confusion(message, sent, rival))
        if values:
            result[message] = values
    return result


class _Bits(NamedTuple):
    """The bits of the frames of a message: those of keys, those that vary, and the values of all others."""

    keys: int
    open: int
    fixed: int


def _bits_of(message: Message, code: int) -> _Bits:
    """The bits of frames with a code, which is the value of the first key."""
    keys = vary = fixed = 0
    for key in message.keys:
        keys |= _at(key.space, placed(key.segments, -1))
        fixed |= _at(key.space, placed(key.segments, code if key is message.keys[0] else key.value))
    for field in message.layout.fields:
        for element in field.elements:
            if isinstance(field.role, FixedRole) and not field.only:
                fixed |= _at(field.space, placed(element.segments, field.role.raw))
            else:
                vary |= _at(field.space, placed(element.segments, -1))
    return _Bits(keys, vary, fixed)


def _at(space: Space, bits: int) -> int:
    return bits << _DATA if space is Space.DATA else bits


def _confusion(message: Message, sent: Sequence[_Bits], rival: Message) -> Iterator[Confusion]:
    """The confusion with a message that has further keys; none if no valid frame has their values.

    `sent` are the bits of its frames with each code that can be sent.
    """
    first, *further = rival.keys
    rest = [(bits_of_key(key), key.value) for key in further]
    codes = tuple(
        code
        for code in rival.identifying_codes
        if any(_is_possible(message, bits, [(bits_of_key(first), code), *rest]) for bits in sent)
    )
    if codes:
        conditions = [(bits_of_key(first), codes), *((run, (value,)) for run, value in rest)]
        varying = sent[0].open
        if message.accepted_codes:
            varying |= _at(message.keys[0].space, placed(message.keys[0].segments, -1))
        variable = tuple(
            (run, values) for run, values in conditions if _at(run.space, placed(run.segments, -1)) & varying
        )
        yield Confusion(command=rival.command, conditions=variable)


def required_bits(message: Message, conditions: Iterable[tuple[BitRun, int]]) -> Iterator[tuple[Field, int, int]]:
    """The values that a frame needs to meet some conditions: fields with a mask of their raw bits and the values of these."""
    mask = value = 0
    for run, required in conditions:
        mask |= _at(run.space, placed(run.segments, -1))
        value |= _at(run.space, placed(run.segments, required))
    for field in message.layout.fields:
        for element in field.elements if field.is_given else ():
            raw_mask = raw = 0
            for s in element.segments:
                low, width = _at(field.space, 1 << s.byte * 8 + s.low).bit_length() - 1, (1 << s.width) - 1
                raw_mask |= (mask >> low & width) << s.raw_low
                raw |= (value >> low & mask >> low & width) << s.raw_low
            if raw_mask:
                yield field, raw_mask, raw


def _is_possible(message: Message, bits: _Bits, conditions: Sequence[tuple[BitRun, int]]) -> bool:
    """Whether a valid frame can meet some conditions, as far as its fields are independent."""
    for run, required in conditions:
        different = _at(run.space, placed(run.segments, required)) ^ bits.fixed
        if different & _at(run.space, placed(run.segments, -1)) & ~bits.open:
            return False
    return all(
        field.only or _has_valid_raw(field.type, mask, raw) for field, mask, raw in required_bits(message, conditions)
    )


def _has_valid_raw(type_: Type, mask: int, value: int) -> bool:
    """Whether a valid raw integer has these values in the bits of a mask."""
    by = valid_raws(type_)
    cases = [*by.cases.values(), width_limits(type_)] if by.parameter is not None else [by.constant]
    return any(case is not None and _allows(type_, case, mask, value) for case in cases)


def _allows(type_: Type, valid: ValidRaws, mask: int, value: int) -> bool:
    """Whether one of these raw integers has the values in the bits of a mask."""
    every = (1 << type_.width) - 1
    if isinstance(valid, NamedRaws):
        return any(raw & mask == value for raw in valid.values)
    if isinstance(valid, FlagBits):
        return not value & ~valid.mask
    if isinstance(valid, FiniteFloats):
        return mask != every or is_finite(type_, value) or type_.no_value(value) is not None
    spans = [range(valid.low, valid.high + 1), *valid.no_values]
    top = 1 << type_.width - 1 if type_.encoding is Encoding.SIGNED else 0
    """Added to a raw integer, so that their order is that of their bits."""
    return any(span and _is_within(mask, value ^ mask & top, span.start + top, span[-1] + top, every) for span in spans)


def _is_within(mask: int, value: int, low: int, high: int, every: int) -> bool:
    """Whether an integer from `low` to `high` has these values in the bits of a mask."""
    free = [bit for bit in range(every.bit_length()) if not mask >> bit & 1]

    def filled(number: int) -> int:
        return value | sum((number >> i & 1) << bit for i, bit in enumerate(free))

    first = bisect_left(range(1 << len(free)), low, key=filled)
    return first < 1 << len(free) and filled(first) <= high
