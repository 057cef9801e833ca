"""Shared by the editions of a family: errors, parameters, numbers, messages."""

from __future__ import annotations

import math
import struct
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from enum import Enum, IntEnum, IntFlag
from fractions import Fraction
from functools import lru_cache
from math import floor
from operator import index
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

if TYPE_CHECKING:
    from typing_extensions import Self

Real = int | float | Fraction | Decimal
"""A number that is given as a value: a float counts as rounded, the others are exact."""

new = object.__new__
"""Makes an object without calling its constructor; a name of its own saves a look-up for each frame."""

USUAL_DLC = 8
"""The number of data bytes of a message that states no other; no limit."""


class Refusal(str, Enum):
    """Why a frame or a value is rejected."""

    UNKNOWN_ID = "unknown_id"
    UNKNOWN_CODE = "unknown_code"
    WRONG_LENGTH = "wrong_length"
    WRONG_CONSTANT = "wrong_constant"
    MISSING_PARAMETER = "missing_parameter"
    NO_SCALE = "no_scale"
    OUT_OF_RANGE = "out_of_range"
    NOT_FINITE = "not_finite"
    UNKNOWN_NODE = "unknown_node"
    NOT_ANSWER = "not_answer"
    NOT_AVAILABLE = "not_available"


class CodecError(ValueError):
    """A frame or a value is rejected: the reason as text and as `refusal`, and the `field` where one caused it."""

    def __init__(self, refusal: Refusal, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.refusal = refusal
        self.field = field

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.refusal, str(self), self.field)


class FieldAbsent(AttributeError):  # noqa: N818  the name reads well in an `except` clause
    """A field that this message does not have under its parameters."""


class NodeParameters:
    """The base class of the `Parameters` of every edition."""

    def __repr__(self) -> str:
        return shown_parameters(self, vars(self))


def shown_parameters(parameters: object, names: Iterable[str]) -> str:
    """The call that makes `Parameters` with those of some names that are known."""
    given = ((name, getattr(parameters, name)) for name in names)
    shown = (f"{name}={shown_choice(value)}" for name, value in given if value is not None)
    return f"Parameters({', '.join(shown)})"


def shown_choice(value: object) -> str:
    """The expression of the value of a parameter."""
    return str(value) if isinstance(value, Enum) else repr(value)


def known(parameters: object, name: str, what: str) -> Any:
    """The value of a parameter. Raises CodecError (missing_parameter) when it is unknown."""
    value = getattr(parameters, name)
    if value is None:
        raise missing(name, what)
    return value


def check_choice(value: object, name: str, *values: object) -> None:
    """Raises ValueError when a parameter is known and is none of its values."""
    if value is not None and value not in values:
        names = ", ".join(str(one.value if isinstance(one, Enum) else one) for one in values)
        raise ValueError(f"{name}={value!r} is none of {names}; leave it out when it is not known")


def check_number(value: Real | None, name: str, low: Real | None, high: Real | None) -> None:
    """Raises ValueError when a known parameter is outside its limits or too large, TypeError when it is no number."""
    if value is not None:
        try:
            number = Fraction(*ratio(value, name))
        except OverflowError:
            raise ValueError(f"{name} is larger than any float; leave it out when not known") from None
        if (low is not None and number < low) or (high is not None and number > high):
            ends = (f"at least {low}" if low is not None else "", f"at most {high}" if high is not None else "")
            raise ValueError(
                f"{name}={value!r} has to be {' and '.join(filter(None, ends))}; leave it out when not known"
            )


def missing(name: str, what: str) -> CodecError:
    """The error for a message or field that depends on an unknown parameter."""
    return CodecError(
        Refusal.MISSING_PARAMETER, f"{what} depends on {name}, which is not given; pass Parameters({name}=...)", what
    )


@lru_cache(maxsize=64, typed=True)
def _exact(value: Real) -> tuple[int, int]:
    """Numerator and denominator of a number as it is written: 0.3 is 3/10."""
    number = Fraction(str(value))
    return number.numerator, number.denominator


def above_zero(parameters: object, name: str, field: str) -> tuple[int, int]:
    """Numerator and denominator of a parameter that multiplies a scale. Raises CodecError unless it is above 0."""
    value = known(parameters, name, field)
    try:
        numerator, denominator = _exact(value)
    except (ValueError, ZeroDivisionError):
        text = f"{field} depends on {name}, and {value!r} is not a finite number"
        raise CodecError(Refusal.NOT_FINITE, text, field) from None
    if numerator <= 0:
        text = f"{field} depends on {name}, which has to be above 0 and is {value!r}"
        raise CodecError(Refusal.OUT_OF_RANGE, text, field)
    return numerator, denominator


