"""The dispatch plan as `if` and `switch`, and the conditions under which a frame answers a request."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.message import BitRun, Command, Direction, Message
from ...semantics import dispatch
from ...semantics.dispatch import dispatch_plan
from . import bits
from .messages import Messages, RuleView, frame_id
from .names import Names
from .patterns import address_mask


class Reject(NamedTuple):
    status: str


class Found(NamedTuple):
    """The command; `other_constant` is the condition for a frame without its constants, empty when it has none."""

    command: str
    other_constant: str


class Guard(NamedTuple):
    """Rejects frames that meet a condition."""

    condition: str
    status: str
    then: Node


class Case(NamedTuple):
    labels: tuple[str, ...]
    then: Node


class Switch(NamedTuple):
    subject: str
    cases: tuple[Case, ...]
    otherwise: Node


Node = Reject | Found | Guard | Switch


class Entry(NamedTuple):
    """The search among the messages of one id rule."""

    rule: RuleView
    frame_id: str
    other_kind: str
    """Bits of the id that are 0 here and that the other kind of frame, remote or not, uses; empty when there are none."""
    then: Node


class AnswerView(NamedTuple):
    """Commands that are answered alike. `conditions` hold when the frame `reply` is their answer."""

    commands: tuple[str, ...]
    conditions: tuple[str, ...]
    uses_from: bool
    """True when the conditions get the node that answers."""


def entries(names: Names, edition: Edition, views: Messages, direction: Direction) -> list[Entry]:
    """The entries of the dispatch plan, in the order in which they are tried."""
    printer = _Printer(names, views)
    return [
        _entry(edition, views, direction, entry, printer.node(entry.then))
        for entry in dispatch_plan(edition.messages(direction)).entries
    ]


def _entry(edition: Edition, views: Messages, direction: Direction, entry: dispatch.Entry, then: Node) -> Entry:
    message = entry.messages[0]
    other_kind = address_mask(edition, message.address, direction) & ~entry.mask
    return Entry(
        rule=views.rule(edition.address(message.address), direction),
        frame_id=frame_id(message),
        other_kind=f"0x{other_kind:X}u" if other_kind else "",
        then=then,
    )


class _Printer:
    """The nodes of a dispatch plan in C."""

    def __init__(self, names: Names, views: Messages) -> None:
        self._names, self._views = names, views

    def node(self, node: dispatch.Node) -> Node:
        if isinstance(node, dispatch.Reject):
            return Reject(node.reason.name)
        if isinstance(node, dispatch.Found):
            command = self._names.upper("command", node.message.command)
            return Found(command, self._views.message(node.message).other_constant)
        if isinstance(node.otherwise, dispatch.Reject) and len(node.cases) == 1:
            condition = _differs(node.subject, node.cases[0].values)
            return Guard(condition, node.otherwise.reason.name, self.node(node.cases[0].then))
        cases = (Case(_labels(node.subject, case.values), self.node(case.then)) for case in node.cases)
        return Switch(_read(node.subject), tuple(cases), self.node(node.otherwise))


def _read(subject: dispatch.Subject) -> str:
    if isinstance(subject, dispatch.Length):
        return "frame->dlc"
    if isinstance(subject, dispatch.MaskedId):
        return f"frame->id & 0x{subject.mask:X}u"
    return bits.key_value(subject)


def _labels(subject: dispatch.Subject, values: Sequence[int]) -> tuple[str, ...]:
    return tuple(bits.labels(subject, values) if isinstance(subject, BitRun) else (f"{value}u" for value in values))


def _differs(subject: dispatch.Subject, values: Sequence[int]) -> str:
    """The condition for a subject that has none of the values."""
    read = bits.operand(_read(subject))
    return " && ".join(f"{read} != {label}" for label in _labels(subject, values))


def answers(names: Names, edition: Edition, views: Messages) -> list[AnswerView]:
    """For every command with a request and a reply, what makes a frame its answer."""
    grouped: dict[tuple[tuple[str, ...], bool], list[str]] = {}
    for command in edition.commands:
        if command.request is not None and command.reply is not None:
            conditions = tuple(_answer(views, command, command.request, command.reply))
            uses_from = views.message(command.reply).pattern.rule.has_nodes
            grouped.setdefault((conditions, uses_from), []).append(names.upper("command", command.name))
    return [AnswerView(tuple(commands), *answer) for answer, commands in grouped.items()]


def _answer(views: Messages, command: Command, request: Message, reply: Message) -> Iterator[str]:
    message = views.message(reply)
    rule = message.pattern.rule
    if not command.is_echoed:
        node = "&from, " if rule.has_nodes else ""
        calls = [
            f"{message.pattern.name}_match({node}{', '.join(('reply', f'{message.dlc}u', *codes))}) == CANWRIGHT_OK"
            for codes in _answering_codes(request, reply, message.codes)
        ]
        yield f"({' || '.join(calls)})" if len(calls) > 1 else calls[0]
    elif rule.has_nodes:
        yield f"{rule.node_function}(&from, {frame_id(reply, 'reply')}) == CANWRIGHT_OK"
    else:
        yield f"{rule.masked(frame_id(reply, 'reply'))} == {rule.id_macro}"
    if rule.has_nodes and command.from_each:
        yield _one_of("from", command.from_each)
    elif rule.has_nodes and request.id.nodes is not None and request.node_bits is None:
        yield "from == to"
    yield from _held_nodes(command, request, reply)
    if command.is_echoed:
        yield "canwright_same_data(request, reply)"


def _held_nodes(command: Command, request: Message, reply: Message) -> Iterator[str]:
    """Conditions on the node where a field of the request or of the reply holds it, as many bits as both have."""
    asked, told = request.node_bits, reply.node_bits
    if told is not None and command.from_each:
        nodes = sorted({node & (1 << told.width) - 1 for node in command.from_each})
        yield _one_of(bits.operand(bits.key_value(told, "reply")), nodes)
    if command.from_each or (asked is None and (told is None or request.id.nodes is None)):
        return
    sent_to = "to" if asked is None else bits.operand(bits.key_value(asked, "request"))
    sources = ["from"] if reply.id.nodes is not None and asked is not None else []
    for source in [*sources, *([bits.operand(bits.key_value(told, "reply"))] if told else [])]:
        width = min(key.width for key in (asked, None if source == "from" else told) if key is not None)
        sides = (
            side if key is not None and key.width == width else f"({side} & 0x{(1 << width) - 1:X}u)"
            for side, key in ((source, None if source == "from" else told), (sent_to, asked))
        )
        yield " == ".join(sides)


def _answering_codes(
    request: Message, reply: Message, codes: tuple[tuple[str, ...], ...]
) -> tuple[tuple[str, ...], ...]:
    """The codes of a reply; those of the request itself where they are the same, so that commands have one condition."""
    if request.keys == reply.keys and not reply.accept:
        return (tuple(bits.operand(bits.key_value(key, "request")) for key in request.keys),)
    return codes


def _one_of(name: str, numbers: Sequence[int]) -> str:
    if list(numbers) == list(range(numbers[0], numbers[-1] + 1)):
        low = [f"{name} >= {numbers[0]}u"] if numbers[0] else []
        return " && ".join([*low, f"{name} <= {numbers[-1]}u"])
    return "(" + " || ".join(f"{name} == {n}u" for n in numbers) + ")"
