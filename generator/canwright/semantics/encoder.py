"""The reference encoder: the frame of raw integers or values, or the reason for their rejection.

Every target decides in the same order and rejects for the same reasons.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction

from ..model import formatting
from ..model.golden_frames import Value
from ..model.joined import Joined, JoinedDigits
from ..model.layout import Field, Space
from ..model.message import Confusion, Message
from ..model.refusal import Refusal
from ..model.types import Assignment, Bound, Encoding, Type, factors
from .bits import placed
from .confusion import is_confused
from .decoder import Rejection, is_finite, linear_of, missing_parameter, value_of
from .floats import bits_of
from .frame import CanFrame, Raw, checksum_of, parameter_raw
from .plan import (
    CheckAvailable,
    CheckCode,
    CheckField,
    CheckMeaning,
    CheckNode,
    ChooseFields,
    NeedParameter,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
    message_plan,
)
from .valid_raws import FiniteFloats, FlagBits, NamedRaws, RawInterval, end_of, is_within, valid_raws, width_limits

Number = int | float | Decimal | Fraction

SPECIAL = ("nan", "inf", "-inf")

_FrameStep = CheckField | WriteFixed | WriteCode | WriteParameter | WriteField | WriteChecksum | CheckMeaning
_OF_MESSAGE = CheckAvailable, CheckCode, CheckNode, NeedParameter, ChooseFields
"""The steps that concern the message, not its fields and bits."""


class Encoders:
    """An encoder for each set of parameters, created on first use."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[str, int | str | Fraction], ...], Encoder] = {}

    def for_parameters(self, parameters: Mapping[str, int | str | Fraction]) -> Encoder:
        key = tuple(parameters.items())
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = Encoder(parameters)
        return known


