"""Which frames a file has: one for every CAN id, with the messages that share it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from ...model import Address, Assignment, Command, Direction, Edition, Field, IdRule, Key, Message, Space

MOST_NODES = 256
"""A DBC names every id, so the files list the first nodes of an address that has more."""


@dataclass(frozen=True)
class Scope:
    """What one file is about: a direction of an edition, and what is known of its nodes."""

    edition: Edition
    direction: Direction
    assignment: Assignment
    numbers: Mapping[str, Fraction]
    first_node_only: bool = False

    def nodes(self, rule: IdRule) -> range | None:
        """The nodes of a rule that the file is for, as many as a file can list; None when the id is fixed."""
        return rule.nodes[: 1 if self.first_node_only else MOST_NODES] if rule.nodes else rule.nodes

    @cached_property
    def by_id(self) -> Mapping[tuple[IdRule, int], Sequence[Part]]:
        """The messages that share an id, in spec order."""
        return _by_id(self)

    @cached_property
    def frames(self) -> Sequence[Frame]:
        """The frames of a file, in the order their first messages have in the spec."""
        return tuple(
            Frame(rule, id_bits, tuple(part for part, hidden_by in _each(parts) if not hidden_by))
            for (rule, id_bits), parts in self.by_id.items()
        )


@dataclass(frozen=True)
class Part:
    """A message under one code; `values` are those of its keys."""

    command: Command
    message: Message
    values: tuple[int, ...]

    @cached_property
    def selectors(self) -> tuple[tuple[Key, int], ...]:
        """The keys that stand in the data, with their values."""
        return tuple((k, v) for k, v in zip(self.message.keys, self.values, strict=True) if k.space is Space.DATA)

    @cached_property
    def code(self) -> str:
        """The values of the keys in hexadecimal, as a part of names."""
        return "_".join(self._codes(Space.DATA, Space.ID))

    @property
    def codes_in_id(self) -> tuple[str, ...]:
        """The values of the keys that stand in the id, in hexadecimal."""
        return tuple(self._codes(Space.ID))

    def _codes(self, *spaces: Space) -> Iterator[str]:
        keys = zip(self.message.keys, self.values, strict=True)
        return (f"{value:0{(key.width + 3) // 4}X}" for key, value in keys if key.space in spaces)

    @property
    def id_bits(self) -> int:
        """What keys and constant fields put into the id."""
        keys = zip(self.message.keys, self.values, strict=True)
        placed = [(key.segments[0].low, value) for key, value in keys if key.space is Space.ID]
        placed += [(f.elements[0].segments[0].low, f.constant or 0) for f in fields_in_id(self.message)]
        return sum(value << low for low, value in placed)


class Frame(NamedTuple):
    """All that stands under one id of each node: `rule` and `id_bits` make the id."""

    rule: IdRule
    id_bits: int
    parts: tuple[Part, ...]

    def id(self, node: int | None) -> int:
        return self.rule.base + (node or 0) * self.rule.node_step + self.id_bits


def fields_in_id(message: Message) -> Iterator[Field]:
    return (f for f in message.layout.fields if f.space is Space.ID)


def obstacle(message: Message) -> str:
    """Why no DBC can say this message; empty when it can."""
    if message.remote:
        return "a remote frame has no data, and a DBC does not tell it from a data frame"
    varying = [f.name for f in fields_in_id(message) if f.constant is None]
    return f"the id carries {', '.join(varying)}, and a DBC has fixed ids only" if varying else ""


def overlaid(scope: Scope) -> dict[str, str]:
    """The messages of an id that one multiplexor does not tell apart from the others there, each with the reason."""
    return {
        part.message.name: f"{what} tells it from the other messages of its id, which no multiplexor can say"
        for parts in scope.by_id.values()
        for part, what in _each(parts)
        if what
    }


def messages(scope: Scope) -> Iterator[Message]:
    """The messages of the commands that there are under the assignment, in spec order."""
    available = [c for c in scope.edition.commands if c.available(scope.assignment)]
    used = {m.name for c in available for m in (c.request, c.reply) if m is not None}
    return (m for m in scope.edition.messages(scope.direction) if m.name in used)


def _each(parts: Sequence[Part]) -> Iterator[tuple[Part, str]]:
    """The parts of an id, each with what alone tells it from those that are shown; nothing for one of these.

    They are those without a selector, else those with it in one place; of those with one selector, the first.
    """
    places = [part.selectors[0][0].segments if part.selectors else () for part in parts]
    shown = () if () in places else places[0]
    alike: dict[tuple[tuple[Key, int], ...], Message] = {}
    for part, place in zip(parts, places, strict=True):
        first = alike.setdefault(part.selectors, part.message)
        if first.dlc != part.message.dlc:
            yield part, "only its length"
        elif place != shown:
            yield part, "only what it holds elsewhere"
        else:
            yield part, "" if first is part.message else "nothing"


def _by_id(scope: Scope) -> dict[tuple[IdRule, int], list[Part]]:
    found: dict[tuple[IdRule, int], list[Part]] = {}
    for message in (m for m in messages(scope) if not obstacle(m)):
        command = scope.edition.command(message.command)
        rest = tuple(k.value for k in message.keys[1:])
        for values in [(code, *rest) for code in message.claims] if message.keys else [()]:
            part = Part(command, message, values)
            found.setdefault((message.id, part.id_bits), []).append(part)
    return found


def partners(scope: Scope, part: Part) -> Sequence[tuple[str, int | None]]:
    """The nodes at the other end of a fixed id, as address and node: who hears a request, who sends a reply.

    That is the nodes of the command's addresses; where these have none, a request is heard by every node there is.
    """
    command, message, edition = part.command, part.message, scope.edition
    other = command.reply if message.direction is Direction.REQUEST else command.request
    near = dict.fromkeys((message.address, other.address if other else message.address))
    everywhere = [address.name for address in edition.addresses] if message.direction is Direction.REQUEST else []
    for names in (list(near), everywhere):
        found = [(name, node) for name in names for node in _nodes(scope, edition.address(name))]
        if found:
            return [end for end in found if end[1] in (command.from_each or (end[1],))]
    return [(message.address, None)]


def _nodes(scope: Scope, address: Address) -> Sequence[int]:
    return scope.nodes(address.request) or scope.nodes(address.reply) or ()
