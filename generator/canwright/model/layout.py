"""Fields and layouts: where the values of a frame are.

Positions are bits. In the data, bit `n` is bit `n % 8` (0 is the least significant) of byte `n // 8`; in the id, bit 0
is the least significant.
"""

from __future__ import annotations

import itertools
from abc import ABC
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import ClassVar

from ..diagnostics.diagnostic import DocumentPath
from .checksum import Algorithm, ConstantBytes, Input
from .deprecation import Deprecation
from .types import Assignment, Order, Text, Type

MAX_DATA_BYTES = 64
"""The maximum number of data bytes of a frame: CAN FD. `FrameFormat` has the lengths of each format; no other code assumes one."""


class Space(str, Enum):
    """The part of a frame that bits belong to: the data bytes or the CAN id."""

    DATA = "data"
    ID = "id"


@dataclass(frozen=True)
class Segment:
    """Bits of a field within one byte: `raw |= (byte >> low & (1 << width) - 1) << raw_low`.

    In the id space there is one segment, its `byte` is 0 and `low` counts from bit 0 of the id.
    """

    byte: int
    low: int
    width: int
    raw_low: int


def bits_of(segments: Iterable[Segment]) -> tuple[int, ...]:
    """Frame bits of some segments, from the least significant raw bit up."""
    return tuple(s.byte * 8 + s.low + i for s in segments for i in range(s.width))


def is_one_run(segments: Sequence[Segment], order: Order) -> bool:
    """Whether segments are all bits of a raw integer, adjacent in a byte order."""
    pairs = itertools.pairwise(segments)
    return segments[0].raw_low == 0 and all(_continues(before, after, order) for before, after in pairs)


def runs_of(segments: Sequence[Segment], order: Order) -> list[tuple[Segment, ...]]:
    """The segments, those of whole bytes that are adjacent in a byte order together."""
    runs: list[list[Segment]] = []
    for s in segments:
        if runs and s.width == runs[-1][-1].width == 8 and _continues(runs[-1][-1], s, order):
            runs[-1].append(s)
        else:
            runs.append([s])
    return [tuple(run) for run in runs]


def _continues(before: Segment, after: Segment, order: Order) -> bool:
    """Whether a segment starts where another ends, in the next byte or, if it is big-endian, in the previous one."""
    is_next = after.byte - before.byte == (1 if order is Order.LITTLE else -1)
    return (
        is_next and (before.low + before.width, after.low) == (8, 0) and after.raw_low == before.raw_low + before.width
    )


@dataclass(frozen=True)
class Element:
    """The bits of one value: of a field, or of one element of an array, which has an index."""

    index: int | None
    segments: tuple[Segment, ...]

    @cached_property
    def bits(self) -> tuple[int, ...]:
        """Frame bits from the least significant raw bit up."""
        return bits_of(self.segments)


@dataclass(frozen=True)
class FieldRole(ABC):
    """The role of a field: what is sent, what is checked, and whether a user sees the field."""

    key: ClassVar[str]
    """The key of the language that selects the role; empty for a value."""


@dataclass(frozen=True)
class GivenRole(FieldRole):
    """Messages have the field as a value, which users give to an encoder and get from a decoder."""


@dataclass(frozen=True)
class ValueRole(GivenRole):
    """The sender chooses the value."""

    key = ""


@dataclass(frozen=True)
class NodeRole(GivenRole):
    """The value is the node that receives or sends the frame, or the low bits of its number."""

    key = "holds"


@dataclass(frozen=True)
class CounterRole(GivenRole):
    """A value that the sender increments with each frame: `first` follows on `last`."""

    key = "counter"
    first: int
    last: int


@dataclass(frozen=True)
class FixedRole(FieldRole):
    """The field is always sent as the same raw integer."""

    raw: int


@dataclass(frozen=True)
class ConstantRole(FixedRole):
    """A receiver rejects any other raw integer."""

    key = "constant"


@dataclass(frozen=True)
class ParameterRole(FieldRole):
    """The raw integer is the value of a parameter; a receiver that knows the parameter rejects any other."""

    key = "constant"
    parameter: str


@dataclass(frozen=True)
class ReservedRole(FixedRole):
    """A receiver ignores the field."""

    key = "reserved"


