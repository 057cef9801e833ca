"""Shared by the editions of a family: errors, parameters, numbers, messages."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Mapping
from enum import Enum, IntEnum
from fractions import Fraction
from functools import lru_cache
from operator import index
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

if TYPE_CHECKING:
    from typing_extensions import Self

Real = int | float | Fraction


MAX_DATA = 8
"""The most data bytes of a frame."""


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
            number = finite(value, name)
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


def finite(value: Real, field: str) -> float:
    """A number as a float. Raises TypeError (no number), CodecError (not_finite), OverflowError (too large)."""
    try:
        is_finite = math.isfinite(value)
    except TypeError:
        raise TypeError(f"{field}={value!r} is no number") from None
    if not is_finite:
        raise CodecError(Refusal.NOT_FINITE, f"{field}={float(value)!r} is not a finite number", field)
    return float(value)


def nearest(value: Real) -> int:
    """The nearest integer, ties away from zero; exact, without adding a half."""
    size: Real = -value if value < 0 else value
    whole = math.floor(size)
    if size - whole >= 0.5:
        whole += 1
    return -whole if value < 0 else whole


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


Scale = tuple[int, int, int | Fraction]
"""Numerator, denominator and offset: value = raw * numerator / denominator + offset."""


class Number:
    """Converts between raw integers and values.

    `scale` is None where the specification gives none. With `scale_by`, it is a table of scales by the values of that
    parameter. `times` names a number parameter that multiplies scale and offset; with `scale_by` it is a table as well.
    `limits` is the raw range that the specification sets within `low` and `high`, those of the bits; with `limits_by`
    it is a table of ranges.
    """

    __slots__ = ("high", "limits", "limits_by", "low", "scale", "scale_by", "times", "unit")

    def __init__(
        self,
        low: int,
        high: int,
        unit: str = "",
        *,
        scale: Scale | Mapping[Any, Scale | None] | None = (1, 1, 0),
        scale_by: str = "",
        times: str | Mapping[Any, str] = "",
        limits: tuple[Bound, Bound] | Mapping[Any, tuple[Bound, Bound] | None] | None = None,
        limits_by: str = "",
    ) -> None:
        self.low = low
        self.high = high
        self.unit = f" {unit}" if unit else ""
        self.scale: Any = scale
        self.scale_by = scale_by
        self.times: Any = times
        self.limits: Any = limits
        self.limits_by = limits_by

    def _scale(self, parameters: object, field: str) -> Scale:
        scale = self.scale
        if self.scale_by:
            scale = scale.get(known(parameters, self.scale_by, field))
        if scale is None:
            raise CodecError(Refusal.NO_SCALE, f"{field} has no scale here; use {field}_raw", field)
        numerator, denominator, offset = scale
        return numerator, denominator, offset

    def _times(self, parameters: object, field: str) -> tuple[int, int] | None:
        """Numerator and denominator of the parameter that multiplies scale and offset; None where there is none."""
        times = self.times.get(getattr(parameters, self.scale_by)) if self.scale_by else self.times
        return above_zero(parameters, times, field) if times else None

    def value(self, raw: int, parameters: object, field: str) -> float:
        """The value of a raw integer."""
        numerator, denominator, offset = self._scale(parameters, field)
        times = self._times(parameters, field) if self.times else None
        if times is not None:
            dividend = (raw * numerator + offset * denominator) * times[0]
            try:
                return float(dividend / (denominator * times[1]))
            except OverflowError:
                text = f"{field} is larger than any float under these parameters"
                raise CodecError(Refusal.OUT_OF_RANGE, text, field) from None
        return float(Fraction(raw * numerator, denominator) + offset) if offset else raw * numerator / denominator

    def raw(self, value: Real, parameters: object, field: str) -> int:
        """The raw integer nearest to a value, ties away from zero. Raises CodecError when the value is rejected."""
        numerator, denominator, offset = self._scale(parameters, field)
        times = self._times(parameters, field) if self.times else None
        try:
            if not isinstance(value, int):
                value = finite(value, field)
            quotient: Real = value if times is None else float(value) * times[1] / times[0]
            if offset:
                quotient = quotient - float(offset)
            if denominator != 1:
                quotient = quotient * denominator
            if numerator != 1:
                quotient = quotient / numerator
            raw = nearest(quotient)
        except OverflowError:
            raise self._out_of_range(f"{value!r}{self.unit}", parameters, field) from None
        low, high = self.span(parameters)
        if not low <= raw <= high:
            raise self._out_of_range(f"{value!r}{self.unit}", parameters, field)
        return raw

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The raw integer itself. Raises CodecError when it is out of range, TypeError when it is no integer."""
        raw = index(raw)
        low, high = self.span(parameters)
        if not low <= raw <= high:
            raise self._out_of_range(f"raw {raw}", parameters, field)
        return raw

    def span(self, parameters: object) -> tuple[int, int]:
        """Smallest and largest raw integer allowed under these parameters."""
        limits = self.limits
        if self.limits_by:
            limits = limits.get(getattr(parameters, self.limits_by))
        if limits is None:
            return self.low, self.high
        low, high = limits[0].at(parameters), limits[1].at(parameters)
        return (
            self.low if low is None else max(self.low, math.ceil(low)),
            self.high if high is None else min(self.high, math.floor(high)),
        )

    def _out_of_range(self, given: str, parameters: object, field: str) -> CodecError:
        low, high = self.span(parameters)
        text = f"raw {low}..{high}"
        try:
            ends = sorted((self.value(low, parameters, field), self.value(high, parameters, field)))
            text = f"{ends[0]}..{ends[1]}{self.unit} ({text})"
        except CodecError:
            pass
        return CodecError(Refusal.OUT_OF_RANGE, f"{field}={given} is out of range {text}", field)


