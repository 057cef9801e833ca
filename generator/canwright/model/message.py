"""Addresses, messages and commands: how a frame is identified, who sends it, and the reply to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction
from functools import cached_property

from ..diagnostics.diagnostic import DocumentPath
from .deprecation import Deprecation
from .layout import Field, Layout, ParameterRole, Segment, Space
from .metadata import Effect, EndsMotion, Repeat, Setting
from .sending import Sending
from .types import Assignment, ImpliedTitle, Member, Order, Text, number_of

MAX_NODE_BITS = 32
"""The maximum width of a field that identifies a node."""
LISTED_NODES = 256
"""The maximum number of nodes of an address that an output lists one by one."""


class Direction(str, Enum):
    """The direction of a frame: the host sends requests, the node sends replies."""

    REQUEST = "request"
    REPLY = "reply"

    __hash__ = str.__hash__  # that of Enum takes longer


@dataclass(frozen=True, kw_only=True)
class IdRule:
    """The rule between node and CAN id: `id = base + node * node_step`, without the bits of keys and fields.

    `nodes` is None for a fixed id. `extended` means 29 bits instead of 11. If `parameter` is set, `parameter_step` times
    the value of that parameter is added; `at` has the rule for one value.
    """

    base: int
    node_step: int
    nodes: range | None
    extended: bool
    parameter: str | None = None
    parameter_step: int = 1

    @property
    def highest(self) -> int:
        """The highest id, without a parameter."""
        return self.base + (self.nodes[-1] * self.node_step if self.nodes else 0)

    def at(self, assignment: Assignment) -> IdRule | None:
        """The rule under some parameters; None if that of the id is missing."""
        if self.parameter is None:
            return self
        number = number_of(assignment, self.parameter)
        if number is None or number.denominator != 1:
            return None
        return replace(self, base=self.base + int(number) * self.parameter_step, parameter=None)


@dataclass(frozen=True, eq=False, kw_only=True)
class Address:
    """The ids of requests and replies; often one rule for both."""

    name: str
    request: IdRule
    reply: IdRule
    title: Text
    about: Text
    manual: str
    path: DocumentPath

    def rule(self, direction: Direction) -> IdRule:
        """The rule of the requests or of the replies."""
        return self.request if direction is Direction.REQUEST else self.reply


class KeyRole(str, Enum):
    """The role of a key: the meaning of its value."""

    CODE = "code"
    """The code of the command, at the position of the selector."""
    INDEX = "index"
    """An index of a table entry."""
    CONSTANT = "constant"
    """A constant field that has another value in other messages."""


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
    """Bits that must have `value` for a frame to be a given message. `path` is that of a constant, empty for others."""

    role: KeyRole
    value: int
    path: DocumentPath = field(default=(), compare=False)


@dataclass(frozen=True, kw_only=True)
class Confusion:
    """Values with which a frame of a message is identified as that of another command.

    All `conditions` have to be met: bits of the frame with one of their values.
    """

    command: str
    conditions: tuple[tuple[BitRun, tuple[int, ...]], ...]


@dataclass(frozen=True, kw_only=True)
class FrameSequence:
    """A message in several frames, in any order: `field` contains the number of each, one of `numbers`."""

    field: str
    numbers: range


@dataclass(frozen=True, eq=False, kw_only=True)
class Message:
    """A request or a reply: its id, its keys and its layout.

    A frame with the values of all `keys` is this message; `accepted_codes` are further accepted values of `keys[0]`. `identifying_codes`
    are the values of `keys[0]` that identify this message without its request: where several messages accept one
    value, it identifies the message whose command has that code.

    `confusions` are the values that cannot be sent, because receivers identify these frames as other messages.

    `only` maps a parameter to the values of nodes that accept a request; empty for a reply, which shows that the node has it.

    `sending` is None if nothing is stated about when it is sent, except that a reply answers its request. `sequence` is None
    if it is one frame.

    `largest_node` is the largest node in the ids of its address, or of the edition if those have no nodes; 0 without one.
    """

    name: str
    command: str
    direction: Direction
    address: str
    id: IdRule
    keys: tuple[Key, ...]
    accepted_codes: tuple[int, ...]
    identifying_codes: tuple[int, ...]
    confusions: tuple[Confusion, ...] = ()
    only: Mapping[str, tuple[str, ...]]
    dlc: int
    remote: bool
    sending: Sending | None
    sequence: FrameSequence | None
    layout: Layout
    largest_node: int
    path: DocumentPath

    @property
    def length(self) -> int:
        """The number of data bytes of a frame; a remote frame has none."""
        return 0 if self.remote else self.dlc

    @property
    def node_in_data(self) -> BitRun | None:
        """The bits of the field that identifies the node; None if the id does, or if a field has its low bits only.

        They are at most 32, so that every target has an integer for a node.
        """
        bits = self.node_bits
        if self.id.nodes is not None or bits is None or bits.width > MAX_NODE_BITS or self.has_low_bits_of_node:
            return None
        return bits

    @property
    def has_low_bits_of_node(self) -> bool:
        """Whether a field contains the low bits of the node only."""
        bits = self.node_bits
        return bits is not None and bool(self.largest_node >> bits.width)

    @property
    def node_bits(self) -> BitRun | None:
        """The bits of the field that contains the node or its low bits; None without such a field."""
        field = next((f for f in self.layout.fields if f.is_node), None)
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
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters in its id and in its constants."""
        names = [self.id.parameter] if self.id.parameter else []
        names += [f.role.parameter for f in self.layout.fields if isinstance(f.role, ParameterRole)]
        return tuple(dict.fromkeys(names))

    @cached_property
    def id_mask(self) -> int:
        """The bits of the id that keys and fields fill; the others belong to the id rule."""
        segments = [s for k in self.keys if k.space is Space.ID for s in k.segments]
        segments += [s for f in self.layout.fields if f.space is Space.ID for e in f.elements for s in e.segments]
        return sum(((1 << s.width) - 1) << s.low for s in segments)


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """A table: settings that several commands read and write by an index."""

    name: str
    title: Text
    about: Text
    manual: str
    path: DocumentPath


