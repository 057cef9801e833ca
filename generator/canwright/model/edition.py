"""The resolved edition: frozen, complete and exact. This is all that targets read.

Positions are bits. In the data, bit `n` is bit `n % 8` (0 is the least significant) of byte `n // 8`; in the id, bit 0
is the least significant. Every number is an int or a Fraction; nothing here is a float.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

from ..diagnostics.diagnostic import DocumentPath
from .layout import (
    ConstantRole as ConstantRole,
    Element as Element,
    Field as Field,
    FieldRole as FieldRole,
    Layout as Layout,
    NodeRole as NodeRole,
    ReservedRole as ReservedRole,
    Segment as Segment,
    Space as Space,
    ValueRole as ValueRole,
    Variant as Variant,
)
from .metadata import (
    Bus as Bus,
    Effect as Effect,
    Erratum as Erratum,
    Level as Level,
    Mode as Mode,
    Setting as Setting,
)
from .types import (
    IDENTITY as IDENTITY,
    UNNAMED as UNNAMED,
    Assignment as Assignment,
    Bound as Bound,
    Dependent as Dependent,
    Encoding as Encoding,
    Linear as Linear,
    Member as Member,
    Order as Order,
    Parameter as Parameter,
    ParameterValue as ParameterValue,
    Range as Range,
    Text as Text,
    Type as Type,
    Unit as Unit,
)


class Direction(str, Enum):
    """Who sends the frame: the host a request, the node a reply."""

    REQUEST = "request"
    REPLY = "reply"


@dataclass(frozen=True)
class IdRule:
    """A rule from node to CAN id, and back: `id = base + node * node_step`, without the bits of keys and fields.

    `nodes` is None for a fixed id. `extended` means 29 bits instead of 11.
    """

    base: int
    node_step: int
    nodes: range | None
    extended: bool


@dataclass(frozen=True)
class Address:
    """Where requests go and replies come from; often the same rule."""

    name: str
    request: IdRule
    reply: IdRule
    title: Text
    about: Text
    manual: str
    path: DocumentPath = field(compare=False)

    def rule(self, direction: Direction) -> IdRule:
        """The rule of its requests, or of its replies."""
        return self.request if direction is Direction.REQUEST else self.reply


class KeyRole(str, Enum):
    """What the value of a key stands for."""

    CODE = "code"
    """The code of the command, where its selector is."""
    INDEX = "index"
    """An index of the entry of a table."""
    CONSTANT = "constant"
    """The constant of a field that other messages have otherwise."""


@dataclass(frozen=True, kw_only=True)
class BitRun:
    """Bits that are read as one unsigned integer."""

    name: str
    space: Space
    order: Order
    width: int
    segments: tuple[Segment, ...]


@dataclass(frozen=True, kw_only=True)
class Key(BitRun):
    """Bits that must have `value` for a frame to be a given message."""

    role: KeyRole
    value: int


@dataclass(frozen=True, eq=False)
class Message:
    """One frame form in one direction.

    `keys` select it; `accept` are further values that a receiver takes for `keys[0]`. `claims` are the values of
    `keys[0]` that `edition.messages(direction)` attributes to this message when nothing else is known: two messages
    may share a first byte, and then the one whose command has that code is meant.
    """

    name: str
    command: str
    direction: Direction
    address: str
    id: IdRule
    keys: tuple[Key, ...]
    accept: tuple[int, ...]
    claims: tuple[int, ...]
    dlc: int
    remote: bool
    layout: Layout
    path: DocumentPath = field(compare=False)

    @property
    def node_bits(self) -> BitRun | None:
        """The bits of the field whose role is the node; None when there is no such field."""
        field = next((f for f in self.layout.fields if isinstance(f.role, NodeRole)), None)
        if field is None:
            return None
        return BitRun(
            name=field.name,
            space=field.space,
            order=field.type.order,
            width=field.type.width,
            segments=field.elements[0].segments,
        )

    @cached_property
    def id_mask(self) -> int:
        """Bits of the id that keys and fields fill; the rest is the id rule's."""
        segments = [s for k in self.keys if k.space is Space.ID for s in k.segments]
        segments += [s for f in self.layout.fields if f.space is Space.ID for e in f.elements for s in e.segments]
        return sum(((1 << s.width) - 1) << s.low for s in segments)