class Float(Number):
    """An IEEE float. Its raw integer is its bit pattern; scale and limits apply to the float."""

    __slots__ = ("bits", "number")

    def __init__(
        self,
        width: int,
        unit: str = "",
        *,
        scale: Scale | Mapping[Any, Scale | None] | None = (1, 1, 0),
        scale_by: str = "",
        limits: tuple[Bound, Bound] | Mapping[Any, tuple[Bound, Bound] | None] | None = None,
        limits_by: str = "",
    ) -> None:
        super().__init__(0, (1 << width) - 1, unit, scale=scale, scale_by=scale_by, limits=limits, limits_by=limits_by)
        self.bits = struct.Struct("<I" if width == 32 else "<Q")
        self.number = struct.Struct("<f" if width == 32 else "<d")

    def value(self, raw: int, parameters: object, field: str) -> float:
        """The scaled float with this bit pattern."""
        numerator, denominator, offset = self._scale(parameters, field)
        value: float = self.number.unpack(self.bits.pack(raw))[0]
        if numerator != 1:
            value *= numerator
        if denominator != 1:
            value /= denominator
        return value + float(offset) if offset else value

    def raw(self, value: Real, parameters: object, field: str) -> int:
        """The bit pattern of the nearest float. Raises CodecError when the value is rejected."""
        numerator, denominator, offset = self._scale(parameters, field)
        try:
            number = float(finite(value, field))
            if offset:
                number -= float(offset)
            if denominator != 1:
                number *= denominator
            if numerator != 1:
                number /= numerator
            if math.isinf(number):
                raise OverflowError
            bits: int = self.bits.unpack(self.number.pack(number))[0]
        except OverflowError:
            raise CodecError(Refusal.OUT_OF_RANGE, f"{field}={value!r} is too large for its float", field) from None
        return self.check(bits, parameters, field)

    def check(self, raw: int, parameters: object, field: str) -> int:
        """The bit pattern itself. Raises CodecError when its value is out of range or not finite."""
        if not 0 <= raw <= self.high:
            raise CodecError(Refusal.OUT_OF_RANGE, f"{field}=raw {raw} is out of range 0..{self.high}", field)
        if not math.isfinite(self.number.unpack(self.bits.pack(raw))[0]):
            raise CodecError(Refusal.NOT_FINITE, f"{field}=raw {raw} is not a finite number", field)
        limits = self.limits.get(getattr(parameters, self.limits_by)) if self.limits_by else self.limits
        if limits is not None:
            value = self.value(raw, parameters, field)
            low, high = limits[0].at(parameters), limits[1].at(parameters)
            if not ((low is None or value >= low) and (high is None or value <= high)):
                text = f"{field}={value!r}{self.unit} is out of range {low and float(low)}..{high and float(high)}"
                raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return raw