def ratio(value: Real, field: str) -> tuple[int, int]:
    """Numerator and denominator of a number, exactly.

    Raises TypeError (no number), CodecError (not_finite), OverflowError (larger than any float).
    """
    try:
        is_finite = math.isfinite(value)
    except TypeError:
        raise TypeError(f"{field}={value!r} is no number") from None
    if not is_finite:
        raise CodecError(Refusal.NOT_FINITE, f"{field}={float(value)!r} is not a finite number", field)
    if hasattr(value, "as_integer_ratio"):
        return value.as_integer_ratio()
    return integer(value, field), 1


def nearest(numerator: int, denominator: int) -> int:
    """The integer nearest to a quotient, ties away from zero; exact."""
    size = (2 * abs(numerator) + abs(denominator)) // (2 * abs(denominator))
    return size if (numerator < 0) == (denominator < 0) else -size


def integer(raw: Any, field: str) -> int:
    """An integer, an enum member, flags or a bool as an integer. Raises TypeError for anything else."""
    try:
        return index(raw)
    except TypeError:
        raise TypeError(f"{field}={raw!r} is no integer") from None


class Bound:
    """An end of a range of raw integers: a number, or `factor * parameter + number`."""

    __slots__ = ("factor", "number", "parameter")

    def __init__(self, number: Fraction | int, factor: Fraction | int = 0, parameter: str = "") -> None:
        self.number = number
        self.factor = factor
        self.parameter = parameter

    def at(self, parameters: object) -> Fraction | None:
        """The bound under these parameters; None when its parameter is unknown."""
        if not self.parameter:
            return Fraction(self.number)
        value = getattr(parameters, self.parameter)
        return None if value is None else self.factor * Fraction(str(value)) + self.number


Limits = tuple[Bound, Bound]

Scale = tuple[int, int, int | Fraction]
"""Numerator, denominator and offset: value = raw * numerator / denominator + offset."""

Line = tuple[int, int, int]
"""Factor, addend and divisor: value = (raw * factor + addend) / divisor."""


