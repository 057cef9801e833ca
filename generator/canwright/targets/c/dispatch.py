"""The dispatch plan as `if` and `switch`, and the conditions under which a frame answers a request."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Layout
from ...model.message import BitRun, Direction, Message
from ...semantics import dispatch
from ...semantics.dispatch import dispatch_plan
from ...semantics.exchange import ExchangePlan, exchange_plans
from . import bits
from .choices import ENUM_MAX
from .expressions import joined, operand
from .messages import Messages, RuleView, frame_id
from .names import Names, address_mask


class RejectView(NamedTuple):
    status: str


class UnpackView(NamedTuple):
    """The call that reads the fields of a frame; `fails` is true if it returns a status."""

    call: str
    fails: bool


class MatchView(NamedTuple):
    """A command, or a run of commands that differ only in the number, which the expression `command` reads.

    `node` is the node in a field, where the messages of a route differ in it; `other_constant` is the condition for a
    frame with other constants. Both are empty otherwise.
    """

    command: str
    node: str
    other_constant: str
    unpack: UnpackView | None


class GuardView(NamedTuple):
    """Rejects frames that meet a condition."""

    condition: str
    status: str
    then: NodeView


class CaseView(NamedTuple):
    labels: tuple[str, ...]
    then: NodeView


class SwitchView(NamedTuple):
    subject: str
    cases: tuple[CaseView, ...]
    otherwise: NodeView


NodeView = RejectView | MatchView | GuardView | SwitchView


class RouteView(NamedTuple):
    """The decisions between the messages of one id rule."""

    rule: RuleView
    frame_id: str
    other_kind: str
    """Bits of the id that are 0 here and that frames of the other kind (remote or not) use; empty without any."""
    node: str
    """The node if the id contains none."""
    then: NodeView

    def only_kind(self, condition: str) -> str:
        """A condition, and that the frame is of this kind."""
        return joined("&&", [condition, *([f"(frame->id & {self.other_kind}) == 0u"] if self.other_kind else [])])


class AnswerView(NamedTuple):
    """Commands with the same reply conditions: `reply` answers a request if all `conditions` are true."""

    commands: tuple[str, ...]
    conditions: tuple[str, ...]
    uses_from: bool
    """True if the conditions read the node that replies."""

    @property
    def condition(self) -> str:
        return joined("&&", self.conditions)


def command_numbers(edition: Edition) -> Mapping[str, int]:
    """The number of each command: its code if no other command has it, else a free number of at least two bytes.

    With the code as number, one statement is enough for all codes whose messages are read in the same way.
    """
    times = Counter(command.code for command in edition.commands)
    codes = {c.name: c.code for c in edition.commands if c.code and times[c.code] == 1 and c.code <= ENUM_MAX}
    taken = set(codes.values())
    free = (number for number in itertools.count(0x100) if number not in taken)
    return {command.name: codes.get(command.name) or next(free) for command in edition.commands}


def routes(
    names: Names, edition: Edition, views: Messages, direction: Direction, unpack: Mapping[Layout, UnpackView]
) -> list[RouteView]:
    """The routes of the dispatch plan, in the order in which they are tried; `unpack` is what follows a match."""
    printer = _Printer(names, edition, views, unpack)
    return [_route(edition, views, direction, route, printer) for route in dispatch_plan(edition, direction).routes]


def _route(
    edition: Edition, views: Messages, direction: Direction, route: dispatch.Route, printer: _Printer
) -> RouteView:
    message = route.messages[0]
    nodes = {views.message(message).node_in_data for message in route.messages}
    other_kind = address_mask(edition, message.address, direction) & ~route.mask
    return RouteView(
        rule=views.rule(edition.address(message.address), direction),
        frame_id=frame_id(message),
        other_kind=f"0x{other_kind:X}u" if other_kind else "",
        node=(nodes.pop() if len(nodes) == 1 else "") or "0u",
        then=printer.node(route.then, has_nodes=len(nodes) > 1),
    )


class _Printer:
    """The nodes of a dispatch plan in C."""

    def __init__(self, names: Names, edition: Edition, views: Messages, unpack: Mapping[Layout, UnpackView]) -> None:
        self._names, self._views, self._unpack = names, views, unpack
        self._numbers = command_numbers(edition)
        self._type = names.lower("command_t")

    def node(self, node: dispatch.DispatchNode, *, has_nodes: bool) -> NodeView:
        """The view of a node of the plan; with `has_nodes`, each message writes the node that its fields contain."""
        if isinstance(node, dispatch.Reject):
            return RejectView(node.reason.name)
        if isinstance(node, dispatch.Match):
            return self._match(node.message, self._names.command(node.message.command), has_nodes)
        if isinstance(node.otherwise, dispatch.Reject) and len(node.cases) == 1:
            condition = _differs(node.subject, node.cases[0].values)
            then = self.node(node.cases[0].then, has_nodes=has_nodes)
            return GuardView(condition, node.otherwise.reason.name, then)
        otherwise = self.node(node.otherwise, has_nodes=has_nodes)
        return SwitchView(_read(node.subject), tuple(self._cases(node, has_nodes)), otherwise)

    def _match(self, message: Message, command: str, has_nodes: bool) -> MatchView:
        view = self._views.message(message)
        node = view.node_in_data if has_nodes else ""
        return MatchView(command, node, view.other_constant, self._unpack.get(message.layout))

    def _cases(self, node: dispatch.Select, has_nodes: bool) -> Iterator[CaseView]:
        """The cases; those that differ only in the command, whose number is that of the case, become one."""
        number = f"({self._type}){_read(node.subject)}"
        is_byte = isinstance(node.subject, BitRun) and bits.is_byte(node.subject.space, node.subject.segments)
        groups: dict[MatchView | tuple[int, ...], list[dispatch.Case]] = {}
        for case in node.cases:
            then = case.then
            key: MatchView | tuple[int, ...] = case.values
            if is_byte and isinstance(then, dispatch.Match) and key == (self._numbers[then.message.command],):
                key = self._match(then.message, number, has_nodes)
            groups.setdefault(key, []).append(case)
        for key, cases in groups.items():
            values = [value for case in cases for value in case.values]
            then_ = (
                key if isinstance(key, MatchView) and len(cases) > 1 else self.node(cases[0].then, has_nodes=has_nodes)
            )
            yield CaseView(_labels(node.subject, values), then_)


def _read(subject: dispatch.Discriminator) -> str:
    if isinstance(subject, dispatch.Length):
        return "frame->dlc"
    if isinstance(subject, dispatch.MaskedId):
        return f"frame->id & 0x{subject.mask:X}u"
    return bits.key_value(subject)


def _labels(subject: dispatch.Discriminator, values: Sequence[int]) -> tuple[str, ...]:
    return tuple(bits.labels(subject, values) if isinstance(subject, BitRun) else (f"{value}u" for value in values))


def _differs(subject: dispatch.Discriminator, values: Sequence[int]) -> str:
    """The condition for a subject with none of the values."""
    read = operand(_read(subject))
    return joined("&&", [f"{read} != {label}" for label in _labels(subject, values)])


def answers(names: Names, edition: Edition, views: Messages) -> list[AnswerView]:
    """The reply conditions of every command with a request and a reply."""
    grouped: dict[tuple[tuple[str, ...], bool], list[str]] = {}
    for plan in exchange_plans(edition).values():
        if plan.reply is not None:
            conditions = tuple(_answer(views, plan, plan.reply))
            uses_from = views.message(plan.reply).pattern.rule.has_nodes
            grouped.setdefault((conditions, uses_from), []).append(names.command(plan.command.name))
    return [AnswerView(tuple(commands), *answer) for answer, commands in grouped.items()]


def _answer(views: Messages, plan: ExchangePlan, reply: Message) -> Iterator[str]:
    message = views.message(reply)
    rule = message.pattern.rule
    if not plan.is_echo:
        node = "&from, " if rule.has_nodes else ""
        calls = [
            f"{message.pattern.name}_match({node}{', '.join(('reply', f'{message.dlc}u', *codes))}) == CANWRIGHT_OK"
            for codes in _answering_codes(plan.request, reply, message.codes)
        ]
        yield joined("||", calls)
    elif rule.has_nodes:
        yield f"{rule.node_function}(&from, {frame_id(reply, 'reply')}) == CANWRIGHT_OK"
    else:
        yield f"{rule.masked(frame_id(reply, 'reply'))} == {rule.id_macro}"
    if rule.has_nodes and plan.nodes:
        yield _one_of("from", plan.nodes)
    elif rule.has_nodes and plan.request.id.nodes is not None and plan.asked is None:
        yield "from == to"
    yield from _node_fields(plan, reply)
    if plan.is_echo:
        yield "canwright_same_data(request, reply)"


def _node_fields(plan: ExchangePlan, reply: Message) -> Iterator[str]:
    """Conditions on the node if a field of the request or of the reply contains it, on the bits that both have."""
    asked, reported = plan.asked, plan.reported
    if reported is not None and plan.nodes:
        nodes = sorted({node & (1 << reported.width) - 1 for node in plan.nodes})
        yield _one_of(operand(bits.key_value(reported, "reply")), nodes)
    if plan.nodes or (asked is None and (reported is None or plan.request.id.nodes is None)):
        return
    sent_to = "to" if asked is None else operand(bits.key_value(asked, "request"))
    sources: list[tuple[str, BitRun | None]] = []
    if reply.id.nodes is not None and asked is not None:
        sources.append(("from", None))
    if reported is not None:
        sources.append((operand(bits.key_value(reported, "reply")), reported))
    for source, key in sources:
        width = min(bits_.width for bits_ in (asked, key) if bits_ is not None)
        yield f"{_low_bits(source, key, width)} == {_low_bits(sent_to, asked, width)}"


def _low_bits(node: str, key: BitRun | None, width: int) -> str:
    """The low bits of a node; of one that `key` contains, unless these are all its bits."""
    return node if key is not None and key.width == width else f"({node} & 0x{(1 << width) - 1:X}u)"


def _answering_codes(
    request: Message, reply: Message, codes: tuple[tuple[str, ...], ...]
) -> tuple[tuple[str, ...], ...]:
    """The codes of a reply; if the request has the same, the expressions that read them, equal for all commands."""
    if request.keys == reply.keys and not reply.accepted_codes:
        return (tuple(operand(bits.key_value(key, "request")) for key in request.keys),)
    return codes


def _one_of(name: str, numbers: Sequence[int]) -> str:
    if list(numbers) == list(range(numbers[0], numbers[-1] + 1)):
        low = [f"{name} >= {numbers[0]}u"] if numbers[0] else []
        return joined("&&", [*low, f"{name} <= {numbers[-1]}u"])
    return joined("||", [f"{name} == {n}u" for n in numbers])
