"""How raw bits become a value: parameters, scales, ranges, types. The part of the model that knows no frame.

Every number is an int or a Fraction; nothing here is a float.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from functools import cached_property
from typing import Generic, TypeVar

from ..diagnostics.diagnostic import DocumentPath

T = TypeVar("T")

Text = Mapping[str, str]
"""One text in every language of the edition, by language code."""

Assignment = Mapping[str, str]
"""Parameter name to the name of its value, as `{"model": "A"}`; what is not known is left out."""


class Order(str, Enum):
    """Which byte comes first when a field spans several."""

    LITTLE = "little"
    BIG = "big"


class Encoding(str, Enum):
    """How raw bits read as a number."""

    UNSIGNED = "unsigned"
    SIGNED = "signed"
    FLOAT = "float"


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit of `units.yaml`: `symbol` for people, `dbc` in ASCII."""

    name: str
    symbol: str
    dbc: str
    quantity: str
    title: Text


@dataclass(frozen=True, kw_only=True)
class ParameterValue:
    """One value a choice can take. `number` is set when the value is one, as 14 for an encoder of 14 bits."""

    name: str
    number: int | None
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Parameter:
    """What the integrator knows of a node and no frame says.

    A choice has `values`; a number has none, and lies between `minimum` and `maximum` where they are given.
    """

    name: str
    values: tuple[ParameterValue, ...]
    minimum: Fraction | None
    maximum: Fraction | None
    title: Text
    about: Text

    @property
    def is_choice(self) -> bool:
        return bool(self.values)

    @property
    def is_numeric(self) -> bool:
        """True for a number, and for a choice among numbers."""
        return all(value.number is not None for value in self.values)


@dataclass(frozen=True, kw_only=True)
class Dependent(Generic[T]):
    """Something that is constant, or depends on one choice parameter, or is not known."""

    parameter: str | None
    constant: T | None
    cases: Mapping[str, T | None]

    @classmethod
    def always(cls, value: T | None) -> Dependent[T]:
        return cls(parameter=None, constant=value, cases={})

    def at(self, assignment: Assignment) -> T | None:
        """The value under `assignment`; None where it is not given or its parameter is not assigned."""
        if self.parameter is None:
            return self.constant
        return self.cases.get(assignment.get(self.parameter, ""))

    def distinct(self) -> list[tuple[tuple[str, ...], T | None]]:
        """The different values, each with the names of the parameter values that lead to it, in spec order."""
        if self.parameter is None:
            return [((), self.constant)]
        groups: list[tuple[tuple[str, ...], T | None]] = []
        for name, value in self.cases.items():
            for index, (names, known) in enumerate(groups):
                if known == value:
                    groups[index] = ((*names, name), known)
                    break
            else:
                groups.append(((name,), value))
        return groups


@dataclass(frozen=True)
class Linear:
    """value = raw * scale + offset, both exact, and both so many times the number parameter `times` where there is one.

    `printed` is the scale as the spec's writer took it from the manual.
    """

    scale: Fraction
    offset: Fraction
    times: str | None = None
    printed: str = field(default="", compare=False)

    @property
    def is_identity(self) -> bool:
        return self.scale == 1 and self.offset == 0 and self.times is None

    def at(self, numbers: Mapping[str, Fraction]) -> Linear | None:
        """The same with its number parameter given; None when that is not among them."""
        if self.times is None:
            return self
        number = numbers.get(self.times)
        return None if number is None else Linear(self.scale * number, self.offset * number)

    @property
    def as_quotient(self) -> tuple[int, int, int]:
        """Factor, addend and divisor: value = (raw * factor + addend) / divisor, all of them integers."""
        divisor = math.lcm(self.scale.denominator, self.offset.denominator)
        return int(self.scale * divisor), int(self.offset * divisor), divisor


@dataclass(frozen=True)
class Bound:
    """An end of a range: `constant + coefficient * parameter`, the latter a number parameter."""

    constant: Fraction
    coefficient: Fraction = Fraction(0)
    parameter: str | None = None

    def at(self, numbers: Mapping[str, Fraction]) -> Fraction | None:
        """The bound with the number parameters given; None when its parameter is not among them."""
        if self.parameter is None:
            return self.constant
        number = numbers.get(self.parameter)
        return None if number is None else self.constant + self.coefficient * number


@dataclass(frozen=True)
class Range:
    """From `low` to `high`, both included."""

    low: Bound
    high: Bound

    @property
    def is_constant(self) -> bool:
        return self.low.parameter is None and self.high.parameter is None


@dataclass(frozen=True, kw_only=True)
class Member:
    """A name for one raw value of an enum, or for one bit of flags (then `value` is the bit number)."""

    name: str
    value: int
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Type:
    """How raw bits become a value.

    `linear` is `Linear(1, 0)` where a spec gives no scale, and None where it says that there is none to be had.
    `raw_range` bounds the raw integer and is None where any bits are allowed; for floats, it bounds the value.
    `plausible` are values that a working node reports, for guessing alone. `differs` is why its scale or unit is another
    one than that of its like.
    """

    name: str
    width: int
    encoding: Encoding
    order: Order
    unit: Unit | None
    linear: Dependent[Linear]
    raw_range: Dependent[Range]
    enum: tuple[Member, ...]
    flags: tuple[Member, ...]
    plausible: Range | None
    title: Text
    about: Text
    differs: Text
    path: DocumentPath

    @property
    def raw_limits(self) -> tuple[int, int]:
        """Smallest and largest raw integer that the bits hold."""
        if self.encoding is Encoding.SIGNED:
            return -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1
        return 0, (1 << self.width) - 1

    @property
    def is_number(self) -> bool:
        return not self.enum and not self.flags

    @property
    def is_plain(self) -> bool:
        """True when value and raw are the same integer."""
        return self.is_number and self.encoding is not Encoding.FLOAT and self.linear == Dependent.always(IDENTITY)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the choice parameters that scale and range depend on."""
        names = (self.linear.parameter, self.raw_range.parameter)
        return tuple(dict.fromkeys(name for name in names if name is not None))

    @property
    def times(self) -> tuple[str, ...]:
        """Names of the number parameters that scales are multiples of."""
        found = (linear.times for _, linear in self.linear.distinct() if linear is not None)
        return tuple(dict.fromkeys(name for name in found if name is not None))

    @cached_property
    def numbers(self) -> tuple[str, ...]:
        """Names of the number parameters that scale and range depend on."""
        names: list[str | None] = list(self.times)
        spans = [span for _, span in self.raw_range.distinct() if span is not None]
        names += [end.parameter for span in spans for end in (span.low, span.high)]
        return tuple(dict.fromkeys(name for name in names if name is not None))


IDENTITY = Linear(Fraction(1), Fraction(0))
