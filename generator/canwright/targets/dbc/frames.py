"""Which frames a file has: one for every CAN id, with the messages that share it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, Space
from ...model.message import Address, Command, Direction, IdRule, Key, Message
from ...model.types import Assignment

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


class Part:
    """A message under one code; `values` are those of its keys, `selectors` the keys in the data with theirs."""

    def __init__(self, command: Command, message: Message, values: tuple[int, ...]) -> None:
        self.command = command
        self.message = message
        self._keys = tuple(zip(message.keys, values, strict=True))
        self.selectors = tuple((key, value) for key, value in self._keys if key.space is Space.DATA)

    @property
    def code(self) -> str:
        """The values of the keys in hexadecimal, as a part of names."""
        return "_".join(self._codes(Space.DATA, Space.ID))

    @property
    def codes_in_id(self) -> tuple[str, ...]:
        """The values of the keys that stand in the id, in hexadecimal."""
        return tuple(self._codes(Space.ID))

    def _codes(self, *spaces: Space) -> Iterator[str]:
        return (f"{value:0{(key.width + 3) // 4}X}" for key, value in self._keys if key.space in spaces)

    @property
    def id_bits(self) -> int:
        """What keys and constant fields put into the id."""
        placed = [(key.segments[0].low, value) for key, value in self._keys if key.space is Space.ID]
        placed += [(f.elements[0].segments[0].low, f.fixed or 0) for f in fields_in_id(self.message)]
        return sum(value << low for low, value in placed)


class Frame(NamedTuple):
    """All that stands under one id of each node: `rule` and `id_bits` make the id.

    `hidden` are messages that one multiplexor does not tell apart from the others there, each with what alone does.
    """

    rule: IdRule
    id_bits: int
    parts: tuple[Part, ...]
    hidden: Mapping[str, str]

    def id(self, node: int | None) -> int:
        return self.rule.base + (node or 0) * self.rule.node_step + self.id_bits


class Traffic:
    """One direction of an edition: its parts in spec order, made once for all files."""

    def __init__(self, edition: Edition, direction: Direction) -> None:
        self.edition = edition
        self.direction = direction
        self._parts = [(part, (part.message.id, part.id_bits)) for part in _parts(edition, direction)]

    def frames(self, assignment: Assignment) -> list[Frame]:
        """Those of the commands that there are under an assignment, in the order their first messages have in the spec."""
        available = [command for command in self.edition.commands if command.available(assignment)]
        used = {m.name for c in available for m in (c.request, c.reply) if m is not None}
        by_id: dict[tuple[IdRule, int], list[Part]] = {}
        for part, its_id in self._parts:
            if part.message.name in used:
                by_id.setdefault(its_id, []).append(part)
        return [_frame(*its_id, parts) for its_id, parts in by_id.items()]


def fields_in_id(message: Message) -> Iterator[Field]:
    return (f for f in message.layout.fields if f.space is Space.ID)


def obstacle(message: Message) -> str:
    """Why no DBC can say this message; empty when it can."""
    if message.remote:
        return "a remote frame has no data, and a DBC does not tell it from a data frame"
    varying = [f.name for f in fields_in_id(message) if f.fixed is None]
    return f"the id carries {', '.join(varying)}, and a DBC has fixed ids only" if varying else ""


def _parts(edition: Edition, direction: Direction) -> Iterator[Part]:
    for message in edition.messages(direction):
        if not obstacle(message):
            command, rest = edition.command(message.command), tuple(key.value for key in message.keys[1:])
            for values in [(code, *rest) for code in message.claims] if message.keys else [()]:
                yield Part(command, message, values)


def _frame(rule: IdRule, id_bits: int, parts: Sequence[Part]) -> Frame:
    """What is shown of the parts of an id: those without a selector, else those with it in one place; the first of
    those with one selector."""
    places = [part.selectors[0][0].segments if part.selectors else () for part in parts]
    shown_place = () if () in places else places[0]
    shown: list[Part] = []
    hidden: dict[str, str] = {}
    alike: dict[tuple[tuple[Key, int], ...], Message] = {}
    for part, place in zip(parts, places, strict=True):
        first = alike.setdefault(part.selectors, part.message)
        if first.dlc != part.message.dlc:
            hidden[part.message.name] = "only its length"
        elif place != shown_place:
            hidden[part.message.name] = "only what it holds elsewhere"
        elif first is not part.message:
            hidden[part.message.name] = "nothing"
        else:
            shown.append(part)
    return Frame(rule, id_bits, tuple(shown), hidden)


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
