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
from operator import attrgetter, index
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar

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
    WRONG_CHECKSUM = "wrong_checksum"
    NO_VALUE = "no_value"
    WRONG_MESSAGE = "wrong_message"


class CodecError(ValueError):
    """A frame or a value is rejected: the reason as text and as `refusal`, and the `field` where one caused it.

    The text about a frame is a function that computes it when it is read: programs that skip foreign frames do not.
    """

    __slots__ = ("field", "refusal")

    def __init__(self, refusal: Refusal, message: str | Callable[[], str], field: str | None = None) -> None:
        self.args = (message,)
        self.refusal = refusal
        self.field = field

    def __str__(self) -> str:
        (message,) = self.args
        return message if isinstance(message, str) else message()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.refusal!r}, {str(self)!r}, {self.field!r})"

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


def known(parameters: object, name: str, field: str | None, what: str = "") -> Any:
    """The value of a parameter on which a field depends, or else `what`. Raises CodecError (missing_parameter)."""
    value = getattr(parameters, name)
    if value is None:
        raise missing(name, field, what)
    return value


def check_choice(value: object, name: str, *values: object) -> None:
    """Raises ValueError when a parameter is known and is none of its values."""
    if value is not None and value not in values:
        names = ", ".join(str(one.value if isinstance(one, Enum) else one) for one in values)
        raise ValueError(f"{name}={value!r} is none of {names}; leave it out when it is not known")


def check_number(value: Real | None, name: str, low: Real | None, high: Real | None, *, is_whole: bool = False) -> None:
    """Raises ValueError when a known parameter is outside its limits or too large, TypeError when it is no number."""
    if value is not None:
        try:
            number = Fraction(*ratio(value, name))
        except OverflowError:
            raise ValueError(f"{name} is larger than any float; leave it out when not known") from None
        if is_whole and number.denominator != 1:
            raise ValueError(f"{name}={value!r} has to be a whole number; leave it out when not known")
        if (low is not None and number < low) or (high is not None and number > high):
            ends = (f"at least {low}" if low is not None else "", f"at most {high}" if high is not None else "")
            raise ValueError(
                f"{name}={value!r} has to be {' and '.join(filter(None, ends))}; leave it out when not known"
            )


def whole(parameters: object, name: str, field: str | None, what: str = "") -> int:
    """The value of a parameter that ids or constants contain. Raises CodecError (missing_parameter) when it is unknown."""
    return int(known(parameters, name, field, what))


def missing(name: str, field: str | None, what: str = "") -> CodecError:
    """The error for a field, or else for `what`, that depends on an unknown parameter."""
    text = f"{what or field} depends on {name}, which is not given; pass Parameters({name}=...)"
    return CodecError(Refusal.MISSING_PARAMETER, text, field)


@lru_cache(maxsize=64, typed=True)
def _exact(value: Real) -> tuple[int, int]:
    """Numerator and denominator of a number as it is written: 0.3 is 3/10."""
    number = Fraction(str(value))
    return number.numerator, number.denominator


def above_zero(parameters: object, times: str, field: str) -> tuple[int, int]:
    """Numerator and denominator of the factor of a scale: a parameter, or several as in `a*b/c`.

    Raises CodecError unless all are above 0.
    """
    if times.isidentifier():
        return _above_zero(parameters, times, field)
    above, _, below = times.partition("/")
    numerator, denominator = 1, 1
    for name in filter(None, above.split("*")):
        factor, divisor = _above_zero(parameters, name, field)
        numerator, denominator = numerator * factor, denominator * divisor
    if below:
        divisor, factor = _above_zero(parameters, below, field)
        numerator, denominator = numerator * factor, denominator * divisor
    return numerator, denominator


def _above_zero(parameters: object, name: str, field: str) -> tuple[int, int]:
    """The same of one parameter."""
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


