"""The frames of a file: one for every CAN id, with the messages that share it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, Space
from ...model.message import LISTED_NODES, Address, Command, Direction, IdRule, Key, Message
from ...model.types import Assignment
from .view import EXTENDED


@dataclass(frozen=True)
class Scope:
    """The scope of one file: the known parameters of the nodes, and the selected nodes."""

    edition: Edition
    assignment: Assignment
    numbers: Mapping[str, Fraction]
    selected: Sequence[int] = ()
    """The nodes to list; empty for all."""

    def nodes(self, rule: IdRule) -> Sequence[int] | None:
        """The nodes of a rule that the file lists; None if the id is fixed."""
        if rule.nodes is None:
            return None
        return [n for n in self.selected if n in rule.nodes] if self.selected else rule.nodes[:LISTED_NODES]

    def ids(self, frame: Frame) -> Iterator[int]:
        """The ids of a frame as they are in a file."""
        nodes = self.nodes(frame.rule)
        return (frame.dbc_id(node) for node in ((None,) if nodes is None else nodes))


class Part:
    """A message with one code; `selectors` are its keys in the data with their values."""

    def __init__(self, command: Command, message: Message, values: tuple[int, ...]) -> None:
        self.command = command
        self.message = message
        self._keys = tuple(zip(message.keys, values, strict=True))
        self.selectors = tuple((key, value) for key, value in self._keys if key.space is Space.DATA)

    @property
    def code(self) -> str:
        """The values of the keys in hexadecimal, for names."""
        return "_".join(self._codes(Space.DATA, Space.ID))

    @property
    def codes_in_id(self) -> tuple[str, ...]:
        """The values of the keys in the id, in hexadecimal."""
        return tuple(self._codes(Space.ID))

    def _codes(self, *spaces: Space) -> Iterator[str]:
        return (f"{value:0{(key.width + 3) // 4}X}" for key, value in self._keys if key.space in spaces)

    @property
    def id_bits(self) -> int:
        """The bits of the id that are set by keys and constant fields."""
        placed = [(key.segments[0].low, value) for key, value in self._keys if key.space is Space.ID]
        placed += [(f.elements[0].segments[0].low, f.role.sent_raw or 0) for f in fields_in_id(self.message)]
        return sum(value << low for low, value in placed)


class Frame(NamedTuple):
    """The messages of one id of each node; `rule` and `id_bits` define the id.

    `hidden` are messages that one multiplexor cannot distinguish from the others, each with the only difference.
    `shortest` is the length of the shortest message of the id, hidden ones included.
    """

    rule: IdRule
    id_bits: int
    parts: tuple[Part, ...]
    hidden: Mapping[str, str]
    shortest: int

    def dbc_id(self, node: int | None) -> int:
        """The id as it is in a file: with bit 31 set if it has 29 bits."""
        id_ = self.rule.base + (node or 0) * self.rule.node_step + self.id_bits
        return id_ | (EXTENDED if self.rule.extended else 0)


class Traffic:
    """One direction of an edition: its parts in the order of the spec, computed once for all files."""

    def __init__(self, edition: Edition, direction: Direction) -> None:
        self.edition = edition
        self.direction = direction
        self._parts = [(part, (part.message.id, part.id_bits)) for part in _parts(edition, direction)]

    def frames(self, assignment: Assignment) -> list[Frame]:
        """Frames of the commands that an assignment has, in the order of their first messages in the spec."""
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
    """Why a DBC cannot describe this message; empty if it can."""
    if message.remote:
        return "a remote frame has no data, and a DBC cannot distinguish it from a data frame"
    varying = [f.name for f in fields_in_id(message) if f.role.is_value]
    return f"the id contains {', '.join(varying)}, and a DBC has fixed ids only" if varying else ""


def _parts(edition: Edition, direction: Direction) -> Iterator[Part]:
    for message in edition.messages(direction):
        if not obstacle(message):
            command, rest = edition.command(message.command), tuple(key.value for key in message.keys[1:])
            for values in [(code, *rest) for code in message.identifying_codes] if message.keys else [()]:
                yield Part(command, message, values)


def _frame(rule: IdRule, id_bits: int, parts: Sequence[Part]) -> Frame:
    """The parts of an id that are shown: those without a selector, otherwise those with the same selector position.

    Of parts with the same selector values, one with fields is shown, or the longest, or else the first.
    """
    places = [part.selectors[0][0].segments if part.selectors else () for part in parts]
    shown_place = () if () in places else places[0]
    alike: dict[tuple[tuple[Key, int], ...], list[Message]] = {}
    for part in parts:
        alike.setdefault(part.selectors, []).append(part.message)
    kept = {selectors: max(messages, key=_content) for selectors, messages in alike.items()}
    shown: list[Part] = []
    hidden: dict[str, str] = {}
    for part, place in zip(parts, places, strict=True):
        message = kept[part.selectors]
        if message.dlc != part.message.dlc:
            hidden[part.message.name] = "only its length"
        elif place != shown_place:
            hidden[part.message.name] = "only the data at other positions"
        elif message is not part.message:
            hidden[part.message.name] = "nothing"
        else:
            shown.append(part)
    return Frame(rule, id_bits, tuple(shown), hidden, min(part.message.dlc for part in parts))


def _content(message: Message) -> tuple[bool, int]:
    """Whether a message has fields, and its length; `max` takes the first of several messages with the same content."""
    has_fields = any(f.role.is_value for f in message.layout.fields if f.space is Space.DATA)
    return has_fields, message.dlc


def partners(scope: Scope, part: Part) -> Sequence[tuple[str, int | None]]:
    """The receivers of a request or the senders of a reply with a fixed id, as address and node.

    These are the nodes of the addresses of the command. If there are none, every node receives the request.
    """
    command, message, edition = part.command, part.message, scope.edition
    counterpart = command.reply if message.direction is Direction.REQUEST else command.request
    near = dict.fromkeys((message.address, counterpart.address if counterpart else message.address))
    everywhere = [address.name for address in edition.addresses] if message.direction is Direction.REQUEST else []
    for names in (list(near), everywhere):
        ends = [(name, node) for name in names for node in _nodes(scope, edition.address(name))]
        if ends:
            return [end for end in ends if end[1] in (command.from_each or (end[1],))]
    return [(message.address, None)]


def _nodes(scope: Scope, address: Address) -> Sequence[int]:
    return scope.nodes(address.request) or scope.nodes(address.reply) or ()
