"""Checks of the bits of a frame: reserved bits, constants, names and ranges, with a reason against each violation."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from ..model import formatting
from ..model.layout import Field, Space
from ..model.types import Assignment, ByParameter, Encoding, Type
from ..semantics.decoder import value_of
from ..semantics.encoder import Encoder
from ..semantics.frame import Parts, parts_of, required_raw, signed
from ..semantics.valid_raws import RawInterval, valid_raws

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


class Check(NamedTuple):
    """A check of some bits: `reason` is that against them; it changes only at the numbers `steps`, unless they are None."""

    in_id: bool
    parts: Parts
    steps: Sequence[int] | None
    reason: Callable[[int], Reason | None]


def reserved_check(at: int, mask: int, where: str) -> Check:
    """The check that the reserved bits of a byte are 0."""
    reason = Reason(WEAK, where, at)
    return Check(False, ((at * 8, mask, 0),), (1,), lambda bits: reason if bits else None)


def field_checks(field: Field, where: str, *, is_request: bool) -> Iterator[Check]:
    """The checks that elements of a field have a constant, a name, or a value within its range."""
    type_, required = field.type, required_raw(field)
    if required is not None or (field.is_given and (type_.plausible or not type_.accepts_every_raw)):
        steps = _steps(type_) if required is None else None
        reason = _reason(field, required, f"{where}: `{field.name}`", STRONG if is_request else UNNAMED)
        for element in field.elements:
            yield Check(field.space is Space.ID, parts_of(element.segments), steps, reason)


def _reason(field: Field, required: int | None, named: str, unnamed: int) -> Callable[[int], Reason | None]:
    """The reason against the bits of a field; a value without a name has the points `unnamed`."""
    type_ = field.type
    if required is not None:
        wrong = Reason(STRONG, f"{named} is not {required}")
        return lambda bits: None if signed(type_, bits) == required else wrong
    encoders = [Encoder(case) for case in _assignments(type_.raw_range)]
    limits = formatting.span(type_.plausible) if type_.plausible else ""
    unit = f" {type_.unit.symbol}" if type_.unit else ""

    def reason(bits: int) -> Reason | None:
        raw = signed(type_, bits)
        is_invalid = all(encoder.rejects_raw(field, raw) for encoder in encoders)
        if is_invalid and type_.enum:
            return Reason(unnamed, f"{named} has a value without a name")
        if is_invalid and type_.flags:
            return Reason(UNNAMED, f"{named} has bits without a name")
        if not any(type_.is_plausible(value_of(type_, raw, case)) for case in _assignments(type_.linear)):
            return Reason(IMPLAUSIBLE, f"{named} is outside the plausible range {limits}{unit}")
        return Reason(WEAK, f"{named} is out of range") if is_invalid else None

    return reason


def _steps(type_: Type) -> Sequence[int] | None:
    """The numbers at which a limit of an integer begins or ends; None if other results depend on its bits."""
    if type_.enum or type_.flags or type_.encoding is Encoding.FLOAT:
        return None
    valid = [case for _, case in valid_raws(type_).distinct() if isinstance(case, RawInterval)]
    bounds = [Fraction(end) for case in valid for end in (case.low, case.high)]
    bounds += [Fraction(end) for named in type_.no_values for end in (named.raws[0] - 1, named.raws[-1])]
    if type_.plausible is not None:
        for _, linear in type_.linear.distinct():
            scale, offset = (linear.scale, linear.offset) if linear else (Fraction(1), Fraction(0))
            bounds += [(end.constant - offset) / scale for end in (type_.plausible.low, type_.plausible.high)]
    near = {around for b in bounds for around in (math.floor(b), math.floor(b) + 1, math.ceil(b) + 1)}
    modulus = 1 << type_.width
    return sorted({number % modulus for number in near} | {modulus >> 1})


def _assignments(by: ByParameter[Any]) -> Sequence[Assignment]:
    """Each value of the parameter of which something depends."""
    return [{by.parameter: case} for case in by.cases] if by.parameter else [{}]
