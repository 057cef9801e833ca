"""Types: the conversion from raw bits to values, with parameters, scales and ranges.

Every number is an int or a Fraction; nothing here is a float.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import Generic, NamedTuple, TypeVar

from ..diagnostics.diagnostic import DocumentPath
from .deprecation import Deprecation
from .joined import Joined

T = TypeVar("T")
S = TypeVar("S")
R = TypeVar("R")

Text = Mapping[str, str]
"""One text in every language of the edition, by language code."""


class ImpliedTitle(dict[str, str]):
    """The title of an item for which the spec has none: the words of its name."""


Assignment = Mapping[str, str | Fraction]
"""Parameter values by name, as `{"model": "A", "ratio": Fraction(6)}`: a choice by the name of its value, a number as a
fraction. Unknown parameters are left out."""

NO_PARAMETERS: Assignment = MappingProxyType({})


PI = Fraction(245850922, 78256779)
"""π as every output computes with it. It differs from π by less than 1e-16, and the nearest double is that of π."""


class Factors(NamedTuple):
    """The parameters of a factor: those that multiply it, and those that divide it."""

    above: tuple[str, ...]
    below: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return (*self.above, *self.below)


def factors(times: str) -> Factors:
    """The parameters of a factor in its notation: `size`, `a*b`, `/counts`, `size/counts`."""
    above, _, below = times.partition("/")
    return Factors(tuple(filter(None, above.split("*"))), tuple(filter(None, below.split("/"))))


def product_of(assignment: Assignment, times: str) -> Fraction | None:
    """The value of a factor; None if a parameter is unknown or not above 0."""
    product = Fraction(1)
    above, below = factors(times)
    for name in (*above, *below):
        number = number_of(assignment, name)
        if number is None or number <= 0:
            return None
        product = product * number if name in above else product / number
    return product


def number_of(assignment: Assignment, parameter: str | None) -> Fraction | None:
    """The number that a parameter is; None if it is unknown, or a name that is no number."""
    value = assignment.get(parameter) if parameter is not None else None
    if value is None or isinstance(value, Fraction):
        return value
    try:
        return Fraction(int(value, 16)) if value.startswith("0x") else Fraction(value)
    except (ValueError, ZeroDivisionError):
        return None


class Order(str, Enum):
    """The byte order of a field."""

    LITTLE = "little"
    BIG = "big"


class Encoding(str, Enum):
    """The encoding of a number in raw bits."""

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
    """A value of a choice. `number` is set if the value is a number, as 14 for an encoder of 14 bits."""

    name: str
    number: int | None
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Parameter:
    """A property of a node that no frame contains.

    A choice has `values`. A number has none; it lies between `minimum` and `maximum` if they are given. One that ids or
    constants contain is a `whole` number with both limits.
    """

    name: str
    values: tuple[ParameterValue, ...]
    minimum: Fraction | None
    maximum: Fraction | None
    whole: bool = False
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
class ByParameter(Generic[T]):
    """A value that is constant, depends on one choice parameter, or is unknown."""

    parameter: str | None
    constant: T | None
    cases: Mapping[str, T | None]

    @classmethod
    def always(cls, value: T | None) -> ByParameter[T]:
        return cls(parameter=None, constant=value, cases={})

    def at(self, assignment: Assignment) -> T | None:
        """The value under `assignment`; None if it is unknown or its parameter is not assigned."""
        if self.parameter is None:
            return self.constant
        return self.cases.get(str(assignment.get(self.parameter, "")))

    @property
    def named(self) -> Sequence[tuple[str, T | None]]:
        """Each value of the parameter with the value under it; the constant with an empty name."""
        return [("", self.constant)] if self.parameter is None else list(self.cases.items())

    def map(self, made: Callable[[T | None], R | None]) -> ByParameter[R]:
        """What is made of each value."""
        if self.parameter is None:
            return ByParameter.always(made(self.constant))
        cases = {name: made(value) for name, value in self.cases.items()}
        return ByParameter(parameter=self.parameter, constant=None, cases=cases)

    def combined(self, second: ByParameter[S], made: Callable[[T | None, S | None], R | None]) -> ByParameter[R]:
        """What is made of this value and of another one, which is constant or depends on the same parameter."""
        if self.parameter is None:
            return second.map(lambda value: made(self.constant, value))
        cases = {name: made(value, second.at({self.parameter: name})) for name, value in self.cases.items()}
        return ByParameter(parameter=self.parameter, constant=None, cases=cases)

    def distinct(self) -> Sequence[tuple[tuple[str, ...], T | None]]:
        """The different values, each with the parameter values under which it applies, in spec order."""
        return self._distinct

    @cached_property
    def _distinct(self) -> Sequence[tuple[tuple[str, ...], T | None]]:
        if self.parameter is None:
            return [((), self.constant)]
        groups: dict[T | None, list[str]] = {}
        for name, value in self.cases.items():
            groups.setdefault(value, []).append(name)
        return [(tuple(names), value) for value, names in groups.items()]


@dataclass(frozen=True)
class Linear:
    """A scale and an offset: value = raw * scale + offset. If `times` is set, both are multiplied by that factor.

    `times` is a parameter, or parameters in the notation of `factors`; all are above 0.

    `printed` is the scale in the notation of the spec.
    """

    scale: Fraction
    offset: Fraction
    times: str | None = None
    printed: str = field(default="", compare=False)

    @property
    def is_identity(self) -> bool:
        return self.scale == 1 and self.offset == 0 and self.times is None

    def at(self, numbers: Mapping[str, Fraction]) -> Linear | None:
        """Scale and offset under these number parameters; None if one is not given, or not above 0."""
        if self.times is None:
            return self
        number = product_of(numbers, self.times)
        return None if number is None else Linear(self.scale * number, self.offset * number)

    @property
    def as_quotient(self) -> tuple[int, int, int]:
        """Factor, addend and divisor, all integers: value = (raw * factor + addend) / divisor."""
        divisor = math.lcm(self.scale.denominator, self.offset.denominator)
        return int(self.scale * divisor), int(self.offset * divisor), divisor


@dataclass(frozen=True)
class Bound:
    """A bound of a range: `constant + coefficient * parameter`, with a number parameter."""

    constant: Fraction
    coefficient: Fraction = Fraction(0)
    parameter: str | None = None

    def at(self, numbers: Mapping[str, Fraction]) -> Fraction | None:
        """The bound under these number parameters; None if the parameter is not given."""
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
    """A name for one raw value of an enum or a number, or for one bit of flags (then `value` is the bit number).

    `renamed_from` is its name in previous editions. `without_effects` are names of effects that a command does not have if
    its request contains the value.
    """

    name: str
    renamed_from: str | None
    deprecated: Deprecation | None
    value: int
    without_effects: tuple[str, ...]
    title: Text
    about: Text


@dataclass(frozen=True, kw_only=True)
class NoValue(Member):
    """A name for raw integers of a number that mean that there is no value; an encoder writes `value`, the last one.

    If it `is_nan`, it is the name for NaN of a float, and `raws` are the bit patterns without the sign.
    """

    raws: range
    is_nan: bool

    def has(self, raw: int) -> bool:
        """Whether a raw integer has this name; NaN has it with either sign."""
        return raw in self.raws or (self.is_nan and raw - self.raws.stop in self.raws)


@dataclass(frozen=True, eq=False, kw_only=True)
class Type:
    """The conversion from raw bits to a value.

    `linear` is `Linear(1, 0)` if the spec gives no scale, and None if it states that the scale is unknown. `raw_range`
    limits the raw integer, of a float the value; it is None if all are allowed. It does not apply to `no_values`, which
    mean that a number has no value; an encoder without a name writes the first. `names` are shown beside the numbers.
    `plausible` are values that a working
    node reports; `is_plausible` compares. `differs` explains why scale or unit differ from those of other types of
    the same quantity.
    """

    name: str
    width: int
    encoding: Encoding
    order: Order
    unit: Unit | None
    linear: ByParameter[Linear]
    raw_range: ByParameter[Range]
    joined: Joined | None = None
    """How the elements of a field of this type are one value; None if each element has its own."""
    enum: tuple[Member, ...]
    flags: tuple[Member, ...]
    no_values: tuple[NoValue, ...]
    names: tuple[Member, ...]
    plausible: Range | None
    title: Text
    about: Text
    differs: Text
    path: DocumentPath

    @property
    def raw_limits(self) -> tuple[int, int]:
        """Smallest and largest raw integer of this width."""
        if self.encoding is Encoding.SIGNED:
            return -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1
        return 0, (1 << self.width) - 1

    @cached_property
    def number_limits(self) -> tuple[int, int]:
        """Smallest and largest raw integer of this width, without those at the ends that have no value."""
        low, high = self.raw_limits
        for no_value in sorted(self.no_values, key=lambda n: n.raws.start):
            low = no_value.raws.stop if no_value.raws.start == low else low
        for no_value in sorted(self.no_values, key=lambda n: -n.raws.stop):
            high = no_value.raws.start - 1 if no_value.raws.stop == high + 1 else high
        return low, high

    def no_value(self, raw: int) -> NoValue | None:
        """Why a raw integer has no value; None if it is a number."""
        return next((no_value for no_value in self.no_values if no_value.has(raw)), None)

    def name_of(self, raw: int) -> str:
        """The name that is shown beside the number of a raw integer; empty without one."""
        return next((member.name for member in self.names if member.value == raw), "")

    @property
    def members(self) -> tuple[Member, ...]:
        """All names of the type: of values, of bits, or of raw integers of a number."""
        return tuple(member for members in self.members_by_key.values() for member in members)

    @property
    def members_by_key(self) -> Mapping[str, tuple[Member, ...]]:
        """The names of the type by the key of the language that states them."""
        return {"enum": self.enum, "flags": self.flags, "no_value": self.no_values, "names": self.names}

    @property
    def is_number(self) -> bool:
        return not self.enum and not self.flags

    @property
    def accepts_every_raw(self) -> bool:
        """True if it is a number without limits, so that the bits of any frame are valid."""
        is_limited = any(span is not None for _, span in self.raw_range.distinct())
        return self.is_number and self.encoding is not Encoding.FLOAT and not is_limited

    @property
    def is_plain(self) -> bool:
        """True if the value is the raw integer, of each element if they are joined."""
        return self.is_number and self.encoding is not Encoding.FLOAT and self.linear == ByParameter.always(IDENTITY)

    @property
    def is_bare_float(self) -> bool:
        """True if the value is the number that the float has, so that there is no resolution."""
        return self.encoding is Encoding.FLOAT and self.linear == ByParameter.always(IDENTITY)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the choice parameters that scale and range depend on."""
        names = (self.linear.parameter, self.raw_range.parameter)
        return tuple(dict.fromkeys(name for name in names if name is not None))

    @property
    def times(self) -> tuple[str, ...]:
        """Names of the number parameters that scales are multiples of."""
        times = (linear.times for _, linear in self.linear.distinct() if linear is not None)
        return tuple(dict.fromkeys(name for factor in times if factor is not None for name in factors(factor).names))

    @cached_property
    def plausible_limits(self) -> tuple[float, float] | None:
        """The plausible range, rounded as values are; None without one."""
        span = self.plausible
        return None if span is None else (float(span.low.constant), float(span.high.constant))

    def is_plausible(self, value: object) -> bool:
        """Whether a working node reports a value; true for what is no number, as a name is."""
        limits = self.plausible_limits
        if limits is None or not isinstance(value, (int, float, Fraction)):
            return True
        return limits[0] <= float(value) <= limits[1]

    @cached_property
    def exemptions(self) -> tuple[tuple[str, Member], ...]:
        """Names of effects, each with a value without it."""
        return tuple((effect, member) for member in self.enum for effect in member.without_effects)

    @cached_property
    def numbers(self) -> tuple[str, ...]:
        """Names of the number parameters that scale and range depend on."""
        names: list[str | None] = list(self.times)
        spans = [span for _, span in self.raw_range.distinct() if span is not None]
        names += [end.parameter for span in spans for end in (span.low, span.high)]
        return tuple(dict.fromkeys(name for name in names if name is not None))


IDENTITY = Linear(Fraction(1), Fraction(0))
