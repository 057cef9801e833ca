"""Fields of the spec as the signals of a DBC message: one each, one an element of an array, one a flag."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from cantools.database.can import Message, Signal
from cantools.database.namedsignalvalue import NamedSignalValue

from ..model.layout import Field
from ..model.refusal import Refusal
from ..model.types import Encoding, factors
from ..semantics.floats import bits_of, float_of
from ..targets.dbc.frames import Part
from ..targets.dbc.names import RAW_UNIT, signal_name, signals_of
from .adapter import Cannot, ExactValue, Refused, Value

Number = int | float
Data = dict[str, Number | str]
Place = tuple[Signal, int, str | None]
"""A signal, the raw bit it starts at, and the flag that it is, if any."""


@dataclass(frozen=True)
class Cell:
    """A field, or one element of an array."""

    field: Field
    signals: tuple[Place, ...]

    @property
    def signal(self) -> Signal:
        return self.signals[0][0]

    @property
    def is_divided(self) -> bool:
        """Whether each run of bits of a number is a signal."""
        return len(self.signals) > 1 and not self.field.type.flags

    def raw(self, numbers: Mapping[str, Number]) -> int:
        if self.field.type.encoding is Encoding.FLOAT:
            return bits_of(self.field.type.width, numbers[self.signal.name])
        return sum(int(numbers[signal.name]) << low for signal, low, _ in self.signals)

    def value(self, shown: Mapping[str, object]) -> float | str | list[str] | None:
        if self.is_divided:
            if self.field.type.enum:
                raise Cannot("several_runs")
            numbers = [shown[signal.name] for signal, _, _ in self.signals]
            return None if self.signal.unit == RAW_UNIT else float(sum(numbers))  # type: ignore[arg-type]
        if self.field.type.flags:
            return [flag for signal, _, flag in self.signals if flag and shown[signal.name]]
        value = shown[self.signal.name]
        if isinstance(value, NamedSignalValue) and str(value) == self.field.type.name_of(int(value.value)):
            value = self.signal.conversion.raw_to_scaled(value.value, decode_choices=False)
        if self.field.type.enum:
            return None if isinstance(value, (int, float)) else str(value)
        if self.field.type.no_values and not isinstance(value, (int, float)):
            return str(value)
        assert isinstance(value, (int, float))
        return None if self.signal.unit == RAW_UNIT else value

    def put_raw(self, data: Data, raw: int, parameters: Mapping[str, object]) -> Refused | None:
        if self.field.type.encoding is Encoding.FLOAT:
            if self.field.type.no_value(raw):
                raise Cannot("not_finite")
            data[self.signal.name] = float_of(self.field.type.width, raw)
            return None
        if self.field.type.no_value(raw):
            names = {int(value): str(name) for value, name in (self.signal.choices or {}).items()}
            if raw not in names:
                raise Cannot("no_value_ranges")
            data[self.signal.name] = names[raw]
            return None
        for signal, low, _ in self.signals:
            mask = (1 << signal.length) - 1
            part = raw >> low if self.is_divided and signal.is_signed else raw >> low & mask
            data[signal.name] = part if self.field.type.flags or self.is_divided else raw
        low, high = self.field.type.raw_limits
        there = sum((1 << signal.length) - 1 << start for signal, start, _ in self.signals)
        if self.is_divided and not low <= raw <= high:
            raise Cannot("several_runs")
        if self.field.type.flags and raw & ~there:
            return Refused(Refusal.OUT_OF_RANGE, self.field.name)
        return None

    def put_value(self, data: Data, value: ExactValue, parameters: Mapping[str, object]) -> Refused | None:
        type_ = self.field.type
        if self.is_divided:
            raise Cannot("several_runs")
        if type_.flags:
            names = value if isinstance(value, list) else []
            for signal, _, flag in self.signals:
                data[signal.name] = int(flag in names)
            flags = {flag for _, _, flag in self.signals}
            return None if flags.issuperset(names) else Refused(Refusal.OUT_OF_RANGE, self.field.name)
        if type_.encoding is Encoding.FLOAT and value in [named.name for named in type_.no_values]:
            raise Cannot("not_finite")
        if type_.enum or (type_.is_number and value in [member.name for member in type_.members]):
            data[self.signal.name] = str(value)
            known = {str(choice) for choice in (self.signal.choices or {}).values()}
            return None if value in known else Refused(Refusal.OUT_OF_RANGE, self.field.name)
        if self.signal.unit == RAW_UNIT:
            linear = type_.linear.at({name: str(value) for name, value in parameters.items()})
            needed = {type_.linear.parameter, *(factors(linear.times).names if linear and linear.times else ())} - {
                None
            }
            missing = not needed.issubset(parameters)
            return Refused(Refusal.MISSING_PARAMETER if missing else Refusal.NO_SCALE, self.field.name)
        assert not isinstance(value, list)
        number = float(value)
        data[self.signal.name] = int(number) if number.is_integer() else number
        if type_.encoding is not Encoding.FLOAT and math.isfinite(number):
            self._refuse_rounding(Fraction(value))
        return None

    def _refuse_rounding(self, value: Fraction) -> None:
        """Raises Cannot where cantools, which works in doubles, does not come to the nearest raw integer."""
        conversion, low, high = self.signal.conversion, self.signal.minimum, self.signal.maximum
        scale, offset = Fraction(str(conversion.scale)), Fraction(str(conversion.offset))
        exact = (value - offset) / scale
        nearest = math.floor(abs(exact) + Fraction(1, 2)) * (1 if exact > 0 else -1)
        if conversion.numeric_scaled_to_raw(float(value)) != nearest:
            raise Cannot("rounding")
        if (
            low is not None
            and high is not None
            and not low <= value <= high
            and low <= nearest * scale + offset <= high
        ):
            raise Cannot("rounding")


def cells(message: Message, part: Part, field: Field) -> list[Cell]:
    """The places of a field, found by name; none where the file does not have it."""
    result = []
    signals = _signals(message)
    for element in field.elements:
        named = ((signal_name(part, field, element) + bits.ending, bits) for bits in signals_of(field, element))
        places = [(signals[name], bits.low, bits.flag) for name, bits in named if name in signals]
        if places:
            result.append(Cell(field, tuple(places)))
    return result


def cell_of_selector(selector: Signal, field: Field) -> list[Cell]:
    """The place of a field in the bits of the selector; none where it has other bits."""
    bits = tuple(range(selector.start, selector.start + selector.length))
    return [Cell(field, ((selector, 0, None),))] if [e.bits for e in field.elements] == [bits] else []


@functools.lru_cache(maxsize=1024)
def _signals(message: Message) -> dict[str, Signal]:
    return {signal.name: signal for signal in message.signals}


def values_of(places: list[Cell], shown: Mapping[str, object]) -> Value:
    values = [cell.value(shown) for cell in places]
    return values if places[0].field.is_array else values[0]  # type: ignore[return-value]