@dataclass(frozen=True)
class ChecksumRole(FieldRole):
    """The sender computes the field from other bytes of the frame, and a receiver rejects any other raw integer."""

    key = "checksum"
    name: str
    """The name of the algorithm; empty if the spec states its parameters."""
    algorithm: Algorithm
    inputs: tuple[Input, ...]

    @property
    def leading(self) -> bytes:
        """The constant bytes before all bytes of the frame."""
        parts = itertools.takewhile(lambda part: isinstance(part, ConstantBytes), self.inputs)
        return b"".join(part.data for part in parts if isinstance(part, ConstantBytes))


Role = ValueRole | NodeRole | CounterRole | ConstantRole | ParameterRole | ReservedRole | ChecksumRole
"""Every role, so that the type checker names each place that does not decide about one of them."""

ROLE_KEYS = (ConstantRole.key, ReservedRole.key, NodeRole.key, ChecksumRole.key, CounterRole.key)
"""The keys of the language of which a field has at most one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Field:
    """A run of bits with a type; an array has one element for each index.

    `only` are the values of the layout's parameter under which the field exists; empty means always. `renamed_from` is
    its name in previous editions, `manual_name` the one that the manual prints; empty if it is not stated. `variable` is
    that of the node that a request writes with it, and a reply reads; None if it is not stated.
    """

    name: str
    renamed_from: str | None
    deprecated: Deprecation | None
    type: Type
    space: Space
    elements: tuple[Element, ...]
    is_array: bool
    only: tuple[str, ...]
    role: Role
    variable: str | None
    title: Text
    about: Text
    manual: str
    manual_name: str
    path: DocumentPath

    @cached_property
    def is_given(self) -> bool:
        """Whether messages have the field as a value, which users give to an encoder and get from a decoder."""
        return isinstance(self.role, GivenRole)

    @property
    def is_node(self) -> bool:
        """Whether the value is the node that receives or sends the frame, or the low bits of its number."""
        return isinstance(self.role, NodeRole)

    @property
    def counter(self) -> CounterRole | None:
        """The range of a counter; None for another field."""
        return self.role if isinstance(self.role, CounterRole) else None

    @property
    def checksum(self) -> ChecksumRole | None:
        """What a checksum is computed from, and how; None for another field."""
        return self.role if isinstance(self.role, ChecksumRole) else None


@dataclass(frozen=True, eq=False, kw_only=True)
class Variant:
    """The fields of a layout under some values of its parameter; `values` is empty when it has no parameter."""

    values: tuple[str, ...]
    fields: tuple[Field, ...]

    @cached_property
    def given(self) -> tuple[Field, ...]:
        """The fields that messages have as values."""
        return tuple(field for field in self.fields if field.is_given)


@dataclass(frozen=True, eq=False, kw_only=True)
class Layout:
    """Fields with their bits. `shared` layouts have a name in the spec; the others belong to one message.

    `parameter` is the choice that decides which fields exist, `variants` are the results, in spec order.
    Bits without a field are reserved: written as 0, ignored when read.
    """

    name: str
    fields: tuple[Field, ...]
    parameter: str | None
    variants: tuple[Variant, ...]
    shared: bool
    title: Text
    about: Text
    manual: str
    path: DocumentPath

    @cached_property
    def given(self) -> tuple[Field, ...]:
        """The fields that messages have as values."""
        return tuple(field for field in self.fields if field.is_given)

    def variant(self, assignment: Assignment) -> Variant | None:
        """The variant under `assignment`; None if the layout's parameter is not assigned."""
        if self.parameter is None:
            return self.variants[0]
        value = assignment.get(self.parameter)
        return next((v for v in self.variants if value in v.values), None)

    def has(self, field: Field, assignment: Assignment) -> bool:
        """Whether a field exists under `assignment`; False if that depends on a missing parameter."""
        return not field.only or assignment.get(self.parameter or "") in field.only

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of all choice parameters that fields, scales and ranges of this layout depend on."""
        names = ([self.parameter] if self.parameter else []) + [p for f in self.fields for p in f.type.parameters]
        return tuple(dict.fromkeys(names))
