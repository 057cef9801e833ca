"""Checks of the bits of a frame: reserved bits, constants, names and ranges, with a reason against each violation."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import NamedTuple

from ..model import formatting
from ..model.layout import Element, Field, ReservedRole, Space
from ..model.types import Assignment, Encoding, Linear, Type
from ..semantics.decoder import value_of
from ..semantics.frame import Parts, parts_of

WEAK = 1
"""Unusual: a reserved byte that is not 0, a raw integer beyond its printed range."""
UNNAMED = 2
"""An unnamed flag or value of a reply: manuals do not list all of them."""
IMPLAUSIBLE = 3
"""A value that no working node reports."""
STRONG = 4
"""Not in this edition: an id, a code, a length, a constant, an unnamed value in a request."""


class Reason(NamedTuple):
    """A reason against an interpretation; `byte` is set for a reserved byte."""

    points: int
    text: str
    byte: int | None = None


class Check(ABC):
    """A check of some bits of a frame; the result changes only at the numbers `steps`, unless they are None."""

    in_id: bool
    parts: Parts
    steps: Sequence[int] | None

    @abstractmethod
    def reason(self, bits: int) -> Reason | None:
        """The reason against the bits; None without one."""


class ReservedCheck(Check):
    """The reserved bits of a byte are 0."""

    def __init__(self, at: int, mask: int, where: str) -> None:
        self.in_id = False
        self.parts = ((at * 8, mask, 0),)
        self.steps = (1,)
        self._reason = Reason(WEAK, where, at)

    def reason(self, bits: int) -> Reason | None:
        return self._reason if bits else None


class FieldCheck(Check):
    """An element of a field has a constant, a name, or a value within its range."""

    def __init__(self, field: Field, element: Element, where: str, *, is_request: bool) -> None:
        self.in_id = field.space is Space.ID
        self.parts = parts_of(element.segments)
        self.steps = _steps(field)
        self._field = field
        self._named = f"{where}: `{field.name}`"
        self._unnamed = STRONG if is_request else UNNAMED

    @classmethod
    def of(cls, field: Field, where: str, *, is_request: bool) -> list[Check]:
        """The checks of a field; none if it accepts everything."""
        type_ = field.type
        bounded = any(type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases))
        is_checked = field.role.is_checked or type_.enum or type_.flags or type_.plausible or bounded
        if isinstance(field.role, ReservedRole) or not is_checked:
            return []
        return [cls(field, element, where, is_request=is_request) for element in field.elements]

    def reason(self, bits: int) -> Reason | None:
        type_ = self._field.type
        signed = type_.encoding is Encoding.SIGNED and bits >> (type_.width - 1)
        raw = bits - (1 << type_.width) if signed else bits
        if self._field.role.is_checked:
            wrong = raw != self._field.role.required_raw
            return Reason(STRONG, f"{self._named} is not {self._field.role.required_raw}") if wrong else None
        if type_.enum and all(member.value != raw for member in type_.enum):
            return Reason(self._unnamed, f"{self._named} has a value without a name")
        if type_.flags and raw & ~sum(1 << flag.value for flag in type_.flags):
            return Reason(UNNAMED, f"{self._named} has bits without a name")
        if not _is_plausible(type_, raw):
            limits = formatting.span(type_.plausible) if type_.plausible else ""
            unit = f" {type_.unit.symbol}" if type_.unit else ""
            return Reason(IMPLAUSIBLE, f"{self._named} is outside the plausible range {limits}{unit}")
        if not _is_in_range(type_, raw):
            return Reason(WEAK, f"{self._named} is out of range")
        return None


def _steps(field: Field) -> list[int] | None:
    """The numbers at which a limit of an integer begins or ends; None if other results depend on its bits."""
    type_ = field.type
    if field.role.is_checked or type_.enum or type_.flags or type_.encoding is Encoding.FLOAT:
        return None
    limits = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    bounds = [b.constant for span in limits if span and span.is_constant for b in (span.low, span.high)]
    if type_.plausible is not None:
        for assignment in _assignments(type_.linear.parameter, type_.linear.cases):
            linear = type_.linear.at(assignment) or Linear(Fraction(1), Fraction(0))
            ends = (type_.plausible.low.constant, type_.plausible.high.constant)
            bounds += [(end - linear.offset) / linear.scale for end in ends]
    near = {around for b in bounds for around in (math.floor(b), math.floor(b) + 1, math.ceil(b) + 1)}
    modulus = 1 << type_.width
    return sorted({number % modulus for number in near} | {modulus >> 1})


def _assignments(parameter: str | None, cases: Iterable[str]) -> list[Assignment]:
    return [{parameter: case} for case in cases] if parameter else [{}]


def _is_plausible(type_: Type, raw: int) -> bool:
    """Whether the value is plausible under some parameter value."""
    cases = _assignments(type_.linear.parameter, type_.linear.cases)
    return any(type_.is_plausible(value_of(type_, raw, case)) for case in cases)


def _is_in_range(type_: Type, raw: int) -> bool:
    """Whether a raw integer is in range under some parameter value; ranges with a number parameter are not checked."""
    spans = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    return any(s is None or not s.is_constant or s.low.constant <= raw <= s.high.constant for s in spans)