def line_of(scale: Scale | None) -> Line | None:
    """A scale and its offset as one quotient of integers."""
    if scale is None:
        return None
    numerator, denominator, offset = scale
    divisor = math.lcm(denominator, Fraction(offset).denominator)
    return numerator * (divisor // denominator), int(offset * divisor), divisor


class FieldType(ABC):
    """How the raw integer of a field becomes a value. `unit` is the name of its unit, empty without one."""

    __slots__ = ("unit",)

    def __init__(self, unit: str = "") -> None:
        self.unit = unit

    @abstractmethod
    def value(self, raw: Any, parameters: object, field: str) -> Any:
        """The value of a raw integer. Raises CodecError when it has none under these parameters."""

    @abstractmethod
    def raw(self, value: Any, parameters: object, field: str) -> Any:
        """The raw integer of a value. Raises CodecError when it is out of range, TypeError for another kind of value."""

    @abstractmethod
    def check(self, raw: Any, parameters: object, field: str) -> Any:
        """The raw integer itself. Raises CodecError when it is out of range, TypeError when it is no integer."""

    @abstractmethod
    def raw_range(self, parameters: object) -> tuple[int, int]:
        """Smallest and largest raw integer under these parameters."""

    def value_range(self, parameters: object) -> tuple[float, float]:
        """Smallest and largest value under these parameters. Raises CodecError when there is no scale."""
        low, high = (self.value(raw, parameters, "the range") for raw in self.raw_range(parameters))
        return (low, high) if low <= high else (high, low)


Steps = tuple[float, float, float]
"""Offset, denominator and numerator of a scale: raw = (value - offset) * denominator / numerator."""

COARSE = 1 << 51
"""From here on, a quotient of floats is too coarse for the nearest integer, and the exact quotient is used."""


def steps_of(scale: Scale) -> Steps:
    """The floats of a scale."""
    numerator, denominator, offset = scale
    return rounded(offset), rounded(denominator), rounded(numerator)


def rounded(number: int | Fraction) -> float:
    """The nearest float, infinity beyond the largest one."""
    try:
        return float(number)
    except OverflowError:
        return math.inf if number > 0 else -math.inf


DOUBLE = 8
"""The bytes of a float of Python."""


def to_odd(exact: Fraction) -> float:
    """The float next to a number with an odd last bit, unless it is exact; rounded to 32 bits, it is rounded only once."""
    number = float(exact)
    if number == exact or struct.pack("<d", number)[0] & 1:
        return number
    return math.nextafter(number, math.inf if exact > number else -math.inf)


Fast = tuple[float, float, int, int]
"""A conversion by floats: raw integers per unit, raw integer of the value 0 plus a half, smallest and largest raw."""

FAST_LIMIT = 1 << 32
"""The largest raw integers and offsets that are converted by floats.

`floor(value * steps + zero)` is the nearest raw integer unless rounding errors move the sum across an integer. There
are five roundings: of an integer value, `steps`, `zero`, product and sum. Each is at most 2**-53 of a number below
2**34, so all of them are less than 0.001. A sum that is closer to an integer than that is not used.
"""


class Number(FieldType):
    """Converts between raw integers and values.

    `scale` is None where the specification gives none. With `scale_by`, it is a table of scales by the values of that
    parameter. `times` names a number parameter that multiplies scale and offset; with `scale_by` it is a table as well.
    `limits` is the raw range that the specification sets within `low` and `high`, those of the bits; with `limits_by`
    it is a table of ranges.
    """

    __slots__ = (
        "_by",
        "_exact",
        "_fast",
        "_fast_by",
        "_lines",
        "_scales",
        "_span",
        "high",
        "limits",
        "limits_by",
        "low",
        "scale_by",
        "times",
    )

    def __init__(
        self,
        low: int,
        high: int,
        unit: str = "",
        *,
        scale: Scale | Mapping[Any, Scale | None] | None = (1, 1, 0),
        scale_by: str = "",
        times: str | Mapping[Any, str] = "",
        limits: Limits | Mapping[Any, Limits | None] | None = None,
        limits_by: str = "",
    ) -> None:
        super().__init__(unit)
        self.low = low
        self.high = high
        self.scale_by = scale_by
        self.times: Any = times
        self.limits: Any = limits
        self.limits_by = limits_by
        scales = scale if isinstance(scale, Mapping) else {None: scale}
        self._lines: dict[Any, Line | None] = {key: line_of(one) for key, one in scales.items()}
        self._scales: dict[Any, Steps] = {key: steps_of(one) for key, one in scales.items() if one is not None}
        self._exact = self._exact_steps() if scale_by else {}
        self._span: tuple[int, int] | None = None
        always = None if limits_by else self._limits_at(None)
        if not limits_by and not any(bound.parameter for bound in always or ()):
            self._span = self._span_within(always, None)
        self._by = scale_by or limits_by
        self._fast_by = self._fast_conversions()
        self._fast = self._fast_by.get(None)

    def _exact_steps(self) -> dict[Any, float]:
        """The scales that are exact floats, by the parameter; raw integers are too, so a product is rounded once."""
        largest = max(-self.low, self.high)
        return {
            key: line[0] / line[2]
            for key, line in self._lines.items()
            if line is not None
            and not (self.times and self.times.get(key))
            and line[1] == 0
            and line[0] > 0
            and line[2].bit_count() == 1
            and max(line[0], line[2], largest) <= 1 << 53
        }

    def _fast_conversions(self) -> dict[Any, Fast]:
        """The conversions that floats do with certainty, by the value of the parameter; by None without one."""
        if self.scale_by and self.limits_by and self.scale_by != self.limits_by:
            return {}
        found: dict[Any, Fast] = {}
        for key in self._lines if self.scale_by else self.limits if self.limits_by else (None,):
            line = self._lines[key if self.scale_by else None]
            limits = self.limits.get(key) if self.limits_by else self.limits
            times = self.times.get(key) if self.scale_by and self.times else self.times
            if line is None or times or (limits and any(bound.parameter for bound in limits)):
                continue
            factor, addend, divisor = line
            low, high = self._span_within(limits, None)
            try:
                steps, zero = divisor / factor, 0.5 - addend / factor
            except OverflowError:
                continue
            if max(-low, high, abs(zero)) <= FAST_LIMIT:
                found[key] = (steps, zero, low, high)
        return found

    def _line_at(self, parameters: object, field: str) -> Line:
        """The line under these parameters. Raises CodecError (missing_parameter, no_scale, out_of_range)."""
        key = known(parameters, self.scale_by, field) if self.scale_by else None
        line = self._lines.get(key)
        if line is None:
            raise CodecError(Refusal.NO_SCALE, f"{field} has no scale here; use {field}_raw", field)
        times = self.times.get(key) if self.scale_by and self.times else self.times
        if not times:
            return line
        numerator, denominator = above_zero(parameters, times, field)
        factor, addend, divisor = line
        return factor * numerator, addend * numerator, divisor * denominator

    def value(self, raw: int, parameters: object, field: str) -> float:
        """The value of a raw integer, rounded to the nearest float. Raises CodecError when it has none."""
        step = self._exact.get(getattr(parameters, self.scale_by)) if self.scale_by else None
        if step is not None:
            return raw * step
        factor, addend, divisor = self._line_at(parameters, field)
        try:
            return (raw * factor + addend) / divisor
        except OverflowError:
            text = f"{field} is larger than any float under these parameters"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field) from None

    def raw(self, value: Real, parameters: object, field: str) -> int:
        """The raw integer nearest to a value, ties away from zero. Raises CodecError when the value is rejected.

        An int, a Fraction and a Decimal are exact. A float is divided by the scale as a float, so 0.15 at a scale of 0.1
        is 2, as it looks, although the float 0.15 is less than that; from 2**51 on, it is exact as well.
        """
        fast = self._fast
        if fast is None and self._by:
            fast = self._fast_by.get(getattr(parameters, self._by))
        if fast is not None and (type(value) is float or type(value) is int):
            steps, zero, low, high = fast
            try:
                quotient = value * steps + zero
                raw = floor(quotient)
            except (OverflowError, ValueError):
                return self._raw(value, parameters, field)
            if 0.001 < quotient - raw < 0.999 and low <= raw <= high:
                return raw
        return self._raw(value, parameters, field)

    def _raw(self, value: Real, parameters: object, field: str) -> int:
        """The same without shortcuts."""
        factor, addend, divisor = self._line_at(parameters, field)
        try:
            numerator, denominator = ratio(value, field)
            quotient = self._quotient(value, parameters, field) if isinstance(value, float) else math.inf
            if abs(quotient) < COARSE:
                raw = nearest(*quotient.as_integer_ratio())
            else:
                raw = nearest(numerator * divisor - addend * denominator, denominator * factor)
        except OverflowError:
            raise self._out_of_range(shown(value) + self._suffix, parameters, field) from None
        low, high = self.raw_range(parameters)
        if not low <= raw <= high:
            # floats this large look equal although their raw integers differ
            found = f" (raw {raw})" if COARSE <= abs(raw) < 1 << 64 else ""
            raise self._out_of_range(shown(value) + self._suffix + found, parameters, field)
        return raw

    def _quotient(self, value: float, parameters: object, field: str) -> float:
        """The raw number of a value, each operation rounded; infinite where a number is too large for this."""
        key = getattr(parameters, self.scale_by) if self.scale_by else None
        times = self.times.get(key) if self.scale_by and self.times else self.times
        if times:
            above, below = above_zero(parameters, times, field)
            value = value * rounded(below) / rounded(above)
        offset, denominator, numerator = self._scales[key]
        return (value - offset) * denominator / numerator

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself. Raises CodecError when it is out of range, TypeError when it is no integer."""
        raw = integer(raw, field)
        low, high = self._span or self.raw_range(parameters)
        if not low <= raw <= high:
            raise self._out_of_range(f"raw {raw}", parameters, field)
        return raw

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """Smallest and largest raw integer under these parameters."""
        if self._span is not None:
            return self._span
        return self._span_within(self._limits_at(parameters), parameters)

    def _limits_at(self, parameters: object) -> Limits | None:
        """The range that the specification sets under these parameters."""
        limits: Limits | None = self.limits.get(getattr(parameters, self.limits_by)) if self.limits_by else self.limits
        return limits

    def _span_within(self, limits: Limits | None, parameters: object) -> tuple[int, int]:
        if limits is None:
            return self.low, self.high
        low, high = limits[0].at(parameters), limits[1].at(parameters)
        return (
            self.low if low is None else max(self.low, math.ceil(low)),
            self.high if high is None else min(self.high, floor(high)),
        )

    @property
    def _suffix(self) -> str:
        """The unit behind a number."""
        return f" {self.unit}" if self.unit else ""

    def _out_of_range(self, given: str, parameters: object, field: str) -> CodecError:
        low, high = self.raw_range(parameters)
        text = f"raw {low}..{high}"
        try:
            first, last = self.value_range(parameters)
            text = f"{first}..{last}{self._suffix} ({text})"
        except CodecError:
            pass
        return CodecError(Refusal.OUT_OF_RANGE, f"{field}={given} is out of range {text}", field)


def shown(value: object) -> str:
    """A number in an error message; Python refuses to print very long ones."""
    try:
        return repr(value)
    except ValueError:
        return f"a very large {type(value).__name__}"


class Integer(Number):
    """A number whose value is its raw integer."""

    __slots__ = ()

    def value(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself."""
        return raw

    def raw(self, value: Real, parameters: object, field: str) -> int:
        """The integer nearest to a value, ties away from zero. Raises CodecError when the value is rejected."""
        if type(value) is int and self._span is not None and self._span[0] <= value <= self._span[1]:
            return value
        return super().raw(value, parameters, field)