@dataclass(frozen=True)
class Table:
    """Things that several commands read and write by an index."""

    name: str
    title: Text
    about: Text
    manual: str
    path: DocumentPath = field(compare=False)


@dataclass(frozen=True)
class Entry:
    """The entry of a table that a form of a command is of; its `path` is where it stands."""

    table: str
    name: str
    title: Text
    about: Text
    manual: str
    path: DocumentPath = field(compare=False)


@dataclass(frozen=True, kw_only=True)
class Reply:
    """What comes back after a request, in one of the forms below.

    `from_each` are the nodes that reply, one frame each in this order; empty when only the addressed node does.
    """

    message: Message
    from_each: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class EchoReply(Reply):
    """The node sends the request back."""


@dataclass(frozen=True, kw_only=True)
class OwnReply(Reply):
    """The fields stand with the command."""


@dataclass(frozen=True, kw_only=True)
class SharedReply(Reply):
    """The fields are those of a shared layout."""


@dataclass(frozen=True, kw_only=True)
class OtherReply(Reply):
    """The frame is the reply of another command, `of`."""

    of: str


@dataclass(frozen=True, kw_only=True)
class Command:
    """A code with its request and its replies, at most one today.

    `code` is None when no selector tells it. `only` maps a parameter to the values that have the command.
    `group` is the command as the spec has it: the name, but for the forms that a table gives a command, `GROUP_ENTRY`;
    then `entry` is that entry.
    """

    name: str
    group: str
    entry: Entry | None
    code: int | None
    address: str
    mode: str | None
    only: Mapping[str, tuple[str, ...]]
    request: Message | None
    replies: tuple[Reply, ...]
    implemented: bool
    effects: tuple[Effect, ...]
    limited_by: tuple[Setting, ...]
    not_limited_by: tuple[Setting, ...]
    title: Text
    about: Text
    notes: tuple[Text, ...]
    manual: str
    path: DocumentPath = field(compare=False)

    @property
    def group_title(self) -> Text:
        """The title of the command as the spec has it, without that of an entry."""
        if self.entry is None:
            return self.title
        return {lang: text.removesuffix(f": {self.entry.title[lang]}") for lang, text in self.title.items()}

    @property
    def reply(self) -> Message | None:
        """The frame that comes back."""
        return self.replies[0].message if self.replies else None

    @property
    def is_echoed(self) -> bool:
        """Whether the node sends the request back."""
        return any(isinstance(reply, EchoReply) for reply in self.replies)

    @property
    def from_each(self) -> tuple[int, ...]:
        """The nodes that reply, one frame each in this order; empty when only the addressed node does."""
        return tuple(node for reply in self.replies for node in reply.from_each)

    def message(self, direction: Direction) -> Message | None:
        """Its request, or its reply."""
        return self.request if direction is Direction.REQUEST else self.reply

    def available(self, assignment: Assignment) -> bool:
        """False when an assigned parameter has a value that lacks the command."""
        return all(assignment.get(name, values[0]) in values for name, values in self.only.items())


