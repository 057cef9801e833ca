"""The example of README.md: one command with its golden frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, Value
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.types import Assignment, Parameter
from ...semantics.decoder import Decoder, Rejection
from ...semantics.encoder import Encoder
from ...semantics.exchange import check_reply
from ...semantics.frame import CanFrame
from ..base import EditionInput
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
    shares_ids: bool
    """Whether requests and replies of the edition have the same ids."""
    probe: str
    """A request without effects whose reply always differs from it; empty where the edition has none."""


class Argument(NamedTuple):
    """A keyword with the expression of its value, and the enum class that the expression uses, if any."""

    keyword: str
    value: str
    enum: str


def example(specifications: Sequence[EditionInput]) -> Example | None:
    """The first command with values in both directions; where there is none, the first with values in its reply."""
    first: Example | None = None
    for one in (one for item in specifications for one in _examples(item)):
        if one.is_full:
            return one
        first = first or one
    return first


def _examples(specification: EditionInput) -> Iterator[Example]:
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
    node = 1 if request.node is None else request.node
    shares_ids = any(c.request and c.reply and c.request.id == c.reply.id for c in edition.commands)
    probe = _probe(edition, node, {name: str(value) for name, value in given.items()}) if shares_ids else None
    names |= {text.class_name(probe.name)} if probe else set()
    names |= {"Parameters"} if known else set()
    names |= {text.class_name(p.name) for p in parameters if p.is_choice and not p.is_numeric}
    return Example(
        edition.family,
        edition.identifier,
        tuple(sorted(names)),
        ", ".join(known),
        classes[0],
        node,
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
        shares_ids,
        f"{text.class_name(probe.name)}({f'node={node}' if probe.id.nodes is not None else ''})" if probe else "",
    )


def _probe(edition: Edition, node: int, assignment: Assignment) -> Message | None:
    """The first request without fields and effects whose reply always differs from it.

    None if the spec defines no effects, because then nothing is known about those of a command.
    """
    for command in edition.commands if edition.effects else ():
        request, reply = command.request, command.reply
        if request is None or reply is None or command.effects or command.from_each or not command.implemented:
            continue
        is_bare = not any(field.role.is_value for field in request.layout.fields)
        if is_bare and command.available(assignment) and _differ(edition, request, reply, node):
            return request
    return None


def _differ(edition: Edition, request: Message, reply: Message, node: int) -> bool:
    """Whether no working node replies with the bytes of a request without fields."""
    encoder = Encoder({})
    frame = encoder.encode_raws(request, node if request.id.nodes is not None else None, {})
    if isinstance(frame, Rejection) or reply.layout.parameter is not None:
        return False
    found = Decoder(edition).decode_as(reply, frame, {})
    if isinstance(found, Rejection):
        return True
    fields = [field for field in found.variant.fields if field.role.is_value]
    return any(
        encoder.rejects_raw(field, found.raws[field.name]) or _is_implausible(field, found.values[field.name])
        for field in fields
    )


def _is_implausible(field: Field, value: object) -> bool:
    """Whether no working node reports a value."""
    plausible = field.type.plausible
    if plausible is None or not isinstance(value, Fraction):
        return False
    low, high = plausible.low.at({}), plausible.high.at({})
    return (low is not None and value < low) or (high is not None and value > high)


def arguments(message: Message, frame: GoldenFrame, views: Mapping[str, types.TypeView]) -> list[Argument] | None:
    """The values that make the message of a frame; None where a field has no value."""
    found: list[Argument] = []
    variant = message.layout.variant(frame.parameters)
    for field in (f for f in (variant.fields if variant else ()) if f.role.is_value):
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


def parameter_argument(parameter: Parameter, given: Assignment) -> str:
    """An argument of `Parameters`."""
    value = formatting.parameter_value(given[parameter.name])
    return f"{text.attribute(parameter.name)}={types.parameter_key(parameter, value) if parameter.is_choice else value}"