class Float(Number):
    """An IEEE float. Its raw integer is its bit pattern; scale and limits apply to the float."""

    __slots__ = ("_bits", "_number")

    def __init__(
        self,
        width: int,
        unit: str = "",
        *,
        scale: Scale | Mapping[Any, Scale | None] | None = (1, 1, 0),
        scale_by: str = "",
        limits: Limits | Mapping[Any, Limits | None] | None = None,
        limits_by: str = "",
    ) -> None:
        super().__init__(0, (1 << width) - 1, unit, scale=scale, scale_by=scale_by, limits=limits, limits_by=limits_by)
        self._bits = struct.Struct("<I" if width == 32 else "<Q")
        self._number = struct.Struct("<f" if width == 32 else "<d")

    def value(self, raw: int, parameters: object, field: str) -> float:
        """The scaled float with this bit pattern; each operation is rounded."""
        self._line_at(parameters, field)
        number: float = self._number.unpack(self._bits.pack(raw))[0]
        offset, denominator, numerator = self._scales[getattr(parameters, self.scale_by) if self.scale_by else None]
        scaled = number * numerator / denominator
        return scaled + offset if offset else scaled

    def raw(self, value: Real, parameters: object, field: str) -> int:
        """The bit pattern of the nearest float. Raises CodecError when the value is rejected.

        An int, a Fraction and a Decimal are rounded once, a float in each operation.
        """
        factor, addend, divisor = self._line_at(parameters, field)
        try:
            numerator, denominator = ratio(value, field)
            if isinstance(value, float):
                number = self._quotient(value, parameters, field)
            else:
                exact = Fraction(numerator * divisor - addend * denominator, denominator * factor)
                number = float(exact) if self._number.size == DOUBLE else to_odd(exact)
            if not math.isfinite(number):
                raise OverflowError
            bits: int = self._bits.unpack(self._number.pack(number))[0]
        except OverflowError:
            text = f"{field}={shown(value)} is too large for its float"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field) from None
        return self.check(bits, parameters, field)

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The bit pattern itself. Raises CodecError when its value is out of range or not finite."""
        if not 0 <= integer(raw, field) <= self.high:
            raise CodecError(Refusal.OUT_OF_RANGE, f"{field}=raw {raw} is out of range 0..{self.high}", field)
        if not math.isfinite(self._number.unpack(self._bits.pack(raw))[0]):
            raise CodecError(Refusal.NOT_FINITE, f"{field}=raw {raw} is not a finite number", field)
        low, high = self._ends(parameters)
        if low is not None or high is not None:
            # the value as a float may have been rounded to an end of the range
            factor, addend, divisor = self._line_at(parameters, field)
            number: float = self._number.unpack(self._bits.pack(raw))[0]
            value = (Fraction(number) * factor + addend) / divisor if math.isfinite(number) else None
            if value is None or (low is not None and value < low) or (high is not None and value > high):
                first, last = self.value_range(parameters)
                given = f"{field}={self.value(raw, parameters, field)!r}{self._suffix}"
                raise CodecError(Refusal.OUT_OF_RANGE, f"{given} is out of range {first}..{last}", field)
        return index(raw)

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """The range of bit patterns; limits apply to the float."""
        return self.low, self.high

    def value_range(self, parameters: object) -> tuple[float, float]:
        """Smallest and largest value under these parameters."""
        low, high = self._ends(parameters)
        return -math.inf if low is None else float(low), math.inf if high is None else float(high)

    def _ends(self, parameters: object) -> tuple[Fraction | None, Fraction | None]:
        limits = self._limits_at(parameters)
        return (None, None) if limits is None else (limits[0].at(parameters), limits[1].at(parameters))


E = TypeVar("E", bound=IntEnum)
F = TypeVar("F", bound=IntFlag)


class EnumType(FieldType, Generic[E]):
    """Values with names: the members of an enum."""

    __slots__ = ("members",)

    def __init__(self, enum: type[E]) -> None:
        super().__init__()
        self.members: dict[int, E] = {int(one): one for one in enum}

    def value(self, raw: int, parameters: object, field: str) -> E | int:
        """The member of that value; the raw integer where no member has it."""
        return self.members.get(raw, raw)

    def raw(self, value: int, parameters: object, field: str) -> int:
        """The integer of a member. Raises CodecError when no member has it."""
        return self.check(value, parameters, field)

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself. Raises CodecError when no member has it, TypeError when it is no integer."""
        if integer(raw, field) not in self.members:
            names = ", ".join(map(str, sorted(self.members)))
            text = f"{field}={index(raw)} is none of the values {names}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return int(raw)

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """The smallest and the largest value; those between need not have names."""
        return min(self.members), max(self.members)


