"""The example of README.md: a command with golden frames in both directions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, Value as GoldenValue
from ...model.types import Parameter
from ..base import EditionInput, WorkedExchange
from ..examples import readme_exchange
from ..nested_source import Code, Value
from . import text
from .package import import_name


class Example:
    """A request and a frame that answers it, as JavaScript."""

    def __init__(self, editions: Sequence[Edition], edition: Edition, exchange: WorkedExchange) -> None:
        request, reply = exchange.request, exchange.reply
        assert request and reply
        parameters = {name: _written(edition.parameter(name), value) for name, value in exchange.parameters.items()}
        self.module, self.command = import_name(edition, editions), text.quoted(exchange.command.name)
        self.content, self.reply = text.printed(_content(request)), text.printed(_frame(reply))
        self.parameters = text.printed(parameters)
        self.field = text.key(next(iter(reply.values)))
        """A field of the reply, as a property."""


def example(specifications: Sequence[EditionInput]) -> Example | None:
    """A command with values."""
    shown = readme_exchange(specifications, _is_usable)
    return Example([item.edition for item in specifications], *shown) if shown else None


def _is_usable(edition: Edition, exchange: WorkedExchange) -> bool:
    """Whether the request can be encoded from values, and the reply has some."""
    request, reply = exchange.request, exchange.reply
    if request is None or reply is None or not reply.values or reply.remote:
        return False
    return request.values.keys() == request.raw.keys() and "none" not in request.values.values()


def _content(request: GoldenFrame) -> Value:
    values = {name: _value(value) for name, value in request.values.items()}
    return {"node": request.node, "values": values or None, "parameters": Code("parameters")}


def _frame(frame: GoldenFrame) -> Value:
    data = [Code(f"0x{byte:02X}") for byte in frame.data]
    return {"id": Code(f"0x{frame.id:X}"), "data": data, "extended": frame.extended or None}


def _value(value: GoldenValue) -> Value:
    if isinstance(value, list):
        return [_value(element) for element in value]
    if isinstance(value, Fraction):
        return value.numerator if value.denominator == 1 else float(value)
    return value


def _written(parameter: Parameter, value: str | Fraction) -> int | str:
    """A parameter as a program writes it: the number of a choice among numbers, any other value as text."""
    number = next((choice.number for choice in parameter.values if choice.name == value), None)
    return formatting.parameter_value(value) if number is None else number