class Encoder:
    """Encodes messages under some parameters; facts about messages, fields and types are cached."""

    def __init__(self, parameters: Mapping[str, int | str | Fraction]) -> None:
        self.assignment: Assignment = {
            name: str(value) if isinstance(value, int) else value for name, value in parameters.items()
        }
        self._fields: dict[Message, Mapping[str, Field] | None] = {}
        self._steps: dict[Message, Sequence[_FrameStep]] = {}
        self._rejections: dict[tuple[Message, int | None, int | None], Rejection | None] = {}
        self._accepts: dict[Type, Callable[[int], bool]] = {}
        self._nearest: dict[Field, Callable[[Fraction], int | Rejection]] = {}

    def fields(self, message: Message) -> Mapping[str, Field] | None:
        """The fields of a message that users give, by name; None if they depend on a missing parameter."""
        if message not in self._fields:
            variant = message.layout.variant(self.assignment)
            fields = None if variant is None else {f.name: f for f in variant.given}
            self._fields[message] = fields
        return self._fields[message]

    def encode_raws(
        self, message: Message, node: int | None, raws: Mapping[str, Raw], code: int | None = None
    ) -> CanFrame | Rejection:
        """The frame of a message with these raw integers by field. Raises ValueError for other fields.

        `code` is one of its accepted codes; None is the one that is usually sent.
        """
        return self._encode(
            message, node, raws, lambda field: self.rejects_raw(field, raws[field.name]) or raws[field.name], code
        )

    def encode_values(
        self,
        message: Message,
        node: int | None,
        values: Mapping[str, Value | Number | list[Number]],
        code: int | None = None,
    ) -> CanFrame | Rejection:
        """The frame of a message with these values by field, and with a code as in `encode_raws`."""
        return self._encode(
            message, node, values, lambda field: self.field_raw(field, exact_value(values[field.name])), code
        )

    def _encode(
        self,
        message: Message,
        node: int | None,
        given: Mapping[str, object],
        raw_of: Callable[[Field], Raw | Rejection],
        code: int | None,
    ) -> CanFrame | Rejection:
        """Executes the steps of a message; `raw_of` converts what is given for a field, or rejects it."""
        rejection = self.rejects(message, node, code)
        if rejection:
            return rejection
        _check_names(message, self.fields(message), given)
        raws: dict[Field, Raw] = {}
        rule = message.id.at(self.assignment)
        assert rule is not None  # decided by `rejects`, before the names of fields are known
        id_, data = rule.base + (node or 0) * rule.node_step, 0
        for step in self._frame_steps(message):
            if isinstance(step, CheckField):
                raw = raw_of(step.field)
                if isinstance(raw, Rejection):
                    return raw
                raws[step.field] = raw
                continue
            if isinstance(step, WriteParameter):
                value = parameter_raw(step.parameter, self.assignment)
                if value is None:
                    text = f"the constant `{step.field.name}` depends on `{step.parameter}`, which is missing"
                    return Rejection(Refusal.MISSING_PARAMETER, text, step.field.name)
                raws[step.field] = [value] * len(step.field.elements)
            if isinstance(step, WriteChecksum):
                checksum = checksum_of(step.checksum, _frame(message, id_, data))
                data |= placed(step.field.elements[0].segments, checksum)
                continue
            if isinstance(step, CheckMeaning):
                if is_confused(step.confusion, frame := _frame(message, id_, data)):
                    return _confused(message, step.confusion, frame)
                continue
            space, bits = _written(step, raws, code)
            if space is Space.ID:
                id_ |= bits
            else:
                data |= bits
        return _frame(message, id_, data)

    def _frame_steps(self, message: Message) -> Sequence[_FrameStep]:
        """The steps that check fields and write bits, of the fields that a message has under these parameters."""
        if message not in self._steps:
            steps = (step for step in message_plan(message).encoding if not isinstance(step, _OF_MESSAGE))
            has = message.layout.has
            self._steps[message] = [s for s in steps if s.field is None or has(s.field, self.assignment)]
        return self._steps[message]

    def rejects(self, message: Message, node: int | None, code: int | None = None) -> Rejection | None:
        """The reason why the message cannot be sent to or from a node, or with a code; None without one."""
        key = message, node, code
        if key not in self._rejections:
            self._rejections[key] = self._rejects(*key)
        return self._rejections[key]

    def _rejects(self, message: Message, node: int | None, code: int | None) -> Rejection | None:
        for step in message_plan(message).encoding:
            if isinstance(step, CheckAvailable):
                for name, values in step.only.items():
                    value = self.assignment.get(name, values[0])
                    if value not in values:
                        text = f"{message.command} is available with {name}={' or '.join(values)}, not {value}"
                        return Rejection(Refusal.NOT_AVAILABLE, text)
            if isinstance(step, CheckCode) and code is not None and code not in step.values:
                codes = " or ".join(f"0x{value:02X}" for value in step.values)
                text = f"{message.name} has {f'the code {codes}' if codes else 'no code'}, not 0x{code:02X}"
                return Rejection(Refusal.UNKNOWN_CODE, text)
            if isinstance(step, CheckNode) and (node is None or node not in step.nodes):
                text = f"{message.name} has no node {node}; its nodes are {step.nodes[0]}..{step.nodes[-1]}"
                return Rejection(Refusal.UNKNOWN_NODE, text, "node")
            if isinstance(step, NeedParameter) and message.id.at(self.assignment) is None:
                text = f"the id of {message.name} depends on `{step.parameter}`, which is missing"
                return Rejection(Refusal.MISSING_PARAMETER, text)
            if isinstance(step, ChooseFields) and self.fields(message) is None:
                return missing_parameter(message, step)
        return None

    def rejects_raw(self, field: Field, raw: Raw) -> Rejection | None:
        """The reason why a raw integer, or a list of an array, is invalid for a field; None without one."""
        if isinstance(raw, list):
            each = (self.rejects_raw(field, element) for element in raw)
            return _wrong_count(field, len(raw)) or next(filter(None, each), None)
        if self.accepts(field.type)(raw):
            return None
        if field.type.encoding is Encoding.FLOAT and not is_finite(field.type, raw):
            return Rejection(Refusal.NOT_FINITE, f"raw {raw} is no finite number in `{field.name}`", field.name)
        return Rejection(Refusal.OUT_OF_RANGE, f"raw {raw} is invalid for `{field.name}`", field.name)

    def accepts(self, type_: Type) -> Callable[[int], bool]:
        """Whether a raw integer is valid for a type: a finite number in its range, a name, or no value."""
        if type_ not in self._accepts:
            self._accepts[type_] = self._accepting(type_)
        return self._accepts[type_]

    def field_raw(self, field: Field, value: Value) -> Raw | Rejection:
        """The raw integer of a value of a field, or a list for an array. Names must be those of the type."""
        if field.type.joined is not None:
            return _joined_raws(field, field.type.joined, value)
        elements = value if isinstance(value, list) and field.is_array else [value]
        raws: list[int] = []
        for element in elements:
            raw = self.nearest_raw(field, element)
            if isinstance(raw, Rejection):
                return raw
            no_value = None if isinstance(element, str) else field.type.no_value(raw)
            if no_value is not None:
                text = f"the raw integer of this value of `{field.name}`, {raw}, means `{no_value.name}`"
                return Rejection(Refusal.OUT_OF_RANGE, text, field.name)
            rejection = self.rejects_raw(field, raw)
            if rejection:
                return rejection
            raws.append(raw)
        return (_wrong_count(field, len(raws)) or raws) if field.is_array else raws[0]

    def nearest_raw(self, field: Field, value: Value) -> int | Rejection:
        """The raw integer nearest to a value, ties away from zero, without a check of the range."""
        type_ = field.type
        names = {member.name: member.value for member in type_.members}
        is_name = isinstance(value, str) and bool(names) and not (type_.is_number and value in SPECIAL)
        given = value if isinstance(value, list) else [value] if is_name else []
        unknown = [name for name in given if name not in names]
        if unknown:
            return Rejection(Refusal.OUT_OF_RANGE, f"`{field.name}` has no value `{unknown[0]}`", field.name)
        if isinstance(value, list):
            return sum(1 << names[str(name)] for name in dict.fromkeys(value))
        if given:
            return names[str(value)]
        if field not in self._nearest:
            self._nearest[field] = self._inverse(field)
        nearest = self._nearest[field]
        if isinstance(value, Fraction):
            return nearest(value)
        at_zero = nearest(Fraction(0))
        not_finite = Rejection(Refusal.NOT_FINITE, f"{value} is invalid for `{field.name}`", field.name)
        return at_zero if isinstance(at_zero, Rejection) else not_finite

    def limits(self, type_: Type) -> str:
        """The allowed values of a type as text: `raw 0..1000`."""
        if type_.enum:
            return "the values " + ", ".join(str(member.value) for member in type_.enum)
        if type_.flags:
            return "the bits " + ", ".join(str(flag.value) for flag in type_.flags)
        span = type_.raw_range.at(self.assignment)
        if span is None and type_.encoding is Encoding.FLOAT:
            return "any finite number"
        low, high = type_.raw_limits
        return formatting.span(span) if span else f"raw {low}..{high}"

    def _accepting(self, type_: Type) -> Callable[[int], bool]:
        allows = self._allowed(type_)
        if type_.encoding is Encoding.FLOAT:
            return lambda raw: type_.no_value(raw) is not None or (is_finite(type_, raw) and allows(raw))
        return (lambda raw: type_.no_value(raw) is not None or allows(raw)) if type_.no_values else allows

    def _allowed(self, type_: Type) -> Callable[[int], bool]:
        valid = valid_raws(type_).at(self.assignment) or width_limits(type_)
        if isinstance(valid, NamedRaws):
            return frozenset(valid.values).__contains__
        if isinstance(valid, FlagBits):
            mask = valid.mask
            return lambda raw: not raw & ~mask
        low, high = type_.raw_limits
        if isinstance(valid, FiniteFloats):
            if valid.scaled is None:
                return lambda raw: low <= raw <= high
            ends = self._end(valid.scaled.low), self._end(valid.scaled.high)
            return lambda raw: low <= raw <= high and _has_value_within(value_of(type_, raw, self.assignment), *ends)
        return self._within(valid)

    def _within(self, valid: RawInterval) -> Callable[[int], bool]:
        """Whether a raw integer is a number within an interval."""
        first, last = valid.low, valid.high
        if valid.low_bound is None and valid.high_bound is None:
            return lambda raw: first <= raw <= last
        bounds = self._end(valid.low_bound), self._end(valid.high_bound)
        return lambda raw: first <= raw <= last and is_within(raw, *bounds)

    def _end(self, bound: Bound | None) -> Fraction | int | None:
        """The bound of a range; None if it depends on a missing parameter."""
        if bound is None:
            return None
        end = end_of(bound, self.assignment)
        return end.numerator if end is not None and end.denominator == 1 else end

    def _inverse(self, field: Field) -> Callable[[Fraction], int | Rejection]:
        """The conversion from a number in the unit to a raw integer."""
        type_ = field.type
        if type_.enum or type_.flags:
            no_integer = Rejection(Refusal.OUT_OF_RANGE, f"`{field.name}` has only whole numbers", field.name)
            return lambda value: value.numerator if value.denominator == 1 else no_integer
        linear = linear_of(type_, self.assignment)
        if linear is None or linear.scale == 0:
            line = type_.linear.at(self.assignment)
            needed = (type_.linear.parameter, *(factors(line.times).names if line and line.times else ()))
            missing = next((name for name in needed if name is not None and name not in self.assignment), None)
            reason, text = Refusal.NO_SCALE, "has no scale here"
            if missing:
                reason, text = Refusal.MISSING_PARAMETER, f"depends on `{missing}`, which is missing"
            elif line and line.times:
                reason, text = Refusal.OUT_OF_RANGE, f"depends on `{line.times}`, which must be above 0"
            rejection = Rejection(reason, f"`{field.name}` {text}", field.name)
            return lambda _: rejection
        if type_.encoding is Encoding.FLOAT:
            scale, offset = linear.scale, linear.offset
            return lambda value: _float_bits(field, (value - offset) / scale)
        factor, addend, divisor = linear.as_quotient

        def nearest(value: Fraction) -> int:
            above, below = value.numerator * divisor - addend * value.denominator, value.denominator * factor
            size = (2 * abs(above) + abs(below)) // (2 * abs(below))
            return size if (above < 0) == (below < 0) else -size

        return nearest


