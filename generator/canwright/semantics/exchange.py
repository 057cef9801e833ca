"""Exchanges: whether a frame is the reply to a request, or the reason why not."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.message import Direction
from ..model.refusal import Refusal
from .decoder import Decoder, Identified, Rejection, rejects_constants
from .frame import CanFrame, difference, node_in_id, read_bits


def check_reply(decoder: Decoder, request: CanFrame, reply: CanFrame) -> Identified | Rejection:
    """The reply to a request that a frame is; rejected if it is not one, or if the request is rejected."""
    sent = decoder.identify(Direction.REQUEST, request)
    if isinstance(sent, Rejection):
        return sent
    invalid = rejects_constants(sent.message, request, {})
    if invalid is not None:
        return invalid
    command = decoder.edition.command(sent.message.command)
    expected = command.reply
    if expected is None:
        return _no_answer(f"{command.name} has no reply")
    wrong = difference(expected, reply)
    if wrong:
        return _no_answer(wrong.text)
    source = node_in_id(expected, reply)
    asked, reported = sent.message.node_bits, expected.node_bits
    to, bits = sent.node, -1
    if asked and not command.from_each:
        to, bits = read_bits(asked, request), (1 << asked.width) - 1
    nodes: Sequence[int] = command.from_each or (() if to is None else (to,))
    if not _is_from(nodes, source, bits):
        return _no_answer(f"it comes from node {source}, not {_listed(nodes)}")
    if reported and not _is_from(nodes, read_bits(reported, reply), bits & (1 << reported.width) - 1):
        return _no_answer(f"`{reported.name}` is node {read_bits(reported, reply)}, not {_listed(nodes)}")
    if command.is_echoed and request.data != reply.data:
        return _no_answer(f"the reply of {command.name} is an echo, but this frame differs from the request")
    return Identified(expected, source)


def _no_answer(text: str) -> Rejection:
    return Rejection(Refusal.NOT_ANSWER, text)


def _is_from(nodes: Sequence[int], source: int | None, bits: int) -> bool:
    """Whether a node is one of `nodes` in the known `bits`; True if either is unknown."""
    return source is None or not nodes or any(not (source ^ one) & bits for one in nodes)


def _listed(nodes: Sequence[int]) -> str:
    return " or ".join(map(str, nodes)) if len(nodes) < 3 else f"{min(nodes)}..{max(nodes)}"
