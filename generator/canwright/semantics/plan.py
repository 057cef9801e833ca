"""The plan of a message: the steps of decoding and encoding, in order, in terms of no language.

With the dispatch plan (`dispatch`), the valid raw integers (`valid_raws`) and the exchanges (`exchange`) this is all that
frames mean. The reference executes the steps; targets print or interpret them.

Decoding begins when the dispatch plan has identified the message.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from ..model.edition import Edition
from ..model.exhaustive import assert_never
from ..model.layout import (
    ChecksumRole,
    ConstantRole,
    Field,
    FixedRole,
    GivenRole,
    ParameterRole,
    ReservedRole,
    Segment,
    Space,
)
from ..model.message import Confusion, Direction, Key, Message
from .bits import data_bits, placed
from .checksum import ChecksumPlan, checksum_plan


@dataclass(frozen=True)
class CheckConstant:
    """Reject (wrong_constant) if an element of the field has another raw integer than `raw`."""

    field: Field
    raw: int


@dataclass(frozen=True)
class CheckChecksum:
    """Reject (wrong_checksum) if the field is not the checksum of the frame, which the spec states as `role`."""

    field: Field
    role: ChecksumRole
    checksum: ChecksumPlan


@dataclass(frozen=True)
class CheckAvailable:
    """Reject (not_available) if a parameter has a value that is not one of those in `only`; an unknown one is accepted."""

    only: Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class CheckCode:
    """Reject (unknown_code) if a code is given that is not one of `values`; without one, the first of them is sent."""

    values: tuple[int, ...]


@dataclass(frozen=True)
class CheckNode:
    """Reject (unknown_node) if the node is not one of `nodes`, or is missing."""

    nodes: range


@dataclass(frozen=True)
class ChooseFields:
    """Reject (missing_parameter) if the parameter that decides which fields exist is missing.

    Before this step, only fields without `only` are used; afterwards, fields that do not exist are skipped.
    """

    parameter: str


@dataclass(frozen=True)
class CheckParameter:
    """Reject if the parameter is missing (missing_parameter), or if the field has another raw integer (wrong_constant)."""

    field: Field
    parameter: str


@dataclass(frozen=True)
class NeedParameter:
    """Reject (missing_parameter) if a parameter in the id is missing."""

    parameter: str


@dataclass(frozen=True)
class ReadField:
    """Read the raw integer of the field, or one for each element."""

    field: Field


@dataclass(frozen=True)
class CheckField:
    """Reject (out_of_range, not_finite) if a raw integer is invalid for the type of the field, see `valid_raws`.

    An encoder of values converts them here: to the nearest raw integer, ties away from zero.
    """

    field: Field


@dataclass(frozen=True)
class WriteFixed:
    """Write the same raw integer into bits of every frame: of a key, or of a constant or reserved field."""

    space: Space
    segments: tuple[Segment, ...]
    raw: int
    field: Field | None


@dataclass(frozen=True)
class WriteCode:
    """Write the code into the bits of its key."""

    key: Key
    field: None = None


@dataclass(frozen=True)
class WriteParameter:
    """Write the value of a parameter into the field; reject (missing_parameter) if it is missing."""

    field: Field
    parameter: str


@dataclass(frozen=True)
class WriteField:
    """Write the raw integers of the field. All other bits are 0."""

    field: Field


@dataclass(frozen=True)
class WriteChecksum:
    """Write the checksum of all that is written before."""

    field: Field
    checksum: ChecksumPlan


@dataclass(frozen=True)
class CheckMeaning:
    """Reject (wrong_message) if the frame that is written is identified as another message."""

    confusion: Confusion
    field: None = None


Check = CheckConstant | CheckChecksum | CheckParameter
"""The checks of a field that no user gives."""
DecodingStep = Check | ChooseFields | ReadField
EncodingStep = (
    CheckAvailable
    | CheckCode
    | CheckNode
    | NeedParameter
    | ChooseFields
    | CheckField
    | WriteCode
    | WriteFixed
    | WriteParameter
    | WriteField
    | WriteChecksum
    | CheckMeaning
)


@dataclass(frozen=True)
class AcceptedKey:
    """A key with the values that a receiver accepts; a sender writes the first one, or one that is given."""

    key: Key
    values: tuple[int, ...]


@dataclass(frozen=True)
class MaskedBits:
    """Some bits of the data, read as one little-endian integer, or of the id, and their value."""

    mask: int
    value: int

    @classmethod
    def of(cls, parts: Iterable[tuple[Sequence[Segment], int]]) -> MaskedBits:
        """The bits of some segments, each with a raw integer."""
        mask = value = 0
        for segments, raw in parts:
            mask, value = mask | placed(segments, -1), value | placed(segments, raw)
        return cls(mask, value)


@dataclass(frozen=True, eq=False, kw_only=True)
class MessagePlan:
    """The steps of a message.

    Both directions of the work decide in the order of the steps. Fields are in the order of the spec; constants that always
    exist, then the checksum, come before the parameter that decides on other fields.
    """

    message: Message
    keys: tuple[AcceptedKey, ...]
    decoding: tuple[DecodingStep, ...]
    encoding: tuple[EncodingStep, ...]

    @property
    def codes(self) -> tuple[int, ...]:
        """The codes that a frame can have, first the one that is sent unless another is given; empty if there is no choice."""
        values = self.keys[0].values if self.keys else ()
        return values if len(values) > 1 else ()

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """The checks of fields that no user gives."""
        return tuple(step for step in self.decoding if not isinstance(step, (ChooseFields, ReadField)))

    @cached_property
    def checksum(self) -> CheckChecksum | None:
        """The check of the checksum; None without one. A message has at most one."""
        return next((step for step in self.decoding if isinstance(step, CheckChecksum)), None)

    @cached_property
    def sent(self) -> Mapping[Field, int]:
        """The fields that every sender writes with the same raw integer."""
        return {s.field: s.raw for s in self.encoding if isinstance(s, WriteFixed) and s.field is not None}

    @cached_property
    def required(self) -> Mapping[Field, int]:
        """The fields with the only raw integer that a receiver accepts."""
        return {step.field: step.raw for step in self.decoding if isinstance(step, CheckConstant)}

    @cached_property
    def constants(self) -> MaskedBits:
        """The data bits of the constants that always exist."""
        always = {f: raw for f, raw in self.required.items() if f.space is Space.DATA and not f.only}
        return MaskedBits.of((element.segments, raw) for field, raw in always.items() for element in field.elements)

    @cached_property
    def reserved_in_id(self) -> MaskedBits:
        """The bits of the id that a sender always writes with the same value and a receiver ignores."""
        ignored = {f: raw for f, raw in self.sent.items() if f.space is Space.ID and f not in self.required}
        return MaskedBits.of((element.segments, raw) for field, raw in ignored.items() for element in field.elements)

    @cached_property
    def reserved(self) -> MaskedBits:
        """The data bits that a sender always writes with the same value and a receiver ignores."""
        used = [(key.space, key.segments) for key in self.message.keys]
        value = 0
        for field in self.message.layout.fields:
            for element in field.elements if field.space is Space.DATA else ():
                if isinstance(field.role, ReservedRole) and not field.only:
                    value |= placed(element.segments, field.role.raw)
                else:
                    used.append((field.space, element.segments))
        return MaskedBits((1 << 8 * self.message.dlc) - 1 & ~data_bits(used), value)


@lru_cache(maxsize=1 << 14)
def message_plan(message: Message) -> MessagePlan:
    """The plan of a message; cached, because every frame asks for it. There is room for the messages of any edition."""
    return MessagePlan(
        message=message,
        keys=tuple(_accepted(message, number) for number in range(len(message.keys))),
        decoding=tuple(_decoding(message)),
        encoding=tuple(_encoding(message)),
    )


def only_by_request(edition: Edition) -> Sequence[Message]:
    """The replies that can have a code which, without the request, belongs to another message."""
    return [
        reply
        for reply in edition.messages(Direction.REPLY)
        if reply.keys and not {reply.keys[0].value, *reply.accepted_codes} <= {*reply.identifying_codes}
    ]


def value_fields(fields: Iterable[Field]) -> Mapping[str, Field]:
    """The fields that users see, by name."""
    return {field.name: field for field in fields if field.is_given}


def _accepted(message: Message, number: int) -> AcceptedKey:
    key = message.keys[number]
    further = (*message.accepted_codes, *message.identifying_codes) if number == 0 else ()
    return AcceptedKey(key, tuple(dict.fromkeys((key.value, *further))))


def _decoding(message: Message) -> Iterator[DecodingStep]:
    fields = message.layout.fields
    checks = [CheckConstant(field, field.role.raw) for field in fields if isinstance(field.role, ConstantRole)]
    yield from (check for check in checks if not check.field.only)
    yield from (CheckChecksum(field, role, checksum_plan(message, field, role)) for field, role in _checksums(message))
    yield from _choice(message)
    yield from (check for check in checks if check.field.only)
    yield from (CheckParameter(f, f.role.parameter) for f in fields if isinstance(f.role, ParameterRole))
    yield from map(ReadField, value_fields(fields).values())


def _encoding(message: Message) -> Iterator[EncodingStep]:
    fields = message.layout.fields
    if message.only:
        yield CheckAvailable(message.only)
    yield CheckCode(_accepted(message, 0).values if message.keys else ())
    if message.id.nodes is not None:
        yield CheckNode(message.id.nodes)
    if message.id.parameter is not None:
        yield NeedParameter(message.id.parameter)
    yield from _choice(message)
    values = [field for field in fields if field.is_given]
    yield from map(CheckField, values)
    yield from map(WriteCode, message.keys[:1])
    yield from (WriteFixed(key.space, key.segments, key.value, None) for key in message.keys[1:])
    for field in fields:
        role = field.role
        match role:
            case FixedRole():
                yield from (WriteFixed(field.space, e.segments, role.raw, field) for e in field.elements)
            case ParameterRole():
                yield WriteParameter(field, role.parameter)
            case GivenRole() | ChecksumRole():
                pass  # written after all that is fixed
            case _:
                assert_never(role)
    yield from map(WriteField, values)
    yield from (WriteChecksum(field, checksum_plan(message, field, role)) for field, role in _checksums(message))
    yield from map(CheckMeaning, message.confusions)


def _checksums(message: Message) -> Iterable[tuple[Field, ChecksumRole]]:
    return ((field, field.checksum) for field in message.layout.fields if field.checksum)


def _choice(message: Message) -> Iterator[ChooseFields]:
    if message.layout.parameter is not None:
        yield ChooseFields(message.layout.parameter)