def exact_value(value: Value | Number | list[Number]) -> Value:
    """A value with its numbers as fractions; numbers that are not finite as `nan`, `inf` or `-inf`."""
    if isinstance(value, list):
        return [element if isinstance(element, str) else _exact(element) for element in value]
    return value if isinstance(value, str) else _exact(value)


def _exact(number: Number) -> Fraction | str:
    return Fraction(number) if math.isfinite(number) else str(float(number))


def _confused(message: Message, confusion: Confusion, frame: CanFrame) -> Rejection:
    """The rejection of a frame that is identified as another message."""
    data = " ".join(f"{byte:02X}" for byte in frame.data)
    text = f"{message.name} with these values is the {message.direction.value} of {confusion.command}: {data}"
    return Rejection(Refusal.WRONG_MESSAGE, text)


def _check_names(message: Message, fields: Mapping[str, Field] | None, given: Mapping[str, object]) -> None:
    """Raises ValueError unless exactly the fields of a message are given."""
    if fields is None or fields.keys() != given.keys():
        raise ValueError(f"{message.name} has the fields {', '.join(fields or ())}, not {', '.join(given)}")


def _frame(message: Message, id_: int, data: int) -> CanFrame:
    """The frame of a message with this id, and these data bytes as a little-endian integer."""
    written = b"" if message.remote else data.to_bytes(message.dlc, "little")
    return CanFrame(id_, written, message.id.extended, message.remote)


