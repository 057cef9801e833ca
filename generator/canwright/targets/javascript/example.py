"""The example of README.md: a command with golden frames in both directions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, Value as GoldenValue
from ...model.message import Direction
from ...model.types import Parameter
from ...semantics.decoder import Decoder, Rejection
from ...semantics.exchange import check_reply
from ...semantics.frame import CanFrame
from ..base import EditionInput
from ..nested_source import Code
from . import text
from .package import import_name
from .text import Value


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
    has_values: bool
    """Whether the request has fields."""


def example(specifications: Sequence[EditionInput]) -> Example | None:
    """The first command with fields in both directions; with fields in its reply if there is none."""
    editions = [one.edition for one in specifications]
    first: Example | None = None
    for one in (one for item in specifications for one in _examples(item, editions)):
        if one.has_values:
            return one
        first = first or one
    return first


def _examples(item: EditionInput, editions: Sequence[Edition]) -> Iterator[Example]:
    frames = item.frames.of_command if item.frames else {}
    decoder = Decoder(item.edition)
    for command in item.edition.commands:
        requests = frames.get((command.name, Direction.REQUEST), ())
        replies = frames.get((command.name, Direction.REPLY), ())
        for request, reply in ((q, r) for q in requests for r in replies if _belong(q, r, decoder)):
            given = {**request.parameters, **reply.parameters}
            parameters = {name: _written(item.edition.parameter(name), value) for name, value in given.items()}
            yield Example(
                module=import_name(item.edition, editions),
                command=text.quoted(command.name),
                content=text.printed(_content(request)),
                parameters=text.printed(parameters),
                reply=text.printed(_frame(reply)),
                field=text.key(next(iter(reply.values))),
                has_values=bool(request.values),
            )
            break


def _belong(request: GoldenFrame, reply: GoldenFrame, decoder: Decoder) -> bool:
    """Whether a reply with values answers a request, under parameters that agree, and the request can be encoded."""
    agree = all(reply.parameters.get(name, value) == value for name, value in request.parameters.items())
    if not agree or not reply.values or reply.remote or request.decode_only:
        return False
    if set(request.values) != set(request.raw) or "none" in request.values.values():
        return False
    frames = (CanFrame(one.id, one.data, one.extended, one.remote) for one in (request, reply))
    return not isinstance(check_reply(decoder, *frames), Rejection)


def _content(request: GoldenFrame) -> Value:
    values = {name: _value(value) for name, value in request.values.items()}
    return {"node": request.node, "values": values or None, "parameters": Code("parameters")}


def _frame(frame: GoldenFrame) -> Value:
    data = [Code(f"0x{byte:02X}") for byte in frame.data]
    return {"id": Code(f"0x{frame.id:X}"), "data": data, "extended": frame.extended or None}


def _value(value: GoldenValue) -> Value:
    if isinstance(value, list):
        return [_value(one) for one in value]
    if isinstance(value, Fraction):
        return value.numerator if value.denominator == 1 else float(value)
    return value


def _written(parameter: Parameter, value: str | Fraction) -> int | str:
    """A parameter as a program writes it: the number of a choice among numbers, any other value as text."""
    number = next((choice.number for choice in parameter.values if choice.name == value), None)
    return formatting.parameter_value(value) if number is None else number
