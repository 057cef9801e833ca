"""From any frame to its message, and from a request to its answer: decision trees made here, `switch` in C."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.message import Command, Direction, Message
from ...semantics.decoder import by_rule
from . import bits
from .messages import Messages, RuleView, frame_id
from .names import Names
from .patterns import address_mask


class Refuse(NamedTuple):
    status: str


class Found(NamedTuple):
    """A command, and what else a frame is refused for: a condition and the status, for each reason."""

    command: str
    refusals: tuple[tuple[str, str], ...]


class Case(NamedTuple):
    labels: tuple[str, ...]
    then: Node


class Select(NamedTuple):
    """A `switch` over `subject`."""

    subject: str
    cases: tuple[Case, ...]
    otherwise: Node

    @property
    def is_plain(self) -> bool:
        """True when one value goes on and all others are refused."""
        return isinstance(self.otherwise, Refuse) and sum(len(case.labels) for case in self.cases) == 1


NOWHERE = Refuse("UNKNOWN_CODE")
Node = Refuse | Found | Select


class Entry(NamedTuple):
    """What is done with frames whose id belongs to an address. `other_length` holds when no message has the length."""

    rule: RuleView
    frame_id: str
    other_length: str
    then: Node


class AnswerView(NamedTuple):
    """Commands that are answered alike. `conditions` hold when the frame `reply` is their answer."""

    commands: tuple[str, ...]
    conditions: tuple[str, ...]
    uses_from: bool
    """True when the conditions get the node that answers."""


def entries(names: Names, edition: Edition, views: Messages, direction: Direction) -> list[Entry]:
    """Where the search for a message of any frame starts: one entry for each id rule."""
    found = (message for message in edition.messages(direction) if message.claims or not message.keys)
    return [
        Entry(
            views.rule(edition.address(messages[0].address), direction),
            frame_id(messages[0]),
            " && ".join(_other_length(dlc) for dlc in dict.fromkeys(m.dlc for m in messages if not m.remote)),
            _Tree(names, views, messages, address_mask(edition, messages[0].address, direction)).from_key(messages, 0),
        )
        for messages in by_rule(found)
    ]


def _other_length(dlc: int) -> str:
    return f"frame->dlc != {dlc}u"


class _Tree:
    """The search among messages that have one id rule; `id_mask` are the bits of the id that some of them fills."""

    def __init__(self, names: Names, views: Messages, messages: Sequence[Message], id_mask: int) -> None:
        self._names, self._views, self._id_mask = names, views, id_mask
        self._any_length = messages[0].remote or len({m.dlc for m in messages}) == 1

    def from_key(self, messages: Sequence[Message], depth: int, rest: Node = NOWHERE) -> Node:
        """Tells messages apart by their keys from `depth` on; one without a further key is what is left, then `rest`."""
        ends = [m for m in messages if len(m.keys) <= depth]
        node = self._by_length(ends) if ends else rest
        places: dict[tuple[object, ...], list[Message]] = {}
        for message in messages:
            if len(message.keys) > depth:
                key = message.keys[depth]
                places.setdefault((key.space, key.segments), []).append(message)
        for together in reversed(places.values()):
            node = Select(bits.key_value(together[0].keys[depth]), self._cases(together, depth, node), node)
        return node

    def _cases(self, messages: Sequence[Message], depth: int, rest: Node) -> tuple[Case, ...]:
        by_value: dict[int, list[Message]] = {}
        for message in messages:
            for value in message.claims if depth == 0 else (message.keys[depth].value,):
                by_value.setdefault(value, []).append(message)
        merged: list[Case] = []
        for value, same in by_value.items():
            case = Case(tuple(bits.labels(messages[0].keys[depth], [value])), self.from_key(same, depth + 1, rest))
            if merged and merged[-1].then == case.then:
                merged[-1] = merged[-1]._replace(labels=merged[-1].labels + case.labels)
            else:
                merged.append(case)
        return tuple(merged)

    def _by_length(self, messages: Sequence[Message]) -> Node:
        """The message that has the keys; by the number of data bytes where several have the same ones."""
        by_length = {m.dlc: m for m in reversed(messages)}
        if messages[0].remote or len(by_length) == 1:
            return self._found(messages[0])
        cases = (Case((f"{dlc}u",), self._found(by_length[dlc], any_length=True)) for dlc in sorted(by_length))
        return Select("frame->dlc", tuple(cases), Refuse("WRONG_LENGTH"))

    def _found(self, message: Message, *, any_length: bool = False) -> Found:
        unused = self._id_mask & ~message.id_mask
        refusals = (
            (f"(frame->id & 0x{unused:X}u) != 0u" if unused else "", "UNKNOWN_ID"),
            ("" if self._any_length or any_length else _other_length(message.dlc), "WRONG_LENGTH"),
            (self._views.message(message).other_constant, "WRONG_CONSTANT"),
        )
        command = self._names.upper("command", message.command)
        return Found(command, tuple((condition, status) for condition, status in refusals if condition))


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