def raw_of_name(name: str, names: Mapping[str, int], field: str) -> int:
    """The raw integer of a name. Raises CodecError for another name, TypeError when numbers have no names."""
    if not names:
        raise TypeError(f"{field}={name!r} is no number")
    if name not in names:
        text = f"{field}={name!r} is no number and none of the names {', '.join(names)}"
        raise CodecError(Refusal.OUT_OF_RANGE, text, field)
    return names[name]


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

    takes_none: ClassVar[bool] = False
    """Whether None is a value."""

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

    def no_value(self, raw: Any) -> Any:
        """The name for which a raw integer is no number, such as `not_available`; None for one with a value."""
        return None

    def name(self, raw: Any) -> Any:
        """The name that a raw integer of a number has beside its value, such as `maximum`; None without one."""
        return None

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
    it is a table of ranges. `names` are raw integers that have a name beside their value.
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
        "names",
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
        names: Mapping[str, int] | None = None,
    ) -> None:
        super().__init__(unit)
        self.low = low
        self.high = high
        self.names: Mapping[str, int] = names or {}
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

    def name(self, raw: int) -> str | None:
        """The name beside the value of a raw integer; None without one."""
        return next((name for name, named in self.names.items() if named == raw), None)

    def raw(self, value: Real | str, parameters: object, field: str) -> int:
        """The raw integer nearest to a value, ties away from zero, or that of a name. Raises CodecError when it is rejected.

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

    def _raw(self, value: Real | str, parameters: object, field: str) -> int:
        """The same without shortcuts."""
        if isinstance(value, str):
            return self.check(raw_of_name(value, self.names, field), parameters, field)
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

    def raw(self, value: Real | str, parameters: object, field: str) -> int:
        """The integer nearest to a value, ties away from zero, or that of a name. Raises CodecError when it is rejected."""
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

    def raw(self, value: Real | str, parameters: object, field: str) -> int:
        """The bit pattern of the nearest float. Raises CodecError when the value is rejected.

        An int, a Fraction and a Decimal are rounded once, a float in each operation.
        """
        if isinstance(value, str):
            return raw_of_name(value, self.names, field)
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


class OptionalNumber(FieldType):
    """A number whose value can be None: `no_values` are the names of raw integers without one, from the first to the last."""

    __slots__ = ("_raws", "no_values", "number")

    takes_none = True

    def __init__(self, number: Number, no_values: Mapping[str, tuple[int, int]]) -> None:
        super().__init__(number.unit)
        self.number = number
        self.no_values = no_values
        self._raws = {**number.names, **{name: last for name, (_, last) in no_values.items()}}

    @property
    def names(self) -> Mapping[str, int]:
        """The raw integers of numbers that have a name beside their value."""
        return self.number.names

    def no_value(self, raw: int) -> str | None:
        """The name for which a raw integer has no value; None for a number."""
        return next((name for name, (first, last) in self.no_values.items() if first <= raw <= last), None)

    def name(self, raw: int) -> str | None:
        """The name beside the value of a raw integer; None without one."""
        return self.number.name(raw)

    def value(self, raw: int, parameters: object, field: str) -> float | None:
        """The value of a raw integer; None without one. Raises CodecError as that of the number does."""
        return self.number.value(raw, parameters, field) if self.no_value(raw) is None else None

    def raw(self, value: Real | str | None, parameters: object, field: str) -> int:
        """The raw integer of a value or a name, of several the last; None stands for the first name without a value.

        Raises CodecError for another name, and for a number whose nearest raw integer has no value.
        """
        given = next(iter(self.no_values)) if value is None else value
        if isinstance(given, str):
            return self.check(raw_of_name(given, self._raws, field), parameters, field)
        return self.number.raw(given, parameters, field)

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself. Raises CodecError when it has neither a value in range nor a name."""
        return index(raw) if self.no_value(integer(raw, field)) else self.number.check(raw, parameters, field)

    def raw_range(self, parameters: object) -> tuple[int, int]:
        """The range of raw integers with a value."""
        return self.number.raw_range(parameters)

    def value_range(self, parameters: object) -> tuple[float, float]:
        """The range of the values."""
        return self.number.value_range(parameters)


class OptionalInteger(OptionalNumber):
    """The same of an integer, whose value is its raw integer."""

    __slots__ = ()

    def value(self, raw: int, parameters: object, field: str) -> int | None:
        """The raw integer itself; None without a value."""
        return raw if self.no_value(raw) is None else None


