"""Exchanges: which replies answer a request, and the check of a frame against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from ..model.edition import Edition
from ..model.message import BitRun, Command, Direction, Message
from ..model.refusal import Refusal
from .decoder import Decoder, Identified, Rejection, rejects_constants
from .frame import CanFrame, difference, node_in_id, read_bits
from .plan import message_plan


@dataclass(frozen=True, eq=False, kw_only=True)
class ExchangePlan:
    """The checks of a frame after a request, in this order; each rejects it (not_answer).

    1. There is a `reply`, and the frame has its id, length and keys.
    2. The node in the id of the frame is expected: one of `nodes`; if these are empty, that of the request, compared in
       the bits of `asked` if the request contains it in a field.
    3. The node in the bits of `reported` is expected, compared in the bits that both fields have.
    4. With `is_echo`, the data is that of the request.

    A node that is unknown, in a fixed id or by a request without one, is not compared.
    """

    command: Command
    request: Message
    reply: Message | None
    nodes: tuple[int, ...]
    asked: BitRun | None
    reported: BitRun | None
    is_echo: bool
    reply_within_ms: Fraction | None
    """Maximum time from request to reply: that of the command, else that of the bus."""

    @property
    def has_distinct_request(self) -> bool:
        """Whether the request reserves bits that the reply does not, so that the data can tell them apart."""
        if self.reply is None:
            return False
        return bool(message_plan(self.request).reserved.mask & ~message_plan(self.reply).reserved.mask)


@lru_cache(maxsize=16)
def exchange_plans(edition: Edition) -> Mapping[Message, ExchangePlan]:
    """The exchange that each request starts; cached, because every target asks for it."""
    return {c.request: _plan(edition, c, c.request) for c in edition.commands if c.request is not None}


def _plan(edition: Edition, command: Command, request: Message) -> ExchangePlan:
    within = edition.bus.reply_within_ms if command.reply_within_ms is None else command.reply_within_ms
    return ExchangePlan(
        command=command,
        request=request,
        reply=command.reply,
        nodes=command.from_each,
        asked=None if command.from_each else request.node_bits,
        reported=command.reply.node_bits if command.reply else None,
        is_echo=command.is_echoed,
        reply_within_ms=within,
    )


def check_reply(decoder: Decoder, request: CanFrame, reply: CanFrame) -> Identified | Rejection:
    """The reply to a request that a frame is; rejected if it is not one, or if the request is rejected."""
    sent = decoder.identify(Direction.REQUEST, request)
    if isinstance(sent, Rejection):
        return sent
    invalid = rejects_constants(sent.message, request, {})
    if invalid is not None:
        return invalid
    plan = exchange_plans(decoder.edition)[sent.message]
    if plan.reply is None:
        return _no_answer(f"{plan.command.name} has no reply")
    wrong = difference(plan.reply, reply)
    if wrong:
        return _no_answer(wrong.text)
    source = node_in_id(plan.reply, reply)
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