def _written(
    step: WriteCode | WriteFixed | WriteParameter | WriteField, raws: Mapping[Field, Raw], code: int | None
) -> tuple[Space, int]:
    """The bits that a step writes."""
    if isinstance(step, WriteCode):
        return step.key.space, placed(step.key.segments, step.key.value if code is None else code)
    if isinstance(step, WriteFixed):
        return step.space, placed(step.segments, step.raw)
    raw, bits = raws[step.field], 0
    for element, number in zip(step.field.elements, raw if isinstance(raw, list) else [raw], strict=True):
        bits |= placed(element.segments, number)
    return step.field.space, bits


def _joined_raws(field: Field, joined: Joined, value: Value) -> list[int] | Rejection:
    """The raw integers of a text, or of a number of decimal digits."""
    if isinstance(joined, JoinedDigits) and value in SPECIAL:
        return Rejection(Refusal.NOT_FINITE, f"{value} is invalid for `{field.name}`", field.name)
    raws = joined.raws(value)
    return (
        Rejection(Refusal.OUT_OF_RANGE, f"{value!s} is invalid for `{field.name}`", field.name)
        if raws is None
        else raws
    )


def _wrong_count(field: Field, count: int) -> Rejection | None:
    wanted = len(field.elements)
    text = f"`{field.name}` has {formatting.counted(wanted, 'element')}, not {count}"
    return None if count == wanted else Rejection(Refusal.OUT_OF_RANGE, text, field.name)


def _has_value_within(value: object, low: Fraction | int | None, high: Fraction | int | None) -> bool:
    """Whether a value is a number between two bounds, as far as they are known."""
    return isinstance(value, (int, Fraction)) and is_within(value, low, high)


def _float_bits(field: Field, value: Fraction) -> int | Rejection:
    try:
        number = float(value)
        if field.type.width == 32 and number != value and not bits_of(64, number) & 1:
            # with an odd last bit, the number is rounded to 32 bits as if only once
            number = math.nextafter(number, math.inf if value > number else -math.inf)
        return bits_of(field.type.width, number)
    except OverflowError:
        return Rejection(Refusal.OUT_OF_RANGE, f"`{field.name}` is too large for its float", field.name)