class FlagsType(FieldType, Generic[F]):
    """Bits with names."""

    __slots__ = ("_known", "enum", "mask")

    def __init__(self, enum: type[F], mask: int) -> None:
        super().__init__()
        self.enum = enum
        self.mask = mask
        self._known: dict[int, F] = {}

    def value(self, raw: int, parameters: object, field: str) -> F:
        """The set bits. Those of one raw integer are made once, because that is slow."""
        value = self._known.get(raw)
        if value is None:
            value = self._known[raw] = self.enum(raw)
        return value

    def raw(self, value: int, parameters: object, field: str) -> int:
        """The set bits as an integer. Raises CodecError when one has no name."""
        return self.check(value, parameters, field)

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself. Raises CodecError when a set bit has no name, TypeError when it is no integer."""
        if integer(raw, field) & ~self.mask:
            text = f"{field}=0x{index(raw):X} sets bits without a name; the named ones are 0x{self.mask:X}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return int(raw)

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """No bit, and all bits with names."""
        return 0, self.mask


class ArrayType(FieldType):
    """Several values of one type."""

    __slots__ = ("count", "type")

    def __init__(self, type_: FieldType, count: int) -> None:
        super().__init__(type_.unit)
        self.type = type_
        self.count = count

    def value(self, raw: Iterable[int], parameters: object, field: str) -> tuple[Any, ...]:
        """The value of every element."""
        return tuple(self.type.value(one, parameters, field) for one in raw)

    def raw(self, value: Iterable[Any], parameters: object, field: str) -> tuple[int, ...]:
        """The raw integer of every element. Raises CodecError when one is rejected or their number is wrong."""
        return tuple(self.type.raw(one, parameters, field) for one in self._all(value, field))

    def check(self, raw: Iterable[int], parameters: object, field: str) -> tuple[int, ...]:
        """The raw integers themselves. Raises CodecError when one is out of range or their number is wrong."""
        return tuple(self.type.check(one, parameters, field) for one in self._all(raw, field))

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """The range of each element."""
        return self.type.raw_range(parameters)

    def value_range(self, parameters: object) -> tuple[float, float]:
        """The range of each element."""
        return self.type.value_range(parameters)

    def _all(self, given: Any, field: str) -> tuple[Any, ...]:
        try:
            found: tuple[Any, ...] = tuple(given)
        except TypeError:
            raise TypeError(f"{field}={given!r} is no array; it needs {self.count} elements") from None
        if len(found) != self.count:
            text = f"{field} has {len(found)} elements, but needs {self.count}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return found


def node_in(node: int | None, first: int, last: int) -> int:
    """The node itself. Raises CodecError (unknown_node) when the address has no such node, TypeError for no integer."""
    if node is None or not first <= integer(node, "node") <= last:
        raise CodecError(Refusal.UNKNOWN_NODE, f"there is no node {node}; nodes are {first}..{last}", "node")
    return index(node)


M = TypeVar("M")


def immutable(cls: type[M]) -> type[M]:
    """The class itself; to set or to delete one of its properties is an error that names `replace()`."""
    for name, member in list(vars(cls).items()):
        if isinstance(member, property):
            refuse = _refuse(name)
            setattr(cls, name, property(member.fget, refuse, refuse, member.__doc__))
    return cls


def _refuse(name: str) -> Callable[..., None]:
    def refuse(message: Message, *value: object) -> None:
        text = f"{type(message).__name__} is immutable, so {name} cannot be changed; replace() makes a changed copy"
        raise AttributeError(text)

    return refuse


@immutable
class Message:
    """One frame, stored as raw integers; immutable. Values in units are computed on access."""

    __slots__ = ("_checked", "_node", "_parameters", "_raws")

    COMMAND: ClassVar[str] = ""
    """The command of this request or reply."""
    DIRECTION: ClassVar[str]
    """`request` or `reply`."""
    DLC: ClassVar[int] = USUAL_DLC
    """Number of data bytes."""
    ID: ClassVar[int]
    """The CAN id, without the node."""
    NODE_STEP: ClassVar[int] = 1
    """The distance between the CAN ids of neighbouring nodes."""
    NODES: ClassVar[tuple[int, int]]
    """First and last node in the id."""
    NODE_FIELD: ClassVar[str] = ""
    """The field with the node or its low bits; empty without one."""
    NODE_MASK: ClassVar[int] = -1
    """The bits of the node that `NODE_FIELD` has."""
    CODE: ClassVar[int]
    """The selector's value."""
    TITLE: ClassVar[str] = ""
    """The title of the command. This and the next four are set on requests, and on replies without a request."""
    MANUAL: ClassVar[str] = ""
    """The manual's section."""
    EFFECTS: ClassVar[tuple[str, ...]] = ()
    """The effects of sending it besides its reply."""
    LIMITED_BY: ClassVar[tuple[str, ...]] = ()
    """The settings of the host that limit it."""
    ONLY: ClassVar[Mapping[str, tuple[object, ...]]] = {}
    """The parameter values of the nodes that support it, by parameter; empty where every node supports it."""
    DEFAULTS: ClassVar[Any] = None
    """The parameters of a message that is made without any."""
    EXTENDED: ClassVar[bool] = False
    """True when the id is a 29-bit one."""
    REMOTE: ClassVar[bool] = False
    """True for a remote frame."""
    DEPENDS: ClassVar[tuple[str, ...]] = ()
    """The parameters on which fields, values or ranges depend."""
    TYPES: ClassVar[Mapping[str, FieldType]] = {}
    """The type of each field by name, in the order of the specification: its unit, range and conversions."""
    VARIANTS: ClassVar[tuple[tuple[str | None, ...], ...]] = ()
    """The field of each raw integer in each variant, where that depends on a parameter; None where there is none."""
    VARIANT_BY: ClassVar[str] = ""
    """The parameter that decides on the variant."""
    VARIANT_OF: ClassVar[Mapping[Any, int]] = {}
    """The index of the variant by the value of that parameter."""

    _nodes: ClassVar[range] = range(0)
    """The nodes. Constructors look there first: calling `_known_node` takes longer."""
    _checked: bool
    """Whether the raw integers and the node are known to be valid."""
    _node: Any
    """The node in the id."""
    _parameters: Any
    _raws: Any
    """The raw integer of each field, a tuple of them for an array. Fields that never exist together share a place."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        immutable(cls)
        if "NODES" in vars(cls):
            cls._nodes = range(cls.NODES[0], cls.NODES[1] + 1)

    @property
    def node(self) -> Any:
        """The node that receives or sends this frame; None where neither the id nor the data identifies it."""
        return self._node

    @property
    def parameters(self) -> Any:
        """The `Parameters` of the node."""
        return self._parameters

    @property
    def can_id(self) -> int:
        """The CAN id of this frame."""
        return self.ID + (self._node or 0) * self.NODE_STEP

    def encode(self) -> bytes:
        """The data bytes of this frame; reserved bits are 0. Raises CodecError as `check` does."""
        if not self._checked:
            self.check()
        return self.encode_unchecked()

    def encode_unchecked(self) -> bytes:
        """The data bytes of this frame, also where `encode` refuses: every field of a decoded frame as it was received.

        A message does not store selectors and reserved bits: they are those of the specification.
        """
        raise TypeError(f"{type(self).__name__} is only a base class")

    def check(self) -> None:
        """Raises CodecError if the node or a raw integer is out of range, or has no name in its enum or flags.

        The node is checked first, then the fields in the order of the specification, as in every language.

        Messages from constructors, `from_raw` and `replace` have been checked already; decoded ones have not.
        """
        self._known_node(self._node)
        raws = self.raw()
        for name in self._in_order_of_checks():
            self.TYPES[name].check(raws[name], self._parameters, name)
        self._checked = True

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Self:
        """The message in these data bytes. Id, length and selector have been checked already."""
        raise TypeError(f"{cls.__name__} is only a base class")

    @classmethod
    def from_raw(cls, *, node: int | None = None, parameters: Any = None, **raw: Any) -> Self:
        """The message with these raw integers, by field.

        Raises CodecError (a raw integer is out of range), FieldAbsent (a field does not exist under the parameters),
        TypeError (other names, or a field is missing).
        """
        self = new(cls)
        self._node = self._known_node(node)
        self._parameters = cls.DEFAULTS if parameters is None else parameters
        names = self._in_order_of_checks()
        for name in raw:
            if name in cls.TYPES and name not in names:
                raise self._absent(name)
        if set(raw) != set(names):
            raise TypeError(f"{cls.__name__}.from_raw takes {', '.join(names) or 'no field'}")
        checked = {name: cls.TYPES[name].check(raw[name], self._parameters, name) for name in names}
        self._raws = tuple(None if name is None else checked[name] for name in self._places())
        self._checked = True
        return self

    def replace(self, **values: Any) -> Self:
        """A copy with other values of some fields; `node` and `parameters` can be replaced too.

        The other fields keep their raw integers. Raises CodecError as `check` does, FieldAbsent where a field does not
        exist under the parameters, and TypeError for other names.
        """
        parameters = values.pop("parameters", self._parameters)
        node = self._known_node(values.pop("node", self._node))
        raws = self.raw()
        for name, value in values.items():
            if name not in self.TYPES:
                raise TypeError(f"{type(self).__name__} has no {name}; it has {', '.join(self.TYPES) or 'no field'}")
            raws[name] = self.TYPES[name].raw(value, parameters, name)
        return self.from_raw(node=node, parameters=parameters, **raws)

    def fields(self) -> tuple[str, ...]:
        """Names of the fields that exist under the parameters."""
        return tuple(name for name in self._places() if name is not None)

    def raw(self) -> dict[str, Any]:
        """The raw integer, or integers, of every field that exists under the parameters."""
        return {name: raw for name, raw in zip(self._places(), self._raws, strict=True) if name is not None}

    def values(self) -> dict[str, Any]:
        """The value of every field that exists under the parameters; None where it has no scale or a parameter is unknown."""
        found: dict[str, Any] = {}
        for name in self.fields():
            try:
                found[name] = getattr(self, name)
            except CodecError:
                found[name] = None
        return found

    def _places(self) -> tuple[str | None, ...]:
        """The field of each raw integer under the parameters. Raises CodecError (missing_parameter)."""
        if not self.VARIANT_BY:
            return tuple(self.TYPES)
        return self.VARIANTS[self._variant()]

    def _in_order_of_checks(self) -> list[str]:
        """Names of the fields that exist, in the order of the specification, so that every language rejects the same field."""
        there = self.fields()
        return [name for name in self.TYPES if name in there]

    def _variant(self) -> int:
        return self.VARIANT_OF[known(self._parameters, self.VARIANT_BY, type(self).__name__)]

    def _known_node(self, node: int | None) -> int | None:
        """The node itself. Raises CodecError (unknown_node), and TypeError where the id has no node."""
        name = type(self).__name__
        if not self.COMMAND:
            raise TypeError(f"{name} is only a base class; use the class of a request or a reply")
        if self._nodes:
            return node_in(node, *self.NODES)
        if node is not None:
            raise TypeError(f"{name} has no node, its id is fixed")
        return None

    def _raws_of(self, **values: Any) -> tuple[Any, ...]:
        """The raw integers of the values of all fields, where None stands for a field that does not exist.

        Raises CodecError, TypeError (a field is missing), FieldAbsent (a field does not exist).
        """
        places = self._places()
        for name, value in values.items():
            if value is None and name in places:
                raise TypeError(f"{type(self).__name__} needs {name} under {self._parameters}")
            if value is not None and name not in places:
                raise FieldAbsent(f"{type(self).__name__} has no {name} under {self._parameters}")
        names = self._in_order_of_checks()
        raws = {name: self.TYPES[name].raw(values[name], self._parameters, name) for name in names}
        return tuple(None if name is None else raws[name] for name in places)

    def _absent(self, name: str) -> FieldAbsent:
        """The error for a field that does not exist under the parameters."""
        there = ", ".join(self.fields())
        return FieldAbsent(f"{type(self).__name__} has no {name} under {self._parameters}; it has {there}")

    def __repr__(self) -> str:
        parts = [f"node={self._node}"] if self._node is not None else []
        for name, raw in self.raw().items():
            try:
                parts.append(f"{name}={getattr(self, name)!r}")
            except CodecError:
                parts.append(f"{name}_raw={raw!r}")
        if any(getattr(self._parameters, name) is not None for name in self.DEPENDS):
            parts.append(f"parameters={shown_parameters(self._parameters, self.DEPENDS)}")
        return f"{type(self).__name__}({', '.join(parts)})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Message) or type(self) is not type(other):
            return NotImplemented
        if self._raws != other._raws or self._node != other._node:
            return False
        ours, theirs = self._parameters, other._parameters
        return ours is theirs or all(getattr(ours, name) == getattr(theirs, name) for name in self.DEPENDS)

    def __hash__(self) -> int:
        # equal messages have equal hashes, whatever their parameters are
        return hash((type(self), self._node, self._raws))


R = TypeVar("R", bound=Message)


class Request(Message, Generic[R]):
    """A frame from host to node; `R` is its reply."""

    __slots__ = ()


class Reply(Message):
    """A frame from node to host."""

    __slots__ = ()


class Bare(Message):
    """A frame without fields; its data bytes are always the same."""

    __slots__ = ()

    DATA: ClassVar[bytes]

    def encode_unchecked(self) -> bytes:
        """The data bytes of this frame; a remote frame has none."""
        return b"" if self.REMOTE else self.DATA

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Self:
        """The message in these data bytes. Id, length and selector have been checked already."""
        self = new(cls)
        self._node = node
        self._parameters = parameters
        self._raws = ()
        self._checked = True
        return self


class ToNode(Bare):
    """A frame without fields, to or from a node."""

    __slots__ = ()

    def __init__(self, *, node: int) -> None:
        self._node = self._known_node(node)
        self._parameters = None
        self._raws = ()
        self._checked = True


class ToAll(Bare):
    """A frame without fields, on an id without a node."""

    __slots__ = ()

    def __init__(self) -> None:
        self._node = self._known_node(None)
        self._parameters = None
        self._raws = ()
        self._checked = True


def constant(found: int, wanted: int, field: str) -> None:
    """Checks a field that always has the same value. Raises CodecError (wrong_constant)."""
    if found != wanted:
        raise CodecError(Refusal.WRONG_CONSTANT, f"{field} is 0x{found:X}, always 0x{wanted:X} in this frame", field)


def merge(little: int, big: int, length: int) -> bytes:
    """Data bytes with little-endian and big-endian fields."""
    return bytes(a | b for a, b in zip(little.to_bytes(length, "little"), big.to_bytes(length, "big"), strict=True))
