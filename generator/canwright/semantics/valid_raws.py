"""The valid raw integers of a type, for the reference and for every target."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import NamedTuple

from ..model.types import Assignment, Bound, ByParameter, Encoding, Range, Type, number_of


def merged(runs: Iterable[range]) -> Sequence[range]:
    """Runs of integers in ascending order; those without a gap between them as one run."""
    disjoint: list[range] = []
    for run in sorted(runs, key=lambda run: run.start):
        if disjoint and run.start <= disjoint[-1].stop:
            disjoint[-1] = range(disjoint[-1].start, max(disjoint[-1].stop, run.stop))
        else:
            disjoint.append(run)
    return disjoint


@dataclass(frozen=True)
class NamedRaws:
    """The values of an enum, in ascending order."""

    values: tuple[int, ...]

    @cached_property
    def runs(self) -> tuple[range, ...]:
        """The values as runs of consecutive integers."""
        return tuple(merged(range(value, value + 1) for value in self.values))


class FlagBits(NamedTuple):
    """Integers with no other bit than those of `mask`."""

    mask: int


class RawInterval(NamedTuple):
    """The integers from `low` to `high`, both whole and within the width of the type.

    `low_bound` and `high_bound` are further ends that depend on a number parameter; None without one. An end is not
    checked while its parameter is unknown.
    """

    low: int
    high: int
    low_bound: Bound | None = None
    high_bound: Bound | None = None
    no_values: tuple[range, ...] = ()
    """Further valid integers, which have no value: an encoder of values writes them by name."""


class FiniteFloats(NamedTuple):
    """The bit patterns of finite floats whose value in the unit is in `scaled`; of all finite floats if it is None.

    Those of NaN are valid, too, if the type has a name for it.
    """

    scaled: Range | None


ValidRaws = NamedRaws | FlagBits | RawInterval | FiniteFloats


@lru_cache(maxsize=4096)
def valid_raws(type_: Type) -> ByParameter[ValidRaws]:
    """The valid raw integers of a type; they may depend on the choice that the raw range depends on.

    Where the parameter of the range is unknown, only the width limits them, see `width_limits`.
    """
    if type_.enum:
        return ByParameter.always(NamedRaws(tuple(sorted(member.value for member in type_.enum))))
    if type_.flags:
        return ByParameter.always(FlagBits(sum(1 << flag.value for flag in type_.flags)))
    return type_.raw_range.map(lambda span: _within(type_, span))


def width_limits(type_: Type) -> ValidRaws:
    """The valid raw integers of a type without its raw range."""
    return _within(type_, None)


def _within(type_: Type, span: Range | None) -> ValidRaws:
    if type_.encoding is Encoding.FLOAT:
        return FiniteFloats(span)
    low, high = type_.number_limits
    no_values = tuple(sorted((no_value.raws for no_value in type_.no_values), key=lambda raws: raws.start))
    if span is None:
        return RawInterval(low, high, no_values=no_values)
    return RawInterval(
        low if span.low.parameter else max(low, math.ceil(span.low.constant)),
        high if span.high.parameter else min(high, math.floor(span.high.constant)),
        span.low if span.low.parameter else None,
        span.high if span.high.parameter else None,
        no_values,
    )


def end_of(bound: Bound, assignment: Assignment) -> Fraction | None:
    """A bound of a range under some parameters; None if it depends on a missing one."""
    number = number_of(assignment, bound.parameter)
    return bound.at({} if number is None else {bound.parameter or "": number})


def is_within(value: int | Fraction, low: int | Fraction | None, high: int | Fraction | None) -> bool:
    """Whether a number lies between two ends, as far as they are known."""
    return (low is None or value >= low) and (high is None or value <= high)