@dataclass(frozen=True, eq=False, kw_only=True)
class Entry:
    """An entry of a table: one of the settings; a command with a table has one form for each.

    `renamed_from` is its name in previous editions; codes may depend on the `kind`.
    """

    table: str
    name: str
    renamed_from: str | None
    kind: str | None
    title: Text
    about: Text
    manual: str
    path: DocumentPath


@dataclass(frozen=True, kw_only=True)
class Reply:
    """The reply to a request, in one of the forms below.

    `from_each` are the nodes that reply, one frame each in this order; empty when only the addressed node does.
    An alternative reply is sent instead of the others, and ends the exchange.
    """

    message: Message
    from_each: tuple[int, ...] = ()
    is_alternative: bool = False

    @property
    def frames(self) -> int:
        """The number of frames of one node, at most."""
        return len(self.message.sequence.numbers) if self.message.sequence else 1


@dataclass(frozen=True, kw_only=True)
class EchoReply(Reply):
    """The node sends the request back."""


@dataclass(frozen=True, kw_only=True)
class OwnReply(Reply):
    """The fields are defined in the command."""


@dataclass(frozen=True, kw_only=True)
class SharedReply(Reply):
    """The fields are those of a shared layout."""


@dataclass(frozen=True, kw_only=True)
class OtherReply(Reply):
    """The frame is the reply of another command, `of`."""

    of: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Command:
    """A code with its request and its replies: the first, those that follow it, and those that come instead.

    `code` is None without a selector. `only` maps a parameter to the values under which the command exists.
    `spec_name` is the name of the command in the spec. A command with a table has one form for each `entry`; the name of
    such a form is `COMMAND_ENTRY`. `short_spec_name` stands for `spec_name` where the length of names is limited, `previous_name`
    is `spec_name` in previous editions, `manual_name` the name that the manual prints; empty if it is not stated.
    """

    name: str
    short_spec_name: str
    spec_name: str
    previous_name: str | None
    deprecated: Deprecation | None
    entry: Entry | None
    code: int | None
    address: str
    mode: str | None
    only: Mapping[str, tuple[str, ...]]
    request: Message | None
    replies: tuple[Reply, ...]
    reply_within_ms: Fraction | None
    """Maximum time from request to reply, where that of the bus does not apply."""
    implemented: bool
    effects: tuple[Effect, ...]
    repeat: Repeat | None
    """What a second request does, if that does not follow from the effects."""
    ends_motion: EndsMotion | None
    limited_by: tuple[Setting, ...]
    not_limited_by: tuple[Setting, ...]
    title: Text
    about: Text
    notes: tuple[Text, ...]
    manual: str
    manual_name: str
    path: DocumentPath

    @property
    def short_name(self) -> str:
        """The name where the length of names is limited."""
        return self.short_spec_name + self.name.removeprefix(self.spec_name)

    @property
    def former_names(self) -> tuple[str, ...]:
        """Names in previous editions, where the command, its entry or both were renamed."""
        if self.entry is None:
            return (self.previous_name,) if self.previous_name else ()
        groups, entries = (
            (previous or now, now)
            for previous, now in ((self.previous_name, self.spec_name), (self.entry.renamed_from, self.entry.name))
        )
        names = dict.fromkeys(f"{group}_{entry}" for group in groups for entry in entries)
        return tuple(name for name in names if name != self.name)

    @property
    def spec_title(self) -> Text:
        """The title of the command without that of the entry."""
        if self.entry is None:
            return self.title
        title = {lang: text.removesuffix(f": {self.entry.title[lang]}") for lang, text in self.title.items()}
        return ImpliedTitle(title) if isinstance(self.title, ImpliedTitle) else title

    @property
    def reply(self) -> Message | None:
        """The first reply; None without one. Only this one can be defined in the command."""
        return self.replies[0].message if self.replies else None

    @property
    def messages(self) -> tuple[Message, ...]:
        """The request and the first reply, if there are any."""
        return tuple(message for message in (self.request, self.reply) if message is not None)

    @property
    def further_replies(self) -> tuple[Reply, ...]:
        """The replies that follow the first one, each of another command."""
        return tuple(reply for reply in self.replies[1:] if not reply.is_alternative)

    @property
    def alternative_replies(self) -> tuple[Reply, ...]:
        """The replies of other commands that are sent instead."""
        return tuple(reply for reply in self.replies[1:] if reply.is_alternative)

    @property
    def reply_parameters(self) -> tuple[str, ...]:
        """The parameters without which a reply cannot be decoded."""
        needed = (reply.message.layout.parameter for reply in self.replies)
        return tuple(dict.fromkeys(name for name in needed if name))

    @property
    def reply_frames(self) -> int:
        """The number of frames with which one node answers, at most."""
        return sum(reply.frames for reply in self.replies if not reply.is_alternative)

    @property
    def only_answers(self) -> bool:
        """Whether its reply is always that to a request."""
        reply = self.reply
        is_unasked = reply is not None and reply.sending is not None and reply.sending.is_unasked
        return self.request is not None and not is_unasked

    @property
    def is_echoed(self) -> bool:
        """Whether the node sends the request back."""
        return any(isinstance(reply, EchoReply) for reply in self.replies)

    def exemptions(self, effect: Effect) -> Sequence[tuple[Field, Member]]:
        """Values of request fields with which the command does not have an effect."""
        fields = self.request.layout.fields if self.request else ()
        return [(field, member) for field in fields for name, member in field.type.exemptions if name == effect.name]

    @cached_property
    def from_each(self) -> tuple[int, ...]:
        """The nodes that reply, one frame each in this order; empty when only the addressed node does."""
        return tuple(node for reply in self.replies for node in reply.from_each)

    def message(self, direction: Direction) -> Message | None:
        """The request or the reply; None without one."""
        return self.request if direction is Direction.REQUEST else self.reply

    def available(self, assignment: Assignment) -> bool:
        """False if the command does not exist under an assigned parameter value."""
        return all(assignment.get(name, values[0]) in values for name, values in self.only.items())
