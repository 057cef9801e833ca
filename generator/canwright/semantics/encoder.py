"""What a sender makes of raw integers and values, straight from the model: whether a message can be written of them.

This is what every target does, in the same order, and refuses in the same words.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from fractions import Fraction

from ..language import notation
from ..language.golden_frames import Value
from ..model import formatting
from ..model.layout import Field
from ..model.message import Message
from ..model.refusal import Refusal
from ..model.types import Bound, Encoding, Range, Type
from .decoder import Raw, data_bits, linear_of, value_of
from .receiver import Refused

SPECIAL = ("nan", "inf", "-inf")


class Senders:
    """A sender for each set of parameters, made when it is first asked for."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[str, int | str], ...], Sender] = {}

    def under(self, parameters: Mapping[str, int | str]) -> Sender:
        key = tuple(parameters.items())
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = Sender(parameters)
        return known


class Sender:
    """Writes messages under some parameters; what it has worked out of a type it keeps."""

    def __init__(self, parameters: Mapping[str, int | str]) -> None:
        self.assignment = {name: str(value) for name, value in parameters.items()}
        self._fields: dict[int, tuple[Message, dict[str, Field] | None]] = {}
        self._reserved: dict[int, tuple[Message, int]] = {}
        self._allows: dict[int, tuple[Type, Callable[[int], bool]]] = {}
        self._raw_of: dict[int, tuple[Field, Callable[[Fraction], int | Refused]]] = {}

    def fields(self, message: Message) -> dict[str, Field] | None:
        """The fields of a message by name, constants left out; None when they depend on what is not given."""
        known = self._fields.get(id(message))
        if known is None:
            variant = message.layout.variant(self.assignment)
            fields = None if variant is None else {f.name: f for f in variant.fields if f.fixed is None}
            known = self._fields[id(message)] = (message, fields)
        return known[1]

    def reserved(self, message: Message) -> int:
        """The bits of the data that no key and no field of a message fills, the first byte lowest; they are sent as 0."""
        known = self._reserved.get(id(message))
        if known is None:
            variant = message.layout.variant(self.assignment)
            places = [(k.space, k.segments) for k in message.keys]
            places += [(f.space, e.segments) for f in (variant.fields if variant else ()) for e in f.elements]
            known = self._reserved[id(message)] = (message, ~data_bits(places))
        return known[1]

    def refuses(self, message: Message, node: int | None) -> Refused | None:
        """Why nothing can be sent to or from a node."""
        nodes = message.id.nodes
        if nodes is not None and (node is None or node not in nodes):
            text = f"{message.name} has no node {node}; its nodes are {nodes[0]}..{nodes[-1]}"
            return Refused(Refusal.UNKNOWN_NODE, text, "node")
        if self.fields(message) is None:
            text = f"the fields of {message.name} depend on `{message.layout.parameter}`, which is not given"
            return Refused(Refusal.MISSING_PARAMETER, text)
        return None

    def refuses_raw(self, field: Field, raw: Raw) -> Refused | None:
        """Why a field cannot hold a raw integer, or those of an array."""
        if isinstance(raw, list):
            return _refuses_count(field, len(raw)) or next(
                filter(None, (self.refuses_raw(field, r) for r in raw)), None
            )
        known = self._allows.get(id(field.type))
        if known is None:
            known = self._allows[id(field.type)] = (field.type, self._allowed(field.type))
        if known[1](raw):
            return None
        return Refused(Refusal.OUT_OF_RANGE, f"`{field.name}` cannot be raw {raw}", field.name)

    def refuses_value(self, field: Field, value: Value) -> Refused | None:
        """Why a field cannot hold a value, or those of an array. Names are taken to be those of the type."""
        if isinstance(value, list) and field.is_array:
            each = (self.refuses_value(field, one) for one in value)
            return _refuses_count(field, len(value)) or next(filter(None, each), None)
        raw = self.raw_of(field, value)
        return raw if isinstance(raw, Refused) else self.refuses_raw(field, raw)

    def raw_of(self, field: Field, value: Value) -> int | Refused:
        """The raw integer nearest to a value, ties away from zero; in range or not."""
        type_ = field.type
        if isinstance(value, list):
            return sum(1 << flag.value for flag in type_.flags if flag.name in value)
        if isinstance(value, str) and type_.enum:
            return next(member.value for member in type_.enum if member.name == value)
        known = self._raw_of.get(id(field))
        if known is None:
            known = self._raw_of[id(field)] = (field, self._inverse(field))
        if isinstance(value, Fraction):
            return known[1](value)
        lacking = known[1](Fraction(0))
        not_finite = Refused(Refusal.NOT_FINITE, f"`{field.name}` cannot be {value}", field.name)
        return lacking if isinstance(lacking, Refused) else not_finite

    def limits(self, type_: Type) -> str:
        """What a type allows, in words: `raw 0..1000`."""
        if type_.enum:
            return "the values " + ", ".join(str(member.value) for member in type_.enum)
        if type_.flags:
            return "the bits " + ", ".join(str(flag.value) for flag in type_.flags)
        span = type_.raw_range.at(self.assignment)
        if span is None and type_.encoding is Encoding.FLOAT:
            return "any finite number"
        low, high = type_.raw_limits
        return formatting.span(span) if span else f"raw {low}..{high}"

    def _allowed(self, type_: Type) -> Callable[[int], bool]:
        if type_.enum:
            return frozenset(member.value for member in type_.enum).__contains__
        if type_.flags:
            mask = sum(1 << flag.value for flag in type_.flags)
            return lambda raw: not raw & ~mask
        low, high = type_.raw_limits
        span = type_.raw_range.at(self.assignment)
        if span is None:
            return lambda raw: low <= raw <= high
        bottom, top = self._ends(span)
        if type_.encoding is Encoding.FLOAT:
            return lambda raw: low <= raw <= high and _is_within(value_of(type_, raw, self.assignment), bottom, top)
        return lambda raw: low <= raw <= high and _is_within(raw, bottom, top)

    def _ends(self, span: Range) -> tuple[Fraction | int | None, Fraction | int | None]:
        return self._end(span.low), self._end(span.high)

    def _end(self, bound: Bound) -> Fraction | int | None:
        """The end of a range; None where it depends on a parameter that is not given."""
        end = bound.at({n: notation.rational(text) for n, text in self.assignment.items() if n == bound.parameter})
        return end.numerator if end is not None and end.denominator == 1 else end

    def _inverse(self, field: Field) -> Callable[[Fraction], int | Refused]:
        """How a number in the unit becomes a raw integer."""
        type_ = field.type
        if type_.enum or type_.flags:
            nameless = Refused(Refusal.OUT_OF_RANGE, f"`{field.name}` holds whole numbers alone", field.name)
            return lambda value: value.numerator if value.denominator == 1 else nameless
        linear = linear_of(type_, self.assignment)
        if linear is None or linear.scale == 0:
            line = type_.linear.at(self.assignment)
            needed = (type_.linear.parameter, line.times if line else None)
            missing = next((name for name in needed if name is not None and name not in self.assignment), None)
            text = f"depends on `{missing}`, which is not given" if missing else "has no scale here"
            refused = Refused(
                Refusal.MISSING_PARAMETER if missing else Refusal.NO_SCALE, f"`{field.name}` {text}", field.name
            )
            return lambda _: refused
        if type_.encoding is Encoding.FLOAT:
            scale, offset = linear.scale, linear.offset
            return lambda value: _float_bits(field, (value - offset) / scale)
        factor, addend, divisor = linear.as_quotient

        def nearest(value: Fraction) -> int:
            above, below = value.numerator * divisor - addend * value.denominator, value.denominator * factor
            size = (2 * abs(above) + abs(below)) // (2 * abs(below))
            return size if (above < 0) == (below < 0) else -size

        return nearest


def _refuses_count(field: Field, count: int) -> Refused | None:
    wanted = len(field.elements)
    text = f"`{field.name}` has {formatting.counted(wanted, 'element')}, not {count}"
    return None if count == wanted else Refused(Refusal.OUT_OF_RANGE, text, field.name)


def _is_within(value: object, low: Fraction | int | None, high: Fraction | int | None) -> bool:
    """Whether a number lies between two ends, as far as they are known; what is no number does not."""
    if not isinstance(value, (int, Fraction)):
        return False
    return (low is None or value >= low) and (high is None or value <= high)


def _float_bits(field: Field, value: Fraction) -> int | Refused:
    bits, number = {32: ("<I", "<f"), 64: ("<Q", "<d")}[field.type.width]
    try:
        raw: int = struct.unpack(bits, struct.pack(number, float(value)))[0]
    except OverflowError:
        return Refused(Refusal.OUT_OF_RANGE, f"`{field.name}` is too large for its float", field.name)
    return raw
