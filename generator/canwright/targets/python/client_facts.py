"""What a client knows of an edition besides its frames: effects, harmless reads, the commands that end a motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...model import formatting
from ...model.edition import Edition
from ...model.message import Command, EchoReply, Message
from ...model.metadata import Repeat
from ...semantics.decoder import Decoder, Rejection
from ...semantics.encoder import Encoder
from . import code, text


@dataclass(frozen=True, kw_only=True)
class ClientFactsView:
    """Expressions of the arguments of `ClientFacts`."""

    effects: code.Code
    reads: code.Code
    ends_motion: code.Code
    answers_in_order: bool


def view(edition: Edition) -> ClientFactsView:
    """The facts of an edition."""
    effects = (
        code.tuple_of(
            (
                text.literal(formatting.english(effect.title)),
                text.literal(effect.consent.value),
                str(effect.repeat is Repeat.SAME),
            ),
            f"{text.literal(effect.name)}: ",
        )
        for effect in edition.effects
    )
    ends: dict[str, Message] = {}
    for command in edition.commands:
        if command.ends_motion and command.request and _has_node(command.request):
            ends.setdefault(command.ends_motion.value, command.request)
    reads = [command for command in edition.commands if is_read(edition, command)]
    reads.sort(key=lambda command: command.entry is not None)  # those of measured values first
    return ClientFactsView(
        effects=code.dict_of(effects),
        reads=code.tuple_of(text.class_name(c.request.name) for c in reads if c.request),
        ends_motion=code.dict_of(f"{text.literal(kind)}: {text.class_name(m.name)}" for kind, m in ends.items()),
        answers_in_order=edition.bus.answers_in_order,
    )


def class_attributes(edition: Edition, command: Command) -> Iterator[code.Code]:
    """Assignments of the class of a request; what a command does not have is left to the base class."""
    exempt: dict[str, dict[int, list[str]]] = {}
    for effect in command.effects:
        for field, member in command.exemptions(effect):
            exempt.setdefault(text.attribute(field.name), {}).setdefault(member.value, []).append(effect.name)
    if exempt:
        fields = (
            code.dict_of(
                (code.tuple_of(map(text.literal, names), f"{raw}: ") for raw, names in values.items()),
                f"{text.literal(field)}: ",
            )
            for field, values in exempt.items()
        )
        yield code.dict_of(fields, "EXEMPT = ")
    if command.repeat is not None:
        yield f"REPEAT = {command.repeat is Repeat.SAME}"
    replies = sum(reply.frames * (len(reply.from_each) or 1) for reply in command.replies if not reply.is_alternative)
    if replies != 1:
        yield f"REPLIES = {replies}"
    if command.from_each:
        yield code.tuple_of(map(str, command.from_each), "REPLIERS = ")
    if is_read(edition, command) and command.request and command.reply:
        node = command.request.id.nodes[0] if command.request.id.nodes else 1
        if replies_differ(edition, command.request, command.reply, node):
            yield "DIFFERS = True"
    if command.reply_within_ms is not None:
        yield f"REPLY_WITHIN_MS = {float(command.reply_within_ms)!r}"


def is_read(edition: Edition, command: Command) -> bool:
    """Whether a command has neither values nor effects, and one frame of its node as its reply.

    No command is known to be one if the spec has no effects, because then nothing is known about those of a command.
    """
    request = command.request
    if not edition.effects or request is None or len(command.replies) != 1 or not command.implemented:
        return False
    reply = command.replies[0]
    has_one_frame = not reply.from_each and reply.frames == 1 and not isinstance(reply, EchoReply)
    is_bare = not command.effects and not any(field.role.is_value for field in request.layout.fields)
    return has_one_frame and is_bare and _has_node(request)


def _has_node(message: Message) -> bool:
    return message.id.nodes is not None or message.node_in_data is not None


def replies_differ(edition: Edition, request: Message, reply: Message, node: int) -> bool:
    """Whether no working node replies with the frame of a request without fields."""
    if request.id != reply.id:
        return True
    encoder = Encoder({})
    frame = encoder.encode_raws(request, node if request.id.nodes is not None else None, {})
    if isinstance(frame, Rejection) or reply.layout.parameter is not None:
        return False
    decoded = Decoder(edition).decode_as(reply, frame, {})
    if isinstance(decoded, Rejection):
        return True
    fields = [field for field in decoded.variant.fields if field.role.is_value]
    return any(
        encoder.rejects_raw(field, decoded.raws[field.name]) or not field.type.is_plausible(decoded.values[field.name])
        for field in fields
    )
