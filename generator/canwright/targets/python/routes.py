"""Views of the dispatch plan and of the replies to requests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, Union

from ...model.edition import Edition
from ...model.message import MAX_NODE_BITS, BitRun, Direction, IdRule, Message
from ...semantics import dispatch
from ...semantics.exchange import ExchangePlan, exchange_plans
from ...semantics.plan import message_plan, only_by_request
from . import bits, text
from .imports import Imports


class SelectView(NamedTuple):
    """A decision: the function that reads the subject, and each value with the decision that it leads to."""

    read: str
    cases: Sequence[tuple[str, NodeView]]
    otherwise: NodeView


NodeView = Union[str, SelectView]  # noqa: UP007 - `NodeView` in `SelectView` is a forward reference
"""A decision, or the expression of a message class or a refusal."""


class RouteView(NamedTuple):
    """A route with its first decision."""

    route: dispatch.Route
    then: NodeView
    answers: Sequence[Message]
    """The replies that can have a code which belongs to another message unless their request is known."""


class AnswerView(NamedTuple):
    """A reply to a request, and the `further` ones."""

    plan: ExchangePlan
    further: Sequence[AnswerView]
    selectors: Sequence[tuple[str, str]]
    """Names of readers with the accepted values."""
    request_node: str
    reply_node: str
    unused: int


class Readers:
    """The functions that read selectors: each once, with a name."""

    def __init__(self, imports: Imports) -> None:
        self.data_bytes: dict[int, str] = {}
        """The names of those that read one data byte, by its position."""
        self.functions: dict[str, str] = {}
        """The names of all others, by expression."""
        self._imports = imports

    def of(self, subject: dispatch.Discriminator, shortest: int) -> str:
        """The name of the function that reads a subject in data of at least `shortest` bytes."""
        if isinstance(subject, dispatch.Length):
            return self._imports.use("data_length")
        if isinstance(subject, dispatch.MaskedId):
            return self._function(f"can_id & 0x{subject.mask:X}")
        position = bits.data_byte(subject)
        if position is not None:
            return self.data_bytes.setdefault(position, f"_data_{position}")
        return self._function(bits.read_key(subject, shortest))

    def _function(self, expression: str) -> str:
        return self.functions.setdefault(expression, f"_key_{len(self.functions) + 1}")


def route_views(edition: Edition, direction: Direction, readers: Readers) -> Iterator[RouteView]:
    """The routes of one direction, in the order in which they are tried."""
    explained = only_by_request(edition) if direction is Direction.REPLY else ()
    for route in dispatch.dispatch_plan(edition, direction).routes:
        shortest = min(message.length for message in route.messages)
        yield RouteView(route, _node(route.then, shortest, readers), [m for m in route.messages if m in explained])


def _node(node: dispatch.DispatchNode, shortest: int, readers: Readers) -> NodeView:
    if isinstance(node, dispatch.Match):
        return text.class_name(node.message.name)
    if isinstance(node, dispatch.Reject):
        return f"Refusal.{node.reason.name}"
    form = _FORMS[type(node.subject)]
    read, otherwise = readers.of(node.subject, shortest), _node(node.otherwise, shortest, readers)
    cases: list[tuple[str, NodeView]] = []
    for case in node.cases:
        then = _node(case.then, shortest, readers)
        cases += [(form.format(value), then) for value in case.values]
    return SelectView(read, cases, otherwise)


_FORMS = {dispatch.Length: "{}", dispatch.MaskedId: "0x{:X}", BitRun: "0x{:02X}"}
"""How the values of a subject are written."""


def decoded_classes(edition: Edition, direction: Direction) -> list[str]:
    """The classes of the messages that can be identified without their request."""
    return [text.class_name(m.name) for m in edition.messages(direction) if m.identifying_codes or not m.keys]


def answer_views(edition: Edition, readers: Readers) -> Iterator[AnswerView]:
    """The answers of every command with a request and a reply."""
    routes = dispatch.dispatch_plan(edition, Direction.REPLY).routes
    masks = {(route.rule, route.remote): route.mask for route in routes}
    for plans in exchange_plans(edition).values():
        answers = [_answer(plan, masks, readers) for plan in plans]
        if answers:
            yield answers[0]._replace(further=answers[1:])


def _answer(plan: ExchangePlan, masks: Mapping[tuple[IdRule, bool], int], readers: Readers) -> AnswerView:
    keys, length = message_plan(plan.reply).keys, plan.reply.length
    return AnswerView(
        plan,
        (),
        [(readers.of(k.key, length), text.tuple_of(f"0x{v:02X}" for v in k.values)) for k in keys],
        _node_field(plan.request, plan.asked, readers),
        _node_field(plan.reply, plan.reported, readers),
        masks[plan.reply.id, plan.reply.remote] & ~plan.reply.id_mask,
    )


def node_readers(edition: Edition, readers: Readers) -> Iterator[tuple[str, str]]:
    """Each message with its node, or the low bits of it, in the data only, and the function that reads it."""
    for message in edition.all_messages():
        bits = message.node_bits if message.id.nodes is None else None
        if bits is not None and bits.width <= MAX_NODE_BITS:
            yield text.class_name(message.name), readers.of(bits, message.length)


def _node_field(message: Message, run: BitRun | None, readers: Readers) -> str:
    """The function that reads the node of a message, with the mask of its bits; empty without such bits."""
    return f"({readers.of(run, message.length)}, 0x{(1 << run.width) - 1:X})" if run is not None else ""
