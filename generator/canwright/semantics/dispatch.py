"""The dispatch plan: how the message of a frame is identified, for the decoder and for every target.

The order of decisions: the id rule, the longest matching keys, the length, the message without keys.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, reduce
from operator import or_
from typing import NamedTuple

from ..model.edition import Edition
from ..model.message import BitRun, Direction, IdRule, Key, Message
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS, Assignment, Order


class MaskedId(NamedTuple):
    """The bits of the id under a mask, not shifted."""

    mask: int


@dataclass(frozen=True)
class Length:
    """The number of data bytes."""


Discriminator = BitRun | MaskedId | Length


class Reject(NamedTuple):
    """A leaf: no message; the frame is rejected."""

    reason: Refusal


class Match(NamedTuple):
    """A leaf: the frame is this message; constants are checked afterwards."""

    message: Message


class Case(NamedTuple):
    """The values of a subject that lead to one node."""

    values: tuple[int, ...]
    then: DispatchNode


@dataclass(frozen=True)
class Select:
    """A decision on the value of a subject: the node of its case, else `otherwise`."""

    subject: Discriminator
    cases: tuple[Case, ...]
    otherwise: DispatchNode

    @cached_property
    def by_value(self) -> Mapping[int, DispatchNode]:
        """The next node of each value that has a case."""
        return {value: case.then for case in self.cases for value in case.values}


DispatchNode = Select | Match | Reject


class Route(NamedTuple):
    """The messages of one id rule and kind of frame, and the decisions between them.

    `mask` are the bits of the id that their keys and fields fill; the id rule determines the others.
    """

    rule: IdRule
    remote: bool
    mask: int
    messages: tuple[Message, ...]
    then: DispatchNode

    def contains(self, id_: int, assignment: Assignment = NO_PARAMETERS) -> bool:
        """Whether an id belongs to this rule, with any values of keys and fields."""
        return has_rest(self.rule, id_ & ~self.mask, assignment)

    def node(self, id_: int, assignment: Assignment = NO_PARAMETERS) -> int | None:
        """The node of an id of this rule; None if the rule has no nodes."""
        return node_of_id(self.rule, id_ & ~self.mask, assignment)


class DispatchPlan(NamedTuple):
    """The routes in the order in which they are tried; a frame without a route is rejected (unknown_id).

    If the id of a route for such frames contains a missing parameter, it is rejected for that reason (missing_parameter).

    A route is for frames of its kind (29-bit or not, remote or not) whose id it contains. The fewer bits of the id keys
    and fields fill, the earlier a route is tried.
    """

    routes: tuple[Route, ...]


@lru_cache(maxsize=16)
def dispatch_plan(edition: Edition, direction: Direction) -> DispatchPlan:
    """The plan for messages of one direction; cached, because rules and every target ask for it."""
    groups: dict[tuple[IdRule, bool], list[Message]] = {}
    for message in edition.messages(direction):
        groups.setdefault((message.id, message.remote), []).append(message)
    routes = [_route(rule, remote, group) for (rule, remote), group in groups.items()]
    return DispatchPlan(tuple(sorted(routes, key=lambda route: route.mask.bit_count())))


def selection(message: Message) -> tuple[object, ...]:
    """All facts that the plan decides by: id rule, kind of frame, length and keys. They should identify one message."""
    length = None if message.remote else message.dlc
    return message.id, message.remote, length, tuple((bits_of_key(key), key.value) for key in message.keys)


def node_of_id(rule: IdRule, id_: int, assignment: Assignment = NO_PARAMETERS) -> int | None:
    """The node of an id without the bits of keys and fields; None without one."""
    known = rule.at(assignment)
    if known is None or known.nodes is None:
        return None
    node, remainder = divmod(id_ - known.base, known.node_step)
    return node if not remainder and node in known.nodes else None


def has_rest(rule: IdRule, id_: int, assignment: Assignment = NO_PARAMETERS) -> bool:
    """Whether an id without the bits of keys and fields belongs to a rule; no id does if a parameter is missing."""
    known = rule.at(assignment)
    if known is not None and known.nodes is None:
        return id_ == known.base
    return node_of_id(rule, id_, assignment) is not None


def _route(rule: IdRule, remote: bool, messages: Sequence[Message]) -> Route:
    mask = reduce(or_, (message.id_mask for message in messages), 0)
    lengths = sorted({message.dlc for message in messages})
    node = _Tree(mask, remote or len(lengths) == 1).of(_candidates(messages))
    if not remote:
        node = Select(Length(), (Case(tuple(lengths), node),), Reject(Refusal.WRONG_LENGTH))
    return Route(rule, remote, mask, tuple(messages), node)


Conditions = tuple[tuple[BitRun, int], ...]


class _Candidate(NamedTuple):
    """Messages with the same keys, one of each length, and the conditions that are not decided yet.

    `order` is the position of the first of them in the spec.
    """

    order: int
    conditions: Conditions
    messages: tuple[Message, ...]


def _candidates(messages: Sequence[Message]) -> list[_Candidate]:
    """Every message under each value that it claims: by the bits of the first key, then most keys first."""
    claims: dict[Conditions, tuple[int, dict[int, Message]]] = {}
    for order, message in enumerate(messages):
        for conditions in _conditions(message):
            claims.setdefault(conditions, (order, {}))[1].setdefault(message.dlc, message)
    candidates = [_Candidate(order, keys, tuple(same.values())) for keys, (order, same) in claims.items()]
    firsts = dict.fromkeys(bits_of_key(message.keys[0]) for message in messages if message.keys)
    rank = {bits: number for number, bits in enumerate(firsts)}
    return sorted(
        candidates,
        key=lambda candidate: (
            rank[candidate.conditions[0][0]] if candidate.conditions else len(rank),
            -len(candidate.conditions),
        ),
    )


def bits_of_key(key: Key) -> BitRun:
    """The bits of a key, without its name; the same bits of different messages are equal."""
    order = key.order if len(key.segments) > 1 else Order.LITTLE
    return BitRun(name="", space=key.space, order=order, width=key.width, segments=key.segments)


def _conditions(message: Message) -> Iterator[Conditions]:
    """The required values of the bits of all keys, for each value that the message claims."""
    if not message.keys:
        yield ()
        return
    first, *further = message.keys
    for value in message.identifying_codes:
        yield ((bits_of_key(first), value), *((bits_of_key(key), key.value) for key in further))


class _Tree:
    """Builds the decisions of one route; with `any_length` no message needs a check of its length."""

    def __init__(self, mask: int, any_length: bool) -> None:
        self._mask = mask
        self._any_length = any_length

    def of(self, candidates: Sequence[_Candidate]) -> DispatchNode:
        """The decisions between candidates: the first whose conditions are met is the result."""
        if not candidates:
            return Reject(Refusal.UNKNOWN_CODE)
        if not candidates[0].conditions:
            return self._by_length(candidates[0].messages)
        return self._select(candidates[0].conditions[0][0], candidates)

    def _select(self, subject: BitRun, candidates: Sequence[_Candidate]) -> DispatchNode:
        remaining: list[_Candidate] = []
        """Candidates without a condition on the subject: they remain for every value."""
        by_value: dict[int, list[_Candidate]] = {}
        for candidate in candidates:
            value = next((value for bits, value in candidate.conditions if bits == subject), None)
            if value is None:
                remaining.append(candidate)
            else:
                left = tuple(condition for condition in candidate.conditions if condition[0] != subject)
                by_value.setdefault(value, []).append(candidate._replace(conditions=left))
        cases: list[Case] = []
        for value, own in sorted(by_value.items(), key=lambda item: min(candidate.order for candidate in item[1])):
            then = self.of([*own, *remaining])
            if cases and cases[-1].then == then:
                cases[-1] = Case((*cases[-1].values, value), then)
            else:
                cases.append(Case((value,), then))
        return Select(subject, tuple(cases), self.of(remaining))

    def _by_length(self, messages: Sequence[Message]) -> DispatchNode:
        """The decision by length between messages with the same keys; no other message is tried."""
        wrong_length = Reject(Refusal.WRONG_LENGTH)
        first = messages[0]
        if self._any_length:
            return self._without_unused(first, Match(first))
        ordered = sorted(messages, key=lambda message: message.dlc)
        if len({message.id_mask for message in messages}) == 1:
            cases = tuple(Case((message.dlc,), Match(message)) for message in ordered)
            return self._without_unused(first, Select(Length(), cases, wrong_length))
        cases = tuple(Case((m.dlc,), self._without_unused(m, Match(m))) for m in ordered)
        return Select(Length(), cases, self._without_unused(first, wrong_length))

    def _without_unused(self, message: Message, then: DispatchNode) -> DispatchNode:
        """Rejects ids with bits that other messages of the route fill and this message does not."""
        unused = self._mask & ~message.id_mask
        return Select(MaskedId(unused), (Case((0,), then),), Reject(Refusal.UNKNOWN_ID)) if unused else then