@dataclass(frozen=True)
class Edition:
    """One exact protocol, resolved. `hash` is the SHA-256 of the spec's text, in hex."""

    family: str
    name: str
    date: str
    languages: tuple[str, ...]
    title: Text
    about: Text
    manual: Text
    hash: str
    order: Order
    bus: Bus
    parameters: tuple[Parameter, ...]
    settings: tuple[Setting, ...]
    effects: tuple[Effect, ...]
    addresses: tuple[Address, ...]
    types: tuple[Type, ...]
    layouts: tuple[Layout, ...]
    tables: tuple[Table, ...]
    commands: tuple[Command, ...]
    errata: tuple[Erratum, ...]

    @property
    def identifier(self) -> str:
        """The edition's name as an identifier: `v2.35-2024-02` is `v2_35_2024_02`."""
        return "".join(c if c.isalnum() else "_" for c in self.name)

    def messages(self, direction: Direction) -> Sequence[Message]:
        """The distinct messages of one direction, in spec order."""
        return self._index.messages[direction]

    def all_messages(self) -> Sequence[Message]:
        """The distinct messages of both directions."""
        return self._index.all_messages

    def of_rule(self, direction: Direction, rule: IdRule) -> Sequence[Message]:
        """The messages of one direction that have an id rule."""
        return self._index.of_rule.get((direction, rule), ())

    def of_layout(self, layout: Layout) -> Sequence[Message]:
        """The messages that have a layout: this very one, not one like it."""
        return self._index.of_layout.get(layout, ())

    def command(self, name: str) -> Command:
        return self._index.commands[name]

    def parameter(self, name: str) -> Parameter:
        return next(p for p in self.parameters if p.name == name)

    def is_factor(self, parameter: Parameter) -> bool:
        """Whether a scale is a multiple of a parameter, which then is above 0."""
        return any(parameter.name in type_.times for type_ in self.types)

    def address(self, name: str) -> Address:
        return self._index.addresses[name]

    def table(self, name: str) -> Table:
        return next(t for t in self.tables if t.name == name)

    def errata_of(self, command: Command) -> tuple[Erratum, ...]:
        """The errata that a user of `command` meets: its own and those of the entry, layouts and types it uses."""
        if not self.errata:
            return ()
        messages = [m for m in (command.request, command.reply) if m is not None]
        paths = [command.path, *(path for m in messages for path in (m.path, m.layout.path))]
        paths += [path for m in messages for f in m.layout.fields for path in (f.path, f.type.path)]
        paths += [command.entry.path] if command.entry else []
        met = self._errata_at(paths)
        if command.entry is not None:
            table = ("tables", command.entry.table)
            met |= {n for n in self._errata_at([table]) if any(_is_about(w, table) for w in self.errata[n].where)}
        return tuple(self.errata[number] for number in sorted(met))

    def errata_at(self, *paths: DocumentPath) -> tuple[Erratum, ...]:
        """The errata about what stands at some paths, or within, in spec order."""
        return tuple(self.errata[number] for number in sorted(self._errata_at(paths)))

    def _errata_at(self, paths: Iterable[DocumentPath]) -> set[int]:
        return {number for path in paths for number in self._index.errata.get(".".join(map(str, path)), ())}

    @cached_property
    def _index(self) -> _Index:
        return _Index(self)


def _is_about(where: str, table: DocumentPath) -> bool:
    """Whether a dotted path leads into a table, and not to one of its entries."""
    dotted = ".".join(map(str, table))
    return where == dotted or (where.startswith(f"{dotted}.") and not where.startswith(f"{dotted}.entries."))


class _Index:
    """What is looked up in an edition again and again, found once. Of things of one name, the first is meant."""

    def __init__(self, edition: Edition) -> None:
        self.commands = {command.name: command for command in reversed(edition.commands)}
        self.addresses = {address.name: address for address in reversed(edition.addresses)}
        self.messages: dict[Direction, list[Message]] = {direction: [] for direction in Direction}
        for command in edition.commands:
            for direction, message in ((Direction.REQUEST, command.request), (Direction.REPLY, command.reply)):
                if message is not None and message.command == command.name:
                    self.messages[direction].append(message)
        self.all_messages = [message for messages in self.messages.values() for message in messages]
        self.of_rule: dict[tuple[Direction, IdRule], list[Message]] = {}
        self.of_layout: dict[Layout, list[Message]] = {}
        for message in self.all_messages:
            self.of_rule.setdefault((message.direction, message.id), []).append(message)
            self.of_layout.setdefault(message.layout, []).append(message)
        self.errata: dict[str, list[int]] = {}
        """The numbers of the errata, by every dotted path that leads to what they are about."""
        for number, erratum in enumerate(edition.errata):
            for where in erratum.where:
                steps = where.split(".")
                for end in range(1, len(steps) + 1):
                    self.errata.setdefault(".".join(steps[:end]), []).append(number)
