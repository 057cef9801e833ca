"""The frames of a file: one for every CAN id, with the messages that share it."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, ParameterRole, Segment, Space
from ...model.message import LISTED_NODES, Address, Command, Direction, IdRule, Key, Message
from ...model.types import Assignment, Encoding
from ...semantics.bits import data_bits, placed
from ...semantics.plan import MaskedBits, message_plan
from .view import EXTENDED

MAX_RANGED_BITS = 8
"""Readers list every value of a range, so that wider selectors have no ranges."""


class Part:
    """A message with one code, by default the one that is sent; `selectors` are its keys in the data with their values."""

    def __init__(self, command: Command, message: Message, values: Sequence[int] | None = None) -> None:
        self.command = command
        self.message = message
        sent = [key.value for key in message.keys]
        self._keys = tuple(zip(message.keys, sent if values is None else values, strict=True))
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

    @functools.cached_property
    def id_bits(self) -> int:
        """The bits of the id that are set by keys and constant fields."""
        keys = sum(placed(key.segments, value) for key, value in self._keys if key.space is Space.ID)
        sent = message_plan(self.message).sent.items()
        return keys + sum(placed(f.elements[0].segments, raw) for f, raw in sent if f.space is Space.ID)

    @functools.cached_property
    def selector_bits(self) -> int:
        """The data bits of the selectors as a mask."""
        return data_bits((key.space, key.segments) for key, _ in self.selectors)

    @functools.cached_property
    def fixed(self) -> MaskedBits:
        """The data bits that have the same value in every frame: of selectors and constants."""
        keys = MaskedBits.of((key.segments, value) for key, value in self.selectors)
        constants = message_plan(self.message).constants
        return MaskedBits(keys.mask | constants.mask, keys.value | constants.value)

    @functools.cached_property
    def joined_span(self) -> range | None:
        """The bits from the first selector to the last, which can be read as one number: a plain multiplexor.

        Few readers support nested ones. None if there is only one selector, or if bits between them can vary.
        """
        bits = self.selector_bits
        span = range((bits & -bits).bit_length() - 1, bits.bit_length())
        return span if len(self.selectors) > 1 and self.is_fixed(span) else None

    def is_fixed(self, span: range) -> bool:
        """Whether the bits of `span` are the same in every frame."""
        return all(self.fixed.mask >> bit & 1 for bit in span)

    def joined_value(self, span: range) -> int:
        """The number in `span` in every frame of this part."""
        return self.fixed.value >> span.start & (1 << len(span)) - 1


class Frame(NamedTuple):
    """The messages of one id of each node; `rule` and `id_bits` define the id.

    The last part has no selector if it has every value of the selector of the others that they do not have.

    `hidden` are messages that one multiplexor cannot distinguish from the others, each with the only difference.
    `shortest` is the length of the shortest message of the id, hidden ones included.
    """

    rule: IdRule
    id_bits: int
    parts: tuple[Part, ...]
    hidden: Mapping[str, str]
    shortest: int

    @property
    def direction(self) -> Direction:
        return self.parts[0].message.direction

    @property
    def length(self) -> int:
        """The length of the longest message that is shown."""
        return max(part.message.dlc for part in self.parts)

    def ids(self, selected: Sequence[int] = ()) -> Iterator[tuple[int | None, int]]:
        """Each listed node with its id as it is in a file: with bit 31 set if it has 29 bits; None for a fixed id."""
        nodes = listed_nodes(self.rule, selected)
        for node in (None,) if nodes is None else nodes:
            id_ = self.rule.base + (node or 0) * self.rule.node_step + self.id_bits
            yield node, id_ | (EXTENDED if self.rule.extended else 0)


def unlisted_nodes(frame: Frame) -> Iterator[str]:
    """The sentence about nodes that files do not list unless they are selected; none if there are none."""
    nodes = frame.rule.nodes or range(0)
    if len(nodes) > LISTED_NODES:
        last = nodes[LISTED_NODES - 1]
        yield f"the DBC files list the nodes up to {last} of {nodes[-1]}; select others with `--nodes {last + 1}..{nodes[-1]}`"


def listed_nodes(rule: IdRule, selected: Sequence[int]) -> Sequence[int] | None:
    """The nodes of a rule that a file lists, without selected ones the first; None if the id is fixed."""
    if rule.nodes is None:
        return None
    return [n for n in selected if n in rule.nodes] if selected else rule.nodes[:LISTED_NODES]


def frames(edition: Edition, direction: Direction, assignment: Assignment) -> Sequence[Frame]:
    """Frames of the commands that an assignment has, in the order of their first messages in the spec."""
    available = tuple(command for command in edition.commands if command.available(assignment))
    return _frames(edition, direction, available)


@functools.lru_cache(maxsize=16)
def _frames(edition: Edition, direction: Direction, commands: Sequence[Command]) -> Sequence[Frame]:
    """The frames of some commands; cached, as most values of parameters allow the same commands."""
    used = {message for command in commands for message in command.messages}
    by_id: dict[tuple[IdRule, int], list[Part]] = {}
    for part in _parts(edition, direction):
        if part.message in used:
            by_id.setdefault((part.message.id, part.id_bits), []).append(part)
    return [_frame(*its_id, parts) for its_id, parts in by_id.items()]


def obstacle(message: Message) -> str:
    """Why a DBC cannot describe this message; empty if it can."""
    if message.remote:
        return "a remote frame has no data, and a DBC cannot distinguish it from a data frame"
    in_id = [field for field in message.layout.fields if field.space is Space.ID]
    constants = [field.role.parameter for field in in_id if isinstance(field.role, ParameterRole)]
    unknown = [name for name in message.parameters if name in (message.id.parameter, *constants)]
    if unknown:
        return f"the id contains `{unknown[0]}`, and a DBC has fixed ids only; set it with `--set {unknown[0]}=NUMBER`"
    varying = [field.name for field in in_id if field.is_given]
    return f"the id contains {', '.join(varying)}, and a DBC has fixed ids only" if varying else ""


@functools.lru_cache(maxsize=16)
def _parts(edition: Edition, direction: Direction) -> Sequence[Part]:
    """The parts of one direction in the order of the spec; cached for all files."""
    parts = []
    for message in edition.messages(direction):
        if not obstacle(message):
            command, rest = edition.command(message.command), tuple(key.value for key in message.keys[1:])
            values = [(code, *rest) for code in message.identifying_codes] if message.keys else [()]
            parts += [Part(command, message, codes) for codes in values]
    return parts


def _frame(rule: IdRule, id_bits: int, parts: Sequence[Part]) -> Frame:
    """The parts of an id that are shown: those without a selector, otherwise those with the same selector position.

    Both are shown if the parts without a selector can have the other values of the selector. Of parts with the same
    selector values, one with fields is shown, or the longest, or else the first.
    """
    parts = sorted(parts, key=lambda part: not part.selectors)
    places = [part.selectors[0][0].segments if part.selectors else () for part in parts]
    alike: dict[tuple[tuple[Key, int], ...], list[Message]] = {}
    for part in parts:
        alike.setdefault(part.selectors, []).append(part.message)
    kept = {selectors: max(messages, key=_content) for selectors, messages in alike.items()}
    without_selector = kept.get(())
    has_ranges = without_selector is not None and _leaves_values(without_selector, [*kept])
    shown_place = () if without_selector and not has_ranges else places[0]
    shown: list[Part] = []
    hidden: dict[str, str] = {}
    for part, place in zip(parts, places, strict=True):
        message = kept[part.selectors]
        if message.dlc != part.message.dlc:
            hidden[part.message.name] = "only its length"
        elif place != shown_place and not (has_ranges and not place):
            hidden[part.message.name] = "only the data at other positions"
        elif message is not part.message:
            hidden[part.message.name] = "nothing"
        else:
            shown.append(part)
    return Frame(rule, id_bits, tuple(shown), hidden, min(part.message.dlc for part in parts))


def _leaves_values(message: Message, selectors: Sequence[tuple[tuple[Key, int], ...]]) -> bool:
    """Whether a message without a selector can have every value of the selector of the others that they do not have.

    A multiplexor cannot overlap a signal, so a field in its bits has to be the number that the multiplexor shows.
    """
    keyed = [of_part for of_part in selectors if of_part]
    keys = {(key.segments, key.width) for of_part in keyed for key, _ in of_part}
    (segments, width), *further = keys or {((), 0)}
    if further or len(segments) != 1 or width > MAX_RANGED_BITS or len(keyed) >= 1 << width:
        return False
    bits = data_bits([(Space.DATA, segments)])
    return all(
        is_shown_by(field, segments)
        for field in message.layout.fields
        if field.space is Space.DATA and data_bits((Space.DATA, e.segments) for e in field.elements) & bits
    )


def is_shown_by(field: Field, selector: Sequence[Segment]) -> bool:
    """Whether a field is the number in the bits of a selector."""
    type_ = field.type
    is_plain = (
        type_.is_plain and type_.encoding is Encoding.UNSIGNED and not (type_.no_values or type_.names or type_.unit)
    )
    return field.is_given and is_plain and [e.segments for e in field.elements] == [tuple(selector)]


def _content(message: Message) -> tuple[bool, int]:
    """Whether a message has fields, and its length; `max` takes the first of several messages with the same content."""
    has_fields = any(f.is_given for f in message.layout.fields if f.space is Space.DATA)
    return has_fields, message.dlc


def partners(edition: Edition, part: Part, selected: Sequence[int]) -> Sequence[tuple[str, int | None]]:
    """The receivers of a request or the senders of a reply with a fixed id, as address and node.

    These are the nodes of the addresses of the command. If there are none, every node receives the request.
    """
    command, message = part.command, part.message
    counterpart = command.reply if message.direction is Direction.REQUEST else command.request
    near = dict.fromkeys((message.address, counterpart.address if counterpart else message.address))
    everywhere = [address.name for address in edition.addresses] if message.direction is Direction.REQUEST else []
    for names in (list(near), everywhere):
        ends = [(name, node) for name in names for node in _nodes(edition.address(name), selected)]
        if ends:
            return [end for end in ends if end[1] in (command.from_each or (end[1],))]
    return [(message.address, None)]


def _nodes(address: Address, selected: Sequence[int]) -> Sequence[int]:
    return listed_nodes(address.request, selected) or listed_nodes(address.reply, selected) or ()
