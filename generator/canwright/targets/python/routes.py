"""Views of the dispatch plan and of the replies to requests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Union

from ...model.edition import Edition
from ...model.message import BitRun, Direction, Message
from ...semantics import dispatch
from ...semantics.exchange import exchange_plans
from ...semantics.plan import message_plan, only_by_request
from . import bits, text
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class DispatchCaseView:
    """The values that lead to one node."""

    values: tuple[str, ...]
    then: NodeView


@dataclass(frozen=True, kw_only=True)
class SelectView:
    """A decision: the function that reads the values of the cases."""

    read: str
    cases: tuple[DispatchCaseView, ...]
    otherwise: NodeView


NodeView = Union[str, SelectView]  # noqa: UP007 - `NodeView` in `SelectView` is a forward reference
"""A decision, or the expression of a message class or a refusal."""


@dataclass(frozen=True, kw_only=True)
class RouteView:
    """The messages that share one rule from node to CAN id; `nodes` is None for a fixed id."""

    base: int
    step: int
    nodes: range | None
    then: NodeView
    mask: int
    extended: bool
    remote: bool
    answers: tuple[str, ...]
    """Classes of replies that can have a code which belongs to another message unless their request is known."""


@dataclass(frozen=True, kw_only=True)
class AnswerView:
    """The reply to a request: expressions of the arguments of `Answer`."""

    request: str
    reply: str
    selectors: tuple[tuple[str, str], ...]
    """Names of readers with the accepted values."""
    nodes: str
    """Empty where the node of the request replies."""
    echo: bool
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
        shortest = min(message_plan(message).length for message in route.messages)
        yield RouteView(
            base=route.rule.base,
            step=route.rule.node_step,
            nodes=route.rule.nodes,
            then=_node(route.then, shortest, readers),
            mask=route.mask,
            extended=route.rule.extended,
            remote=route.remote,
            answers=tuple(text.class_name(m.name) for m in route.messages if m in explained),
        )


def _node(node: dispatch.DispatchNode, shortest: int, readers: Readers) -> NodeView:
    if isinstance(node, dispatch.Match):
        return text.class_name(node.message.name)
    if isinstance(node, dispatch.Reject):
        return f"Refusal.{node.reason.name}"
    form = _FORMS[type(node.subject)]
    cases = (
        DispatchCaseView(values=tuple(form.format(v) for v in case.values), then=_node(case.then, shortest, readers))
        for case in node.cases
    )
    return SelectView(
        read=readers.of(node.subject, shortest),
        otherwise=_node(node.otherwise, shortest, readers),
        cases=tuple(cases),
    )


_FORMS = {dispatch.Length: "{}", dispatch.MaskedId: "0x{:X}", BitRun: "0x{:02X}"}
"""How the values of a subject are written."""


def decoded_classes(edition: Edition, direction: Direction) -> list[str]:
    """The classes of the messages that can be identified without their request."""
    return [text.class_name(m.name) for m in edition.messages(direction) if m.identifying_codes or not m.keys]


def answer_views(edition: Edition, readers: Readers) -> Iterator[AnswerView]:
    """The answers of every command with a request and a reply."""
    routes = dispatch.dispatch_plan(edition, Direction.REPLY).routes
    masks = {(route.rule, route.remote): route.mask for route in routes}
    for plan in exchange_plans(edition).values():
        reply = plan.reply
        if reply is None:
            continue
        length = message_plan(reply).length
        yield AnswerView(
            request=text.class_name(plan.request.name),
            reply=text.class_name(reply.name),
            selectors=tuple((readers.of(k.key, length), _hexadecimal(*k.values)) for k in message_plan(reply).keys),
            nodes=text.tuple_of(map(str, plan.nodes)) if plan.nodes else "",
            echo=plan.is_echo,
            request_node=_node_field(plan.request, plan.asked, readers),
            reply_node=_node_field(reply, plan.reported, readers),
            unused=masks[reply.id, reply.remote] & ~reply.id_mask,
        )


def node_readers(edition: Edition, readers: Readers) -> Iterator[tuple[str, str]]:
    """Each message with its node in the data, and the function that reads it."""
    for message in edition.all_messages():
        if message.node_in_data is not None:
            yield text.class_name(message.name), readers.of(message.node_in_data, message_plan(message).length)


def _node_field(message: Message, run: BitRun | None, readers: Readers) -> str:
    """The function that reads the node of a message, with the mask of its bits; empty without such bits."""
    return f"({readers.of(run, message_plan(message).length)}, 0x{(1 << run.width) - 1:X})" if run is not None else ""


def _hexadecimal(*values: int) -> str:
    return text.tuple_of(f"0x{value:02X}" for value in values)
