"""Exchanges: which replies answer a request, and the check of a frame against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from ..model.edition import Edition
from ..model.message import BitRun, Command, Direction, EchoReply, Message, Reply
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS, Assignment
from .decoder import Decoder, Identified, Rejection, rejects_checked
from .encoder import Encoder
from .frame import CanFrame, difference, node_in_id, read_bits
from .plan import message_plan


@lru_cache(maxsize=4096)
def repeats_request(command: Command) -> bool:
    """Whether a reply can be equal to its request: it is an echo, or has no other bits than those that the request sets."""
    request = command.request
    if request is None or all(reply.message.id != request.id for reply in command.replies):
        return False
    if command.is_echoed or not request.layout.fields:
        return command.is_echoed
    reserved = message_plan(request).reserved.mask
    return any(not reserved & ~message_plan(reply.message).reserved.mask for reply in command.replies)


@dataclass(frozen=True, eq=False, kw_only=True)
class ExchangePlan:
    """The checks of a frame after a request for one of the replies to it, in this order; each rejects it (not_answer).

    A frame that passes those of any reply answers the request.

    1. The frame has the id, the length and the keys of `reply`.
    2. The node in the id of the frame is expected: one of `nodes`; if these are empty, that of the request, compared in
       the bits of `asked` if the request contains it in a field.
    3. The node in the bits of `reported` is expected, compared in the bits that both fields have.
    4. With `is_echo`, the data is that of the request.

    A node that is unknown, in a fixed id or by a request without one, is not compared.
    """

    command: Command
    request: Message
    reply: Message
    frames: int
    """The number of frames of one node, at most."""
    is_alternative: bool
    """Whether it is sent instead of the other replies."""
    nodes: tuple[int, ...]
    asked: BitRun | None
    reported: BitRun | None
    is_echo: bool
    reply_within_ms: Fraction | None
    """Maximum time from request to reply: that of the command, else that of the bus."""

    @property
    def has_distinct_request(self) -> bool:
        """Whether the request reserves bits that the reply does not, so that the data can tell them apart."""
        return bool(message_plan(self.request).reserved.mask & ~message_plan(self.reply).reserved.mask)


@lru_cache(maxsize=16)
def exchange_plans(edition: Edition) -> Mapping[Message, Sequence[ExchangePlan]]:
    """The exchanges that each request starts, one for each reply; cached, because every target asks for it."""
    return {
        c.request: [_plan(edition, c, c.request, reply) for reply in c.replies]
        for c in edition.commands
        if c.request is not None
    }


def _plan(edition: Edition, command: Command, request: Message, reply: Reply) -> ExchangePlan:
    within = edition.bus.reply_within_ms if command.reply_within_ms is None else command.reply_within_ms
    return ExchangePlan(
        command=command,
        request=request,
        reply=reply.message,
        frames=reply.frames,
        is_alternative=reply.is_alternative,
        nodes=command.from_each,
        asked=None if command.from_each else request.node_bits,
        reported=reply.message.node_bits,
        is_echo=isinstance(reply, EchoReply),
        reply_within_ms=within,
    )


def check_reply(
    decoder: Decoder, request: CanFrame, reply: CanFrame, assignment: Assignment = NO_PARAMETERS
) -> Identified | Rejection:
    """The reply to a request that a frame is; rejected if it is none, or if the request is rejected.

    Of the parameters, only those in ids matter.
    """
    sent = decoder.identify(Direction.REQUEST, request, assignment)
    if isinstance(sent, Rejection):
        return sent
    invalid = rejects_checked(sent.message, request, {})
    if invalid is not None:
        return invalid
    rejected: Rejection | None = None
    for plan in exchange_plans(decoder.edition)[sent.message]:
        answer = _checked(plan, sent, request, reply, assignment)
        if isinstance(answer, Identified):
            return answer
        rejected = rejected or answer
    return rejected or _no_answer(f"{sent.message.command} has no reply")


def _checked(
    plan: ExchangePlan, sent: Identified, request: CanFrame, reply: CanFrame, assignment: Assignment
) -> Identified | Rejection:
    wrong = difference(plan.reply, reply, assignment)
    if wrong:
        return _no_answer(wrong.text)
    source = node_in_id(plan.reply, reply, assignment)
    to, bits = sent.node, -1
    if plan.asked:
        to, bits = read_bits(plan.asked, request), (1 << plan.asked.width) - 1
    nodes: Sequence[int] = plan.nodes or (() if to is None else (to,))
    if not _is_from(nodes, source, bits):
        return _no_answer(f"it comes from node {source}, not {_listed(nodes)}")
    if plan.reported:
        reported = read_bits(plan.reported, reply)
        if not _is_from(nodes, reported, bits & (1 << plan.reported.width) - 1):
            return _no_answer(f"`{plan.reported.name}` is node {reported}, not {_listed(nodes)}")
    if plan.is_echo and request.data != reply.data:
        return _no_answer(f"the reply of {plan.command.name} is an echo, but this frame differs from the request")
    return Identified(plan.reply, source)


def _no_answer(text: str) -> Rejection:
    return Rejection(Refusal.NOT_ANSWER, text)


def _is_from(nodes: Sequence[int], source: int | None, bits: int) -> bool:
    """Whether a node is one of `nodes` in the known `bits`; True if either is unknown."""
    return source is None or not nodes or any(not (source ^ node) & bits for node in nodes)


def _listed(nodes: Sequence[int]) -> str:
    return " or ".join(map(str, nodes)) if len(nodes) < 3 else f"{min(nodes)}..{max(nodes)}"


def is_read(edition: Edition, command: Command) -> bool:
    """Whether a command has neither values nor effects, and one frame of its node as its reply.

    No command is known to be one if the spec has no effects, because then nothing is known about those of a command.
    """
    request = command.request
    if not edition.effects or request is None or len(command.replies) != 1 or not command.implemented:
        return False
    reply = command.replies[0]
    has_one_frame = not reply.from_each and reply.frames == 1 and not isinstance(reply, EchoReply)
    is_bare = not command.effects and not any(field.is_given for field in request.layout.fields)
    return has_one_frame and is_bare and has_node(request)


def reply_differs(edition: Edition, command: Command) -> bool:
    """Whether no working node replies to a read with the frame of its request."""
    request, reply = command.request, command.reply
    if request is None or reply is None or request.id != reply.id:
        return True
    encoder = Encoder({})
    node = (request.id.nodes[0] if request.id.nodes else 1) if request.id.nodes is not None else None
    frame = encoder.encode_raws(request, node, {})
    if isinstance(frame, Rejection) or reply.layout.parameter is not None:
        return False
    decoded = Decoder(edition).decode_as(reply, frame, {})
    if isinstance(decoded, Rejection):
        return True
    return any(
        encoder.rejects_raw(field, decoded.raws[field.name]) or not field.type.is_plausible(decoded.values[field.name])
        for field in decoded.variant.fields
        if field.is_given
    )


def has_node(message: Message) -> bool:
    """Whether the frames of a message contain their node."""
    return message.id.nodes is not None or message.node_in_data is not None