class OptionalFloat(OptionalNumber):
    """The same of a float, of which NaN has no value, whatever its sign."""

    __slots__ = ()

    def no_value(self, raw: int) -> str | None:
        """The name of NaN; None for another bit pattern."""
        return super().no_value(raw & ~(self.number.high // 2 + 1))


class Counter(NamedTuple):
    """A field that the sender increments with each frame."""

    first: int
    last: int

    def next(self, value: int) -> int:
        """The value in the next frame: `first` after `last`, and after a value outside of both."""
        return value + 1 if self.first <= value < self.last else self.first

    def steps(self, previous: int, value: int) -> int:
        """So many increments lead from one value to another: 1 if no frame is missing, 0 if the frame is repeated.

        0 also if one of them is outside of the range.
        """
        if not (self.first <= previous <= self.last and self.first <= value <= self.last):
            return 0
        return (value - previous) % (self.last - self.first + 1)


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

    def no_value(self, raw: Iterable[int]) -> tuple[Any, ...] | None:
        """The name for which each element has no value, None for one with a value; None alone if all have one."""
        names = tuple(map(self.type.no_value, raw))
        return names if any(names) else None

    def name(self, raw: Iterable[int]) -> tuple[Any, ...] | None:
        """The name beside the value of each element, None for one without; None alone if no element has one."""
        names = tuple(map(self.type.name, raw))
        return names if any(names) else None

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


class TextType(ArrayType):
    """A text of some bytes. It ends before the first 0, and before the padding at its end; an invalid byte is U+FFFD."""

    __slots__ = ("encoding", "padding")

    def __init__(self, type_: FieldType, count: int, encoding: str, padding: int) -> None:
        super().__init__(type_, count)
        self.encoding = encoding
        self.padding = bytes([padding])

    def value(self, raw: Iterable[int], parameters: object, field: str) -> Any:
        """The text."""
        return bytes(raw).partition(b"\0")[0].rstrip(self.padding).decode(self.encoding, "replace")

    def raw(self, value: Any, parameters: object, field: str) -> tuple[int, ...]:
        """The bytes of a text. Raises CodecError when it is too long, or would be read as another."""
        if not isinstance(value, str):
            raise TypeError(f"{field}={value!r} is no text")
        try:
            raw = tuple(value.encode(self.encoding).ljust(self.count, self.padding))
        except UnicodeEncodeError:
            raw = ()
        if len(raw) != self.count or self.value(raw, parameters, field) != value:
            text = f"{field}={value!r} is no text of at most {self.count} bytes in {self.encoding}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return raw


class DigitsType(ArrayType):
    """A number in decimal digits, from the most significant one on."""

    __slots__ = ()

    def value(self, raw: Iterable[int], parameters: object, field: str) -> Any:
        """The number. Raises CodecError when a digit exceeds 9."""
        number = 0
        for digit in raw:
            if digit > 9:
                raise CodecError(Refusal.OUT_OF_RANGE, f"{field} has the digit {digit}; use {field}_raw", field)
            number = 10 * number + digit
        return number

    def raw(self, value: Any, parameters: object, field: str) -> tuple[int, ...]:
        """The digits of the integer nearest to a value, ties away from zero. Raises CodecError when it has none."""
        whole = nearest(*ratio(value, field))
        if not 0 <= whole < 10**self.count:
            text = f"{field}={shown(value)} is out of range 0..{10**self.count - 1}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return tuple(int(digit) for digit in f"{whole:0{self.count}}")

    def value_range(self, parameters: object) -> tuple[float, float]:
        """The smallest and the largest number."""
        return 0, 10**self.count - 1


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
    ID_PARAMETER: ClassVar[str] = ""
    """The parameter in the CAN id; empty without one."""
    ID_PARAMETER_STEP: ClassVar[int] = 1
    """The factor of that parameter, which is added to `ID`."""
    NODES: ClassVar[tuple[int, int]]
    """First and last node in the id."""
    NODE_FIELD: ClassVar[str] = ""
    """The field with the node or its low bits; empty without one."""
    NODE_MASK: ClassVar[int] = -1
    """The bits of the node that `NODE_FIELD` has."""
    CODE: ClassVar[int]
    """The selector's value."""
    CODES: ClassVar[tuple[int, ...]] = ()
    """The selector's values, if receivers accept several; `CODE` is the first."""
    SENT: ClassVar[tuple[str, ...]] = ()
    """When it is sent, if the manual states more than that a reply answers its request: `cyclic`, `on_change`,
    `on_request`, `event`."""
    EVERY_MS: ClassVar[float | None] = None
    """The nominal period of a cyclic frame."""
    TIMEOUT_MS: ClassVar[float | None] = None
    """The silence that the receiver treats as a failure."""
    TITLE: ClassVar[str] = ""
    """The title of the command. This and the next are set on requests, and on replies without a request."""
    MANUAL: ClassVar[str] = ""
    """The manual's section."""
    EFFECTS: ClassVar[tuple[str, ...]] = ()
    """The effects of sending it besides its reply."""
    EXEMPT: ClassVar[Mapping[str, Mapping[int, tuple[str, ...]]]] = {}
    """By field and raw integer, the effects that do not occur with this value."""
    REPEAT: ClassVar[bool | None] = None
    """Whether it can be sent again if no reply came; None if that follows from the effects."""
    REPLIES: ClassVar[int] = 1
    """The number of frames with which a node answers a request, at most."""
    REPLIERS: ClassVar[tuple[int, ...]] = ()
    """The nodes that reply one by one; empty if the node of the request replies."""
    DIFFERS: ClassVar[bool] = False
    """Of a read: whether the frame of its reply always differs from that of the request."""
    REPLY_WITHIN_MS: ClassVar[float | None] = None
    """The longest time to its reply, if that of the edition does not apply."""
    VARIABLES: ClassVar[Mapping[str, str]] = {}
    """The variables of a node that the fields of a request write, and those that the fields of a reply read under another name."""
    PLAUSIBLE: ClassVar[Mapping[str, int]] = {}
    """Raw integers that a working node can send in the fields of a reply where 0 is implausible."""
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
    FD: ClassVar[bool] = False
    """True for a frame of CAN FD."""
    BIT_RATE_SWITCH: ClassVar[bool] = False
    """True when the data are sent with the higher bit rate of CAN FD."""
    DEPENDS: ClassVar[tuple[str, ...]] = ()
    """The parameters on which fields, values or ranges depend."""
    TYPES: ClassVar[Mapping[str, FieldType]] = {}
    """The type of each field by name, in the order of the specification: its unit, range and conversions."""
    COUNTERS: ClassVar[Mapping[str, Counter]] = {}
    """The counters among the fields, by name."""
    VARIANTS: ClassVar[tuple[tuple[str | None, ...], ...]] = ()
    """The field of each raw integer in each variant, where that depends on a parameter; None where there is none."""
    VARIANT_BY: ClassVar[str] = ""
    """The parameter that decides on the variant."""
    VARIANT_OF: ClassVar[Mapping[Any, int]] = {}
    """The index of the variant by the value of that parameter."""

    _nodes: ClassVar[range] = range(0)
    """The nodes. Constructors look there first: calling `_known_node` takes longer."""
    _code: int = 0
    """The code, if there are several."""
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
    def frame_code(self) -> int | None:
        """The code of this frame, one of `CODES` if there are several; None where a message has no code."""
        return self._code if self.CODES else getattr(self, "CODE", None)

    @classmethod
    def _known_code(cls, code: int) -> int:
        """The code itself. Raises CodecError (unknown_code) if it is none of this message, TypeError for no integer."""
        if integer(code, "frame_code") not in (cls.CODES or (getattr(cls, "CODE", None),)):
            codes = " or ".join(f"0x{known:02X}" for known in cls.CODES)
            text = f"{cls.__name__} has {f'the code {codes}' if codes else 'no choice of codes'}, not 0x{code:02X}"
            raise CodecError(Refusal.UNKNOWN_CODE, text)
        return index(code)

    @property
    def can_id(self) -> int:
        """The CAN id of this frame. Raises CodecError (missing_parameter) if it contains an unknown parameter."""
        return self.ID + (self._node or 0) * self.NODE_STEP + (self._id_offset() if self.ID_PARAMETER else 0)

    def _id_offset(self) -> int:
        """The part of the id that is a parameter. Raises CodecError (missing_parameter)."""
        return whole(self._parameters, self.ID_PARAMETER, None, type(self).__name__) * self.ID_PARAMETER_STEP

    def encode(self) -> bytes:
        """The data bytes of this frame; reserved bits are 0. Raises CodecError as `check` does."""
        if not self._checked:
            self.check()
        return self.encode_unchecked()

    @classmethod
    def check_available(cls, parameters: Any) -> None:
        """Raises CodecError (not_available) if nodes with these parameters do not have the command."""
        for name, values in cls.ONLY.items():
            value = getattr(parameters, name, None)
            if value is not None and value not in values:
                available = " or ".join(map(shown_choice, values))
                text = f"{cls.__name__} is available with {name}={available}, not {shown_choice(value)}"
                raise CodecError(Refusal.NOT_AVAILABLE, text)

    def _check_meaning(self) -> None:
        """Raises CodecError (wrong_message) if receivers identify this frame as another message."""

    def encode_unchecked(self) -> bytes:
        """The data bytes of this frame, also where `encode` refuses: every field of a decoded frame as it was received.

        A message does not store reserved bits, nor a selector that has one value: they are those of the specification.
        """
        raise TypeError(f"{type(self).__name__} is only a base class")

    def check(self) -> None:
        """Raises CodecError if nodes with these parameters do not have the command, if the node or a raw integer is out
        of range, if a raw integer has no name in its enum or flags, or if the frame would be another message.

        They are checked in this order, and fields in the order of the specification, as in every language.

        Messages from constructors, `from_raw` and `replace` have been checked already; decoded ones have not.
        """
        self.check_available(self._parameters)
        self._known_node(self._node)
        if self.ID_PARAMETER:
            self._id_offset()
        raws = self.raw()
        for name in self._in_order_of_checks():
            self.TYPES[name].check(raws[name], self._parameters, name)
        self._check_meaning()
        self._checked = True

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Self:
        """The message in these data bytes. Id, length and selector have been checked already."""
        raise TypeError(f"{cls.__name__} is only a base class")

    @classmethod
    def from_raw(
        cls, *, node: int | None = None, parameters: Any = None, frame_code: int | None = None, **raw: Any
    ) -> Self:
        """The message with these raw integers, by field, and with one of `CODES`; without it, with `CODE`.

        Raises CodecError as `check` does, FieldAbsent (a field does not exist under the parameters),
        TypeError (other names, or a field is missing).
        """
        self = new(cls)
        cls.check_available(parameters)
        code = None if frame_code is None else cls._known_code(frame_code)
        if cls.CODES:
            object.__setattr__(self, "_code", cls.CODE if code is None else code)  # a slot of classes with codes only
        self._node = self._known_node(node)
        self._parameters = cls.DEFAULTS if parameters is None else parameters
        if cls.ID_PARAMETER:
            self._id_offset()
        places, types = self._places(), cls.TYPES
        names = [name for name in types if name in places]
        if raw.keys() != {*names}:
            for name in raw:
                if name in types and name not in names:
                    raise self._absent(name)
            raise TypeError(f"{cls.__name__}.from_raw takes {', '.join(names) or 'no field'}")
        checked: dict[str | None, Any] = {name: types[name].check(raw[name], self._parameters, name) for name in names}
        self._raws = tuple(map(checked.get, places))
        self._check_meaning()
        self._checked = True
        return self

    def replace(self, **values: Any) -> Self:
        """A copy with other values of some fields; `node`, `parameters` and `frame_code` can be replaced too.

        The other fields keep their raw integers. Raises CodecError as `check` does, FieldAbsent where a field does not
        exist under the parameters, and TypeError for other names.
        """
        parameters = values.pop("parameters", self._parameters)
        self.check_available(parameters)
        code = values.pop("frame_code", self._code if self.CODES else None)
        node = self._known_node(values.pop("node", self._node))
        raws = self.raw()
        for name, value in values.items():
            if name not in self.TYPES:
                raise TypeError(f"{type(self).__name__} has no {name}; it has {', '.join(self.TYPES) or 'no field'}")
            raws[name] = self.TYPES[name].raw(value, parameters, name)
        return self.from_raw(node=node, parameters=parameters, frame_code=code, **raws)

    def fields(self) -> tuple[str, ...]:
        """Names of the fields that exist under the parameters."""
        return tuple(name for name in self._places() if name is not None)

    def raw(self) -> dict[str, Any]:
        """The raw integer, or integers, of every field that exists under the parameters."""
        return {name: raw for name, raw in zip(self._places(), self._raws, strict=True) if name is not None}

    def values(self) -> dict[str, Any]:
        """The value of every field that exists under the parameters; None without one: see `no_values`, or it has no scale
        or depends on an unknown parameter."""
        found: dict[str, Any] = {}
        for name in self.fields():
            try:
                found[name] = getattr(self, name)
            except CodecError:
                found[name] = None
        return found

    def no_values(self) -> dict[str, Any]:
        """The fields that mean that there is no value, each with its name of the specification, such as `not_available`.

        For an array, it is a tuple with None for each element that has a value.
        """
        names = {name: self.TYPES[name].no_value(raw) for name, raw in self.raw().items()}
        return {name: named for name, named in names.items() if named is not None}

    def out_of_range(self) -> dict[str, str]:
        """The fields whose raw integers are outside their range, or have no name in their enum or flags, each with the reason.

        Only a decoded message can have any: decoding accepts every value, `encode` and constructors reject these.
        """
        reasons: dict[str, str] = {}
        for name, raw in () if self._checked else self.raw().items():
            try:
                self.TYPES[name].check(raw, self._parameters, name)
            except CodecError as error:
                if error.refusal in (Refusal.OUT_OF_RANGE, Refusal.NOT_FINITE):
                    reasons[name] = str(error)
        return reasons

    def names(self) -> dict[str, Any]:
        """The numbers that have a name of the specification beside their value, such as `maximum`, each with this name.

        For an array, it is a tuple with None for each element without one.
        """
        names = {name: self.TYPES[name].name(raw) for name, raw in self.raw().items()}
        return {name: named for name, named in names.items() if named is not None}

    def _places(self) -> tuple[str | None, ...]:
        """The field of each raw integer under the parameters. Raises CodecError (missing_parameter)."""
        return places(type(self), self._parameters)

    def _in_order_of_checks(self) -> list[str]:
        """Names of the fields that exist, in the order of the specification, so that every language rejects the same field."""
        there = self.fields()
        return [name for name in self.TYPES if name in there]

    def _known_node(self, node: int | None) -> int | None:
        """The node itself. Raises CodecError (unknown_node), and TypeError where the id has no node."""
        if node.__class__ is int and node in self._nodes:
            return node
        name = type(self).__name__
        if not self.COMMAND:
            raise TypeError(f"{name} is only a base class; use the class of a request or a reply")
        if self._nodes:
            return node_in(node, *self.NODES)
        if node is not None:
            raise TypeError(f"{name} has no node, its id is fixed")
        return None

    def _raws_of(self, **values: Any) -> tuple[Any, ...]:
        """The raw integers of the values of all fields, where None stands for a field that does not exist, or for no value.

        Raises CodecError, TypeError (a field is missing), FieldAbsent (a field does not exist).
        """
        places, types, parameters = self._places(), self.TYPES, self._parameters
        for name, value in values.items():
            if (value is None) is (name in places) and not (value is None and types[name].takes_none):
                if value is None:
                    raise TypeError(f"{type(self).__name__} needs {name} under {parameters}")
                raise FieldAbsent(f"{type(self).__name__} has no {name} under {parameters}")
        raws: dict[str | None, Any] = {
            name: types[name].raw(value, parameters, name)
            for name, value in values.items()
            if value is not None or (name in places and types[name].takes_none)
        }
        return tuple(map(raws.get, places))

    def _absent(self, name: str) -> FieldAbsent:
        """The error for a field that does not exist under the parameters."""
        there = ", ".join(self.fields())
        return FieldAbsent(f"{type(self).__name__} has no {name} under {self._parameters}; it has {there}")

    def __repr__(self) -> str:
        parts = [f"node={self._node}"] if self._node is not None else []
        if self.CODES and self._code != self.CODE:
            parts.append(f"frame_code=0x{self._code:02X}")
        no_values = self.no_values()
        for name, raw in self.raw().items():
            try:
                value: Any = getattr(self, name)
                named: Any = no_values.get(name)
                if named.__class__ is tuple:
                    value = tuple(one if why is None else why for one, why in zip(value, named, strict=True))
                parts.append(f"{name}={(named if isinstance(named, str) else value)!r}")
            except CodecError:
                parts.append(f"{name}_raw={raw!r}")
        if outside := self.out_of_range():
            parts.append(f"out_of_range={tuple(outside)}")
        if any(getattr(self._parameters, name) is not None for name in self.DEPENDS):
            parts.append(f"parameters={shown_parameters(self._parameters, self.DEPENDS)}")
        return f"{type(self).__name__}({', '.join(parts)})"

    def __eq__(self, other: Any) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return (
            self._raws == other._raws
            and self._node == other._node
            and self._code == other._code
            and (
                self._parameters is other._parameters
                or all(getattr(self._parameters, name) == getattr(other._parameters, name) for name in self.DEPENDS)
            )
        )

    def __hash__(self) -> int:
        # equal messages have equal hashes, whatever their parameters are
        return hash((type(self), self._node, self._code, self._raws))


def places(kind: type[Message], parameters: Any) -> tuple[str | None, ...]:
    """The field of each raw integer of a class under the parameters. Raises CodecError (missing_parameter)."""
    if not kind.VARIANT_BY:
        return tuple(kind.TYPES)
    return kind.VARIANTS[kind.VARIANT_OF[known(parameters, kind.VARIANT_BY, None, kind.__name__)]]


id_node: Callable[[Message], int | None] = attrgetter("_node")
"""The node in the id of a message; `node` may be read from a field instead."""


R = TypeVar("R", bound=Message)


class Request(Message, Generic[R]):
    """A frame from host to node; `R` is its reply."""

    __slots__ = ()


class ClientFacts(NamedTuple):
    """What a client and a simulation know of an edition besides its frames."""

    effects: Mapping[str, tuple[str, str, bool, str]]
    """Title and consent of each effect, whether a command with it can be sent again, and how long what it writes is kept."""
    reads: tuple[type[Request[Any]], ...]
    """Requests without values and effects, each with one reply from its node."""
    settings: Mapping[type[Request[Any]], Mapping[str, type[Request[Any]]]]
    """The reads of what can be written, and the requests that write it, by how long the node keeps it."""
    ends_motion: Mapping[str, type[Request[Any]]]
    """The requests that `stop` a node and `switch_off` one."""
    states: Mapping[str, tuple[tuple[type[Request[Any]], ...], tuple[str, ...], Mapping[str, int]]]
    """The states of a node, the one after power-up first: the requests that lead to each, the effects that it prevents, and
    the variables that contain it, with their raw integers.
    """
    cyclic: tuple[type[Message], ...]
    """The replies that a node sends without a request, every `EVERY_MS`."""
    answers_in_order: bool
    """Whether a node answers in the order of the requests; False if that is unknown."""


class Reply(Message):
    """A frame from node to host."""

    __slots__ = ()

    FRAME_FIELD: ClassVar[str] = ""
    """The attribute with the number of the frame, if there are several; empty if there is one."""
    FRAMES: ClassVar[range] = range(1)
    """The numbers of the frames."""


Part = TypeVar("Part", bound=Reply)
V = TypeVar("V")


def join(frames: Iterable[Part], values: Callable[[Part], Iterable[V]], *, last: int | None = None) -> list[V]:
    """The values of a reply of several frames, in the order of their numbers, in which they need not be given.

    `values` returns those of one frame, for example `lambda frame: frame.cells`. `last` is the number of the last frame, if
    the node sends fewer than it can. Raises ValueError if a frame is missing, unexpected, or given twice.
    """
    by_number: dict[int, Part] = {}
    expected = range(0)
    for frame in frames:
        number = getattr(frame, frame.FRAME_FIELD) if frame.FRAME_FIELD else 0
        expected = frame.FRAMES if last is None else range(frame.FRAMES.start, last + 1)
        if number in by_number or number not in expected:
            reason = "is given twice" if number in by_number else f"is none of {expected.start} to {expected.stop - 1}"
            raise ValueError(f"frame {number} {reason}")
        by_number[number] = frame
    missing = [number for number in expected if number not in by_number]
    if missing or not by_number:
        raise ValueError(f"frame {missing[0]} is missing" if missing else "there are no frames")
    return [value for number in expected for value in values(by_number[number])]


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
        self._checked = not cls.ONLY
        return self


class ToNode(Bare):
    """A frame without fields, to or from a node."""

    __slots__ = ()

    def __init__(self, *, node: int, parameters: Any = None) -> None:
        self.check_available(parameters)
        self._node = self._known_node(node)
        self._parameters = parameters
        self._raws = ()
        self._checked = True


class ToAll(Bare):
    """A frame without fields, on an id without a node."""

    __slots__ = ()

    def __init__(self, *, parameters: Any = None) -> None:
        self.check_available(parameters)
        self._node = self._known_node(None)
        self._parameters = parameters
        self._raws = ()
        self._checked = True


def constant(found: int, wanted: int, field: str) -> None:
    """Checks a field that always has the same value. Raises CodecError (wrong_constant)."""
    if found != wanted:
        raise CodecError(Refusal.WRONG_CONSTANT, f"{field} is 0x{found:X}, always 0x{wanted:X} in this frame", field)


def wrong_message(message: Message, command: str, data: bytes) -> CodecError:
    """The error of a frame that receivers identify as one of another command."""
    text = (
        f"{type(message).__name__} with these values is the {message.DIRECTION} of {command}: {data.hex(' ').upper()}"
    )
    return CodecError(Refusal.WRONG_MESSAGE, text)


def checksum(found: int, computed: int, field: str) -> None:
    """Checks the checksum of a frame. Raises CodecError (wrong_checksum)."""
    if found != computed:
        text = f"{field} is 0x{found:X}, but the checksum of this frame is 0x{computed:X}"
        raise CodecError(Refusal.WRONG_CHECKSUM, text, field)


def crc_of(
    width: int, poly: int, init: int, xor_out: int, *, shift: int = 0, reflected: bool = False
) -> Callable[[bytes], int]:
    """The function that computes a CRC with a register of `width` bits, at least 8; the result is shifted right."""
    mask, high = (1 << width) - 1, width - 8
    table: list[int] = []
    for byte in range(256):
        register = byte if reflected else byte << high
        for _ in range(8):
            if reflected:
                register = register >> 1 ^ (poly if register & 1 else 0)
            else:
                register = (register << 1 & mask) ^ (poly if register >> (width - 1) else 0)
        table.append(register)

    def reflected_crc(data: bytes) -> int:
        register = init
        for byte in data:
            register = register >> 8 ^ table[register & 0xFF ^ byte]
        return register ^ xor_out

    def crc(data: bytes) -> int:
        register = init
        for byte in data:
            register = register << 8 & mask ^ table[register >> high ^ byte]
        return register >> shift ^ xor_out

    return reflected_crc if reflected else crc


def sum_of(width: int, init: int, xor_out: int) -> Callable[[bytes], int]:
    """The function that adds bytes, modulo `2 ** width`."""
    mask = (1 << width) - 1
    return lambda data: (init + sum(data) & mask) ^ xor_out


def xor_of(init: int, xor_out: int) -> Callable[[bytes], int]:
    """The function that combines bytes with exclusive or."""

    def combined(data: bytes) -> int:
        result = init
        for byte in data:
            result ^= byte
        return result ^ xor_out

    return combined


def merge(little: int, big: int, length: int) -> bytes:
    """Data bytes with little-endian and big-endian fields."""
    return bytes(a | b for a, b in zip(little.to_bytes(length, "little"), big.to_bytes(length, "big"), strict=True))