Check = Callable[[Any, Any, str], int]


def integer(raw: int, field: str) -> int:
    """An enum member, flags or a bool as an integer. Raises TypeError for anything that is no integer."""
    try:
        return index(raw)
    except TypeError:
        raise TypeError(f"{field}={raw!r} is no integer") from None


def member(enum: type[IntEnum]) -> Check:
    """A check that a raw integer has a name in an enum."""
    values = frozenset(int(one) for one in enum)

    def check(raw: int, parameters: Any, field: str) -> int:
        if raw not in values:
            names = ", ".join(map(str, sorted(values)))
            text = f"{field}={integer(raw, field)} is none of the values {names}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return int(raw)

    return check


def flags(mask: int) -> Check:
    """A check that all set bits of a raw integer have a name."""

    def check(raw: int, parameters: Any, field: str) -> int:
        if integer(raw, field) & ~mask:
            text = f"{field}=0x{int(raw):X} sets bits without a name; the named ones are 0x{mask:X}"
            raise CodecError(Refusal.OUT_OF_RANGE, text, field)
        return int(raw)

    return check


def each(check: Callable[[Any, Any, str], int], count: int) -> Callable[[Any, Any, str], tuple[int, ...]]:
    """The check or conversion of every element of an array."""

    def check_all(values: Iterable[Any], parameters: Any, field: str) -> tuple[int, ...]:
        found = tuple(values)
        if len(found) != count:
            raise CodecError(Refusal.OUT_OF_RANGE, f"{field} has {len(found)} elements, but needs {count}", field)
        return tuple(check(value, parameters, field) for value in found)

    return check_all


def node_in(node: int | None, first: int, last: int) -> int:
    """The node itself. Raises CodecError (unknown_node) when the address has no such node, TypeError for no integer."""
    if node is None or not first <= integer(node, "node") <= last:
        raise CodecError(Refusal.UNKNOWN_NODE, f"there is no node {node}; nodes are {first}..{last}", "node")
    return index(node)


