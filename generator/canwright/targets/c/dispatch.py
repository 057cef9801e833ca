"""The dispatch plan as `if` and `switch`, and the conditions under which a frame answers a request."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Layout
from ...model.message import BitRun, Command, Direction, Message
from ...semantics import dispatch
from ...semantics.dispatch import dispatch_plan
from ...semantics.exchange import ExchangePlan, exchange_plans
from . import bits
from .choices import ENUM_MAX
from .expressions import joined, operand
from .layouts import LayoutView
from .messages import Messages, frame_id
from .names import Names, address_mask


class ContentView(NamedTuple):
    """A command whose message of one direction has fields: its member in the union."""

    command: str
    member: str


class ContentsView(NamedTuple):
    """Commands whose messages of one direction have the same layout."""

    layout: LayoutView
    commands: tuple[ContentView, ...]

    @property
    def member(self) -> str:
        """One of the members; all have the same type."""
        return self.commands[0].member


class MatchView(NamedTuple):
    """A command, or a run of commands that differ only in the number, which the expression `command` reads.

    `node` is the node in a field, where the messages of a route differ in it; `other_constant` is the condition for a
    frame with other constants, `wrong_checksum` for one with another checksum, `code` the value of the member with the
    code. They are empty otherwise.
    """

    command: str
    node: str
    other_constant: str
    wrong_checksum: str
    code: str
    unpack: ContentsView | None


class RouteView:
    """A route of the dispatch plan, with the expressions for the nodes of the plan below it.

    `unpack` is what follows a match. `numbers` are those of the commands.
    """

    def __init__(
        self,
        names: Names,
        edition: Edition,
        views: Messages,
        route: dispatch.Route,
        numbers: Mapping[str, int],
        unpack: Mapping[Layout, ContentsView],
    ) -> None:
        self._names, self._views, self._numbers, self._unpack = names, views, numbers, unpack
        message = route.messages[0]
        nodes = {views.message(message).node_in_data for message in route.messages}
        self.rule = views.rule(edition.address(message.address), message.direction)
        self.frame_id = frame_id(message)
        self._has_nodes = len(nodes) > 1
        """Whether each message writes the node that its fields contain."""
        self.node = "" if self._has_nodes else nodes.pop()
        """The node if the id contains none."""
        self._other_kind = address_mask(edition, message.address, message.direction) & ~route.mask
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
        view = self._views.message(message)
        node = view.node_in_data if self._has_nodes else ""
        command = command or self._names.command(message.command)
        unpack = self._unpack.get(message.layout)
        return MatchView(
            command, node, view.other_constant, view.wrong_checksum, view.code_read if unpack else "", unpack
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
        number = f"({self._names.lower('command_t')}){self.read(node)}"
        is_byte = isinstance(node.subject, BitRun) and bits.is_byte(node.subject.space, node.subject.segments)
        groups: dict[MatchView | tuple[int, ...], list[dispatch.Case]] = {}
        for case in node.cases:
            then = case.then
            key: MatchView | tuple[int, ...] = case.values
            if is_byte and isinstance(then, dispatch.Match) and key == (self._numbers[then.message.command],):
                key = self.match(then.message, number)
            groups.setdefault(key, []).append(case)
        for key, cases in groups.items():
            labels = _labels(node.subject, [value for case in cases for value in case.values])
            yield labels, key if isinstance(key, MatchView) and len(cases) > 1 else cases[0].then


class CommandsView(NamedTuple):
    """Commands for which a function returns the same value."""

    commands: tuple[str, ...]
    value: str


def grouped(names: Names, values: Iterable[tuple[Command, str]]) -> list[CommandsView]:
    """Commands with their values, by value."""
    groups: dict[str, list[str]] = {}
    for command, value in values:
        groups.setdefault(value, []).append(names.command(command.name))
    return [CommandsView(tuple(commands), value) for value, commands in groups.items()]


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
    names: Names, edition: Edition, views: Messages, direction: Direction, unpack: Mapping[Layout, ContentsView]
) -> list[RouteView]:
    """The routes of the dispatch plan, in the order in which they are tried; `unpack` is what follows a match."""
    numbers = command_numbers(edition)
    plan = dispatch_plan(edition, direction)
    return [RouteView(names, edition, views, route, numbers, unpack) for route in plan.routes]


def _labels(subject: dispatch.Discriminator, values: Sequence[int]) -> Sequence[str]:
    return bits.labels(subject, values) if isinstance(subject, BitRun) else [f"{value}u" for value in values]


def answers(names: Names, edition: Edition, views: Messages) -> list[CommandsView]:
    """The conditions under which `reply` answers a request, by command."""
    every = (plans for plans in exchange_plans(edition).values() if plans)
    return grouped(names, ((p[0].command, joined("||", [joined("&&", _answer(views, x)) for x in p])) for p in every))


def _answer(views: Messages, plan: ExchangePlan) -> Iterator[str]:
    """The conditions under which `reply` is one of the replies."""
    reply = plan.reply
    message = views.message(reply)
    rule = message.pattern.rule
    if not plan.is_echo:
        node = "&from, " if rule.has_nodes else ""
        known = ", parameters" if rule.whole else ""
        calls = [
            f"{message.pattern.name}_match({node}{', '.join(('reply', f'{message.dlc}u', *codes))}{known}) == CANWRIGHT_OK"
            for codes in _answering_codes(plan.request, reply, message.codes)
        ]
        yield joined("||", calls)
    else:
        yield rule.has_id("&from", frame_id(reply, "reply"))
    if rule.has_nodes and plan.nodes:
        yield _one_of("from", plan.nodes)
    elif rule.has_nodes and plan.request.id.nodes is not None and plan.asked is None:
        yield "from == to"
    yield from _node_fields(plan)
    if plan.is_echo:
        yield f"canwright_{views.fd}same_data(request, reply)"


def _node_fields(plan: ExchangePlan) -> Iterator[str]:
    """Conditions on the node if a field of the request or of the reply contains it, on the bits that both have."""
    reply, asked, reported = plan.reply, plan.asked, plan.reported
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
    if request.keys == reply.keys and not (request.accepted_codes or reply.accepted_codes):
        return (tuple(operand(bits.key_value(key, "request")) for key in request.keys),)
    return codes


def _one_of(name: str, numbers: Sequence[int]) -> str:
    if list(numbers) == list(range(numbers[0], numbers[-1] + 1)):
        low = [f"{name} >= {numbers[0]}u"] if numbers[0] else []
        return joined("&&", [*low, f"{name} <= {numbers[-1]}u"])
    return joined("||", [f"{name} == {n}u" for n in numbers])
