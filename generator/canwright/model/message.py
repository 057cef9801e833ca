"""Messages and commands: which frame is which, who sends it, and what comes back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from ..diagnostics.diagnostic import DocumentPath
from .layout import Layout, NodeRole, Segment, Space
from .metadata import Effect, Setting
from .types import Assignment, Order, Text


class Direction(str, Enum):
    """Who sends the frame: the host a request, the node a reply."""

    REQUEST = "request"
    REPLY = "reply"


@dataclass(frozen=True, kw_only=True)
class IdRule:
    """A rule from node to CAN id, and back: `id = base + node * node_step`, without the bits of keys and fields.

    `nodes` is None for a fixed id. `extended` means 29 bits instead of 11.
    """

    base: int
    node_step: int
    nodes: range | None
    extended: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Address:
    """Where requests go and replies come from; often the same rule."""

    name: str
    request: IdRule
    reply: IdRule
    title: Text
    about: Text
    manual: str
    path: DocumentPath

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


@dataclass(frozen=True, eq=False, kw_only=True)
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
    path: DocumentPath

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


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Things that several commands read and write by an index."""

    name: str
    title: Text
    about: Text
    manual: str
    path: DocumentPath


@dataclass(frozen=True, eq=False, kw_only=True)
class Entry:
    """The entry of a table that a form of a command is of; its `path` is where it stands."""

    table: str
    name: str
    title: Text
    about: Text
    manual: str
    path: DocumentPath


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


@dataclass(frozen=True, eq=False, kw_only=True)
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
    path: DocumentPath

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