class Message:
    """One frame, stored as raw integers. Values in units are computed on access."""

    __slots__ = ("node", "parameters")

    COMMAND: ClassVar[str]
    """The command of this request or reply."""
    DIRECTION: ClassVar[str]
    """`request` or `reply`."""
    DLC: ClassVar[int] = MAX_DATA
    """Number of data bytes."""
    ID: ClassVar[int]
    """The CAN id, without the node."""
    NODE_STEP: ClassVar[int] = 1
    """The distance between the CAN ids of neighbouring nodes."""
    NODES: ClassVar[tuple[int, int]]
    """First and last node."""
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
    TYPES: ClassVar[Mapping[str, Callable[[Any, Any, str], Any]]] = {}
    """The check of each field's raw integer, by name, in the order of the specification."""

    node: Any
    parameters: Any

    @property
    def can_id(self) -> int:
        """The CAN id of this frame."""
        return self.ID + (self.node or 0) * self.NODE_STEP

    def encode(self) -> bytes:
        """The data bytes of this frame; reserved bits are 0."""
        raise TypeError(f"{type(self).__name__} is only a base class")

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Self:
        """The message in these data bytes. Id, length and selector have been checked already."""
        raise TypeError(f"{cls.__name__} is only a base class")

    @classmethod
    def from_raw(cls, *, node: int | None = None, parameters: Any = None, **raw: Any) -> Self:
        """The message with these raw integers, by field. Raises CodecError where one is out of range."""
        self = cls.__new__(cls)
        self.node = node_in(node, *self.NODES) if hasattr(self, "NODES") else None
        self.parameters = cls.DEFAULTS if parameters is None else parameters
        if set(raw) != set(self.fields()):
            raise TypeError(f"{cls.__name__}.from_raw takes {', '.join(self.fields()) or 'no field'}")
        for name, value in raw.items():
            setattr(self, f"{name}_raw", cls.TYPES[name](value, self.parameters, name))
        return self

    def fields(self) -> tuple[str, ...]:
        """Names of the fields that exist under the parameters."""
        return tuple(self.TYPES)

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            """Raises the error for an absent field or an unknown attribute."""
            if not hasattr(type(self), "COMMAND"):
                raise TypeError(f"{type(self).__name__} is only a base class; use the class of a request or a reply")
            if name.removesuffix("_raw") not in type(self).TYPES:
                raise AttributeError(f"{type(self).__name__} has no attribute {name}")
            there = ", ".join(self.fields())
            raise FieldAbsent(f"{type(self).__name__} has no {name} under {self.parameters}; it has {there}")

    def raw(self) -> dict[str, Any]:
        """The raw integer, or integers, of every field that exists under the parameters."""
        return {name: getattr(self, f"{name}_raw") for name in self.fields()}

    def __repr__(self) -> str:
        parts = [f"node={self.node}"] if self.node is not None else []
        for name in self.fields():
            try:
                parts.append(f"{name}={getattr(self, name)!r}")
            except CodecError:
                parts.append(f"{name}_raw={getattr(self, f'{name}_raw')!r}")
        return f"{type(self).__name__}({', '.join(parts)})"

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other) or not isinstance(other, Message):
            return NotImplemented
        return self.node == other.node and self.fields() == other.fields() and self.raw() == other.raw()

    def __hash__(self) -> int:
        return hash((type(self), self.node, tuple(self.raw().values())))


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

    def encode(self) -> bytes:
        """The data bytes of this frame; a remote frame has none."""
        return b"" if self.REMOTE else self.DATA

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Self:
        """The message in these data bytes. Id, length and selector have been checked already."""
        self = cls.__new__(cls)
        self.node = node
        self.parameters = parameters
        return self


class ToNode(Bare):
    """A frame without fields, to or from a node."""

    __slots__ = ()

    def __init__(self, *, node: int) -> None:
        self.node = node_in(node, *self.NODES)
        self.parameters = None


class ToAll(Bare):
    """A frame without fields, on an id without a node."""

    __slots__ = ()

    def __init__(self) -> None:
        self.node = None
        self.parameters = None


E = TypeVar("E", bound=IntEnum)


def named(enum: type[E], raw: int) -> E | int:
    """The enum member of that value; the raw integer where no member has it."""
    try:
        return enum(raw)
    except ValueError:
        return raw


def require(message: Message, **optional: object) -> None:
    """Checks the optional fields against the parameters. Raises TypeError (missing) and FieldAbsent (superfluous)."""
    wanted = message.fields()
    for name, value in optional.items():
        if value is None and name in wanted:
            raise TypeError(f"{type(message).__name__} needs {name} under {message.parameters}")
        if value is not None and name not in wanted:
            raise FieldAbsent(f"{type(message).__name__} has no {name} under {message.parameters}")


def constant(found: int, wanted: int, field: str) -> None:
    """Checks a field that always has the same value. Raises CodecError (wrong_constant)."""
    if found != wanted:
        raise CodecError(Refusal.WRONG_CONSTANT, f"{field} is 0x{found:X}, always 0x{wanted:X} in this frame", field)


def merge(little: int, big: int, length: int) -> bytes:
    """Data bytes with little-endian and big-endian fields."""
    return bytes(a | b for a, b in zip(little.to_bytes(length, "little"), big.to_bytes(length, "big"), strict=True))
