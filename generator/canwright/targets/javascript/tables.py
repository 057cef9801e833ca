"""What an edition states of its types, layouts and messages, as tables."""

from __future__ import annotations

from functools import cached_property, lru_cache

from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Message
from ...model.types import Bound, Linear, Parameter, Type
from ...semantics.valid_raws import FiniteFloats, RawInterval, ValidRaws, valid_raws, width_limits
from ..field_contents import Content
from ..nested_source import Table, Value
from ..tables import EditionTables
from . import text


class JavaScriptTables(EditionTables):
    """Integers of more than 53 bits are BigInt; ranges and scales are exact."""

    unknown = text.NULL

    def integer(self, raw: int, width: int) -> Value:
        return text.integer(raw, width)

    def type(self, type_: Type) -> dict[str, Value]:
        valid = valid_raws(type_)
        is_limited = type_.is_number and any(case != width_limits(type_) for _, case in valid.distinct())
        no_values: list[Value] = [
            [self.integer(n.raws[0], type_.width), self.integer(n.raws[-1], type_.width), n.name]
            for n in type_.no_values
        ]
        return {
            **super().type(type_),
            "range": self.by_parameter(valid, _range) if is_limited else None,
            "noValues": no_values or None,
        }

    def field(self, field: Field, content: Content | None) -> dict[str, Value]:
        """A field, with what tools ask besides its value."""
        counter = [field.counter.first, field.counter.last] if field.counter else None
        return {**super().field(field, content), "checksum": True if field.checksum else None, "counter": counter}

    @cached_property
    def parameters(self) -> Table:
        """The parameters by name."""
        return {parameter.name: _parameter(parameter) for parameter in self.edition.parameters}

    def tables(self) -> dict[str, Value]:
        """The tables that the page of the explorer interprets."""
        return {"parameters": self.parameters, **super().tables()}

    def message(self, message: Message) -> dict[str, Value]:
        """A message with all that is checked; `confusions` are what a frame that is encoded must not be."""
        confusions: list[Value] = [
            {"command": confusion.command, "conditions": [self.condition(*each) for each in confusion.conditions]}
            for confusion in message.confusions
        ]
        only: Value = {name: list(values) for name, values in message.only.items()} or None
        return {**self.about(message), **self.checked(message), "only": only, "confusions": confusions or None}

    def about(self, message: Message) -> dict[str, Value]:
        """What a message is; its functions in a module decide the rest."""
        sending, sequence = message.sending, message.sequence
        table = super().message(message)
        if sequence is not None:
            table["frames"] = {"field": sequence.field, "first": sequence.numbers[0], "last": sequence.numbers[-1]}
        if sending is not None:
            times = {"everyMs": sending.every_ms, "timeoutMs": sending.timeout_ms}
            table["sent"] = [occasion.value for occasion in sending.occasions] or None
            table |= {name: None if time is None else text.double(time) for name, time in times.items()}
        return table

    def linear(self, linear: Linear) -> Value:
        factor, addend, divisor = linear.as_quotient
        steps = [text.double(n) for n in (linear.offset, linear.scale.denominator, linear.scale.numerator)]
        return {
            "factor": factor if factor != 1 else None,
            "addend": addend or None,
            "divisor": divisor if divisor != 1 else None,
            "steps": steps if addend else None,
            "times": linear.times,
        }


@lru_cache(maxsize=64)
def tables_of(edition: Edition) -> JavaScriptTables:
    """The tables of an edition; cached, because its module and the page of the explorer print them."""
    return JavaScriptTables(edition)


def _parameter(parameter: Parameter) -> Table:
    """The values of a choice, or the limits of a number."""
    if parameter.is_choice:
        return {"values": [value.name for value in parameter.values]}
    return {
        "whole": parameter.whole or None,
        "minimum": None if parameter.minimum is None else text.rational(parameter.minimum),
        "maximum": None if parameter.maximum is None else text.rational(parameter.maximum),
    }


def _range(valid: ValidRaws) -> Value:
    """The ends: of raw integers, or of the values of a float."""
    if isinstance(valid, RawInterval):
        low, high = valid.low_bound, valid.high_bound
        return [valid.low if low is None else _bound(low), valid.high if high is None else _bound(high)]
    if isinstance(valid, FiniteFloats) and valid.scaled:
        return [_bound(valid.scaled.low), _bound(valid.scaled.high)]
    return text.NULL


def _bound(bound: Bound) -> Value:
    if bound.parameter is None:
        return text.rational(bound.constant)
    return [text.rational(bound.constant), text.rational(bound.coefficient), bound.parameter]
