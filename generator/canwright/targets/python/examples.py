"""The example of README.md: one command with its golden frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...language.golden_frames import GoldenFrame, Value
from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.types import Parameter
from ...semantics.decoder import Decoder, Rejection
from ...semantics.exchange import check_reply
from ...semantics.frame import CanFrame
from ..base import Specification
from . import text, types
from .class_bodies import depends_on_parameters
from .imports import Imports


class Example(NamedTuple):
    """A request and a frame that answers it; `known` are the arguments of `Parameters`."""

    family: str
    edition: str
    names: tuple[str, ...]
    known: str
    request: str
    node: int
    """The node of both; 1 if their ids have none."""
    values: str
    """The arguments of the request without node and parameters."""
    arguments: str
    reply: str
    reply_id: str
    extended: bool
    data: str
    field: str
    parameters: str
    """The last argument of calls that decode a frame; empty where no parameter is needed."""
    reply_within_ms: str
    """Empty where the specification gives no time."""
    is_full: bool
    """Whether the request has values too."""


class Argument(NamedTuple):
    """A keyword with the expression of its value, and the enum class that the expression uses, if any."""

    keyword: str
    value: str
    enum: str


def example(specifications: Sequence[Specification]) -> Example | None:
    """The first command with values in both directions; where there is none, the first with values in its reply."""
    first: Example | None = None
    for one in (one for item in specifications for one in _examples(item)):
        if one.is_full:
            return one
        first = first or one
    return first


def _examples(specification: Specification) -> Iterator[Example]:
    frames = specification.frames.of_command if specification.frames else {}
    decoder = Decoder(specification.edition)
    for command in specification.edition.commands:
        sent = frames.get((command.name, Direction.REQUEST), ())
        answered = [f for f in frames.get((command.name, Direction.REPLY), ()) if f.values and not f.remote]
        pairs = ((q, r) for q in sent for r in answered if _belong(q, r, decoder))
        for request, reply in pairs:
            made = _example(specification.edition, command, request, reply)
            if made:
                yield made
                break


def _belong(request: GoldenFrame, reply: GoldenFrame, decoder: Decoder) -> bool:
    """Whether a reply answers a request: same node, no contradicting parameters, and both can be encoded."""
    agree = all(reply.parameters.get(name, value) == value for name, value in request.parameters.items())
    if not agree or request.node != reply.node or request.decode_only or reply.decode_only:
        return False
    frames = (CanFrame(one.id, one.data, one.extended, one.remote) for one in (request, reply))
    return not isinstance(check_reply(decoder, *frames), Rejection)


def _example(edition: Edition, command: Command, request: GoldenFrame, reply: GoldenFrame) -> Example | None:
    asked, answer = command.message(Direction.REQUEST), command.message(Direction.REPLY)
    if asked is None or answer is None or answer.command != command.name:
        return None
    views = types.type_views(edition, Imports())
    sent = arguments(asked, request, views)
    fields = [f for f in answer.layout.fields if f.name in reply.values]
    if sent is None or not fields:
        return None
    given = {**request.parameters, **reply.parameters}
    parameters = [p for p in edition.parameters if p.name in given]
    known = [parameter_argument(p, given) for p in parameters]
    values = [f"{argument.keyword}={argument.value}" for argument in sent]
    keywords = [f"node={request.node}"] if asked.id.nodes is not None else []
    keywords += values
    if known and depends_on_parameters(asked.layout):
        keywords.append("parameters=known")
    classes = text.class_name(asked.name), text.class_name(answer.name)
    names = {*classes, "CodecError", "REPLY_WITHIN_MS", "decode_answer", "decode_reply"}
    names |= {argument.enum for argument in sent if argument.enum}
    names |= {"Parameters"} if known else set()
    names |= {text.class_name(p.name) for p in parameters if p.is_choice and not p.is_numeric}
    return Example(
        edition.family,
        edition.identifier,
        tuple(sorted(names)),
        ", ".join(known),
        classes[0],
        1 if request.node is None else request.node,
        ", ".join(values),
        ", ".join(keywords),
        classes[1],
        f"0x{reply.id:X}",
        reply.extended,
        reply.data.hex(" ").upper(),
        text.attribute(fields[0].name),
        ", known" if known else "",
        "" if edition.bus.reply_within_ms is None else str(float(edition.bus.reply_within_ms)),
        bool(asked.layout.fields),
    )


def arguments(message: Message, frame: GoldenFrame, views: Mapping[str, types.TypeView]) -> list[Argument] | None:
    """The values that make the message of a frame; None where a field has no value."""
    found: list[Argument] = []
    variant = message.layout.variant({name: str(value) for name, value in frame.parameters.items()})
    for field in (f for f in (variant.fields if variant else ()) if f.fixed is None):
        view = views[field.type.name]
        value = _value(field, frame.values.get(field.name), view)
        if value is None:
            return None
        found.append(Argument(text.attribute(field.name), value, view.enum))
    return found


def _value(field: Field, value: Value | None, view: types.TypeView) -> str | None:
    if isinstance(value, list) and not field.type.flags:
        parts = [_value(field, one, view) for one in value]
        return None if None in parts else f"({', '.join(map(str, parts))},)"
    if isinstance(value, list):
        return " | ".join(f"{view.enum}.{text.member_name(str(name))}" for name in value) or f"{view.enum}(0)"
    if isinstance(value, Fraction):
        return str(value.numerator) if value.denominator == 1 else repr(float(value))
    return f"{view.enum}.{text.member_name(value)}" if value and field.type.enum and value != "none" else None


def parameter_argument(parameter: Parameter, given: Mapping[str, int | str]) -> str:
    """An argument of `Parameters`."""
    value = str(given[parameter.name])
    return f"{text.attribute(parameter.name)}={types.parameter_key(parameter, value) if parameter.is_choice else value}"
