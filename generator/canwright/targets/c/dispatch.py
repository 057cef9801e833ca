"""The dispatch plan as `if` and `switch`, and the conditions under which a frame answers a request."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.message import BitRun, Command, Message
from ...semantics import dispatch
from ...semantics.exchange import ExchangePlan, exchange_plans
from . import bits
from .choices import Branch
from .expressions import joined, operand
from .layouts import LayoutView
from .messages import Messages, MessageView, frame_id
from .names import Names, address_mask


class MatchView(NamedTuple):
    """A command, or a run of commands that differ only in the number, which the expression `command` reads.

    `node` is the node in a field, where the messages of a route differ in it; `code` is the value of the member with the
    code. `layout` is that of the `member` of the union to unpack. They are empty otherwise.
    """

    command: str
    node: str
    checks: Sequence[tuple[str, str]]
    code: str
    layout: LayoutView | None
    member: str


Contents = Mapping[LayoutView, Sequence[MessageView]]
"""The messages of one direction that have fields, by layout; the structs of one layout have the same type."""


class RouteView:
    """A route of the dispatch plan, with the expressions for the nodes of the plan below it.

    `contents` are unpacked after a match.
    """

    def __init__(self, messages: Messages, route: dispatch.Route, contents: Contents) -> None:
        self._messages, self._contents = messages, contents
        first = route.messages[0]
        nodes = {messages.message(message).node_in_data for message in route.messages}
        pattern = messages.message(first).pattern
        self.rule, self.frame_id = pattern.rule, pattern.frame_id
        self._has_nodes = len(nodes) > 1
        """Whether each message writes the node that its fields contain."""
        self.node = "" if self._has_nodes else nodes.pop()
        """The node if the id contains none."""
        self._other_kind = address_mask(messages.edition, first.address, first.direction) & ~route.mask
        """Bits of the id that are 0 here and that frames of the other kind (remote or not) use."""
        self.then = route.then
        whole, kind = self.rule.whole, joined("&&", [f"({self.frame_id} & 0xC0000000u) == {self.rule.kind}"])
        self.unknown_parameter = joined("&&", [f"({kind})", f"({whole.unknown})"]) if whole else ""
        """The condition under which it is unknown whether a frame has an id of this route; empty if it is known."""

    def only_kind(self, condition: str) -> str:
        """A condition, and that the frame is of this kind."""
        kind = [f"(frame->id & 0x{self._other_kind:X}u) == 0u"] if self._other_kind else []
        return joined("&&", [condition, *kind])

    def match(self, message: Message, command: str = "") -> MatchView:
        """The view of a message; `command` is an expression of its number."""
        view = self._messages.message(message)
        layout = view.layout if view.layout in self._contents else None
        return MatchView(
            command or view.enumerator,
            view.node_in_data if self._has_nodes else "",
            view.checks,
            view.code_read if layout else "",
            layout,
            self._contents[layout][0].member if layout else "",
        )

    def guard(self, node: dispatch.Select) -> str:
        """The condition for a frame that is rejected, if a decision has a single case beside; else empty."""
        if len(node.cases) > 1 or not isinstance(node.otherwise, dispatch.Reject):
            return ""
        read = operand(self.read(node))
        return joined("&&", [f"{read} != {label}" for label in _labels(node.subject, node.cases[0].values)])

    def read(self, node: dispatch.Select) -> str:
        """The subject of a decision."""
        if isinstance(node.subject, dispatch.Length):
            return "frame->dlc"
        if isinstance(node.subject, dispatch.MaskedId):
            return f"frame->id & 0x{node.subject.mask:X}u"
        return bits.key_value(node.subject)

    def cases(self, node: dispatch.Select) -> Iterator[tuple[Sequence[str], MatchView | dispatch.DispatchNode]]:
        """The cases; those that differ only in the command, whose number is that of the case, become one."""
        number = f"({self._messages.names.lower('command_t')}){self.read(node)}"
        is_byte = isinstance(node.subject, BitRun) and bits.is_byte(node.subject.space, node.subject.segments)
        groups: dict[MatchView | tuple[int, ...], list[dispatch.Case]] = {}
        for case in node.cases:
            then = case.then
            key: MatchView | tuple[int, ...] = case.values
            if is_byte and isinstance(then, dispatch.Match) and key == (self._messages.numbers[then.message.command],):
                key = self.match(then.message, number)
            groups.setdefault(key, []).append(case)
        for key, cases in groups.items():
            labels = _labels(node.subject, [value for case in cases for value in case.values])
            yield labels, key if isinstance(key, MatchView) and len(cases) > 1 else cases[0].then


def grouped(names: Names, values: Iterable[tuple[Command, str]]) -> list[Branch[str]]:
    """The values of commands as cases of a `switch`."""
    groups: dict[str, list[str]] = {}
    for command, value in values:
        groups.setdefault(value, []).append(names.command(command.name))
    return [Branch(tuple(commands), value) for value, commands in groups.items()]


def _labels(subject: dispatch.Discriminator, values: Sequence[int]) -> Sequence[str]:
    return bits.labels(subject, values) if isinstance(subject, BitRun) else [f"{value}u" for value in values]


def answers(messages: Messages) -> list[Branch[str]]:
    """The conditions under which `reply` answers a request, by command."""
    every = (plans for plans in exchange_plans(messages.edition).values() if plans)
    conditions = ((p[0].command, joined("||", [joined("&&", _answer(messages, x)) for x in p])) for p in every)
    return grouped(messages.names, conditions)


def _answer(messages: Messages, plan: ExchangePlan) -> Iterator[str]:
    """The conditions under which `reply` is one of the replies."""
    reply = plan.reply
    message = messages.message(reply)
    rule = message.pattern.rule
    if plan.is_echo:
        yield rule.has_id("&from", frame_id(reply, "reply"))
    else:
        match, start = f"{message.pattern.name}_match", ("&from" if rule.has_nodes else "", "reply", f"{message.dlc}u")
        calls = (rule.call(match, *start, *codes) for codes in _answering_codes(plan.request, reply, message.codes))
        yield joined("||", [f"{call} == CANWRIGHT_OK" for call in calls])
    if rule.has_nodes and plan.nodes:
        yield _one_of("from", plan.nodes)
    elif rule.has_nodes and plan.request.id.nodes is not None and plan.asked is None:
        yield "from == to"
    yield from _node_fields(plan)
    if plan.is_echo:
        yield f"canwright_{messages.fd}same_data(request, reply)"


def _node_fields(plan: ExchangePlan) -> Iterator[str]:
    """Conditions on the node if a field of the request or of the reply contains it, on the bits that both have."""
    reply, asked, reported = plan.reply, plan.asked, plan.reported
    if reported is not None and plan.nodes:
        nodes = sorted({node & (1 << reported.width) - 1 for node in plan.nodes})
        yield _one_of(operand(bits.key_value(reported, "reply")), nodes)
    if plan.nodes or (asked is None and (reported is None or plan.request.id.nodes is None)):
        return
    sent_to = "to" if asked is None else operand(bits.key_value(asked, "request"))
    sources: list[tuple[str, BitRun | None]] = [("from", None)] if reply.id.nodes is not None and asked else []
    sources += [(operand(bits.key_value(reported, "reply")), reported)] if reported else []
    for source, key in sources:
        width = min(bits_.width for bits_ in (asked, key) if bits_ is not None)
        yield f"{_low_bits(source, key, width)} == {_low_bits(sent_to, asked, width)}"


def _low_bits(node: str, key: BitRun | None, width: int) -> str:
    """The low bits of a node; of one that `key` contains, unless these are all its bits."""
    return node if key is not None and key.width == width else f"({node} & 0x{(1 << width) - 1:X}u)"


def _answering_codes(request: Message, reply: Message, codes: Sequence[tuple[str, ...]]) -> Sequence[tuple[str, ...]]:
    """The codes of a reply; if the request has the same, the expressions that read them, equal for all commands."""
    if request.keys == reply.keys and not (request.accepted_codes or reply.accepted_codes):
        return (tuple(operand(bits.key_value(key, "request")) for key in request.keys),)
    return codes


def _one_of(name: str, numbers: Sequence[int]) -> str:
    if list(numbers) == list(range(numbers[0], numbers[-1] + 1)):
        low = [f"{name} >= {numbers[0]}u"] if numbers[0] else []
        return joined("&&", [*low, f"{name} <= {numbers[-1]}u"])
    return joined("||", [f"{name} == {n}u" for n in numbers])
