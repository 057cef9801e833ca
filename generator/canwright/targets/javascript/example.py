"""The example of README.md: a command with golden frames in both directions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True, kw_only=True)
class Example:
    """A request and a frame that answers it, as JavaScript."""

    module: str
    command: str
    content: str
    parameters: str
    reply: str
    field: str
    """A field of the reply, as a property."""


def example(specifications: Sequence[EditionInput]) -> Example | None:
    """A command with values."""
    shown = readme_exchange(specifications, _is_usable)
    if shown is None or shown[1].request is None or shown[1].reply is None:
        return None
    edition, exchange = shown
    parameters = {name: _written(edition.parameter(name), value) for name, value in exchange.parameters.items()}
    return Example(
        module=import_name(edition, [item.edition for item in specifications]),
        command=text.quoted(exchange.command.name),
        content=text.printed(_content(shown[1].request)),
        parameters=text.printed(parameters),
        reply=text.printed(_frame(shown[1].reply)),
        field=text.key(next(iter(shown[1].reply.values))),
    )


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
