"""The view of an edition for the template of its header."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Layout
from ...model.message import Command, Direction, Message, OtherReply
from ...model.metadata import Level
from ...model.types import Type
from ..base import header
from .choices import parameter_access, parameters
from .conversions import ConversionView
from .dispatch import RouteView, UnpackView, answers, command_numbers, routes
from .expressions import call, joined
from .layouts import LayoutView, fields_named
from .messages import Messages, MessageView, addresses
from .names import Names, layouts, member
from .text import english, errata, literal, with_deprecation
from .types import MacroView, TypeView, types


class FrameView(NamedTuple):
    """A message with its layout."""

    message: MessageView
    layout: LayoutView
    own_layout: bool
    own_struct: bool
    title: str
    deprecated: str
    """The end of a comment on a deprecated message."""
    lacking: str
    """For a request, the condition for a node that does not have the command; empty without parameters that decide it."""

    @property
    def takes_parameters(self) -> bool:
        """True if encoding the message needs the parameters."""
        return self.layout.takes_parameters or bool(self.lacking)

    @property
    def name(self) -> str:
        return self.message.name

    @property
    def struct(self) -> str:
        """The struct's name; empty if the message has no fields."""
        return self.message.struct if self.layout.members else ""

    @property
    def stamp(self) -> str:
        """The call that writes id, length and code of a frame."""
        pattern = self.message.pattern
        arguments = [
            "frame",
            *(["node"] if pattern.rule.has_nodes else []),
            f"{self.message.dlc}u",
            *self.message.codes[0],
        ]
        return f"{pattern.name}_stamp({', '.join(arguments)})"

    @property
    def matches(self) -> list[str]:
        """The calls of which one succeeds if a frame is this message."""
        pattern = self.message.pattern
        start = [*(["node"] if pattern.rule.has_nodes else []), "frame", f"{self.message.dlc}u"]
        return [f"{pattern.name}_match({', '.join([*start, *codes])})" for codes in self.message.codes]

    def encode(self, frame: str, node: str, message: str, parameters: str) -> str:
        """The call that encodes a message, without the arguments that it does not take."""
        return call(
            f"{self.name}_encode",
            frame,
            node if self.message.pattern.rule.has_nodes else "",
            message if self.struct else "",
            parameters if self.takes_parameters else "",
        )

    def decode(self, message: str, node: str, frame: str, parameters: str) -> str:
        """The call that decodes a message, without the arguments that it does not take."""
        return call(
            f"{self.name}_decode",
            message if self.struct else "",
            node if self.message.has_node else "",
            frame,
            parameters if self.layout.depends else "",
        )

    @property
    def is_match_only(self) -> bool:
        """True if there is nothing to read or check after the match."""
        message = self.message
        return not (
            self.layout.members
            or self.layout.depends
            or message.other_constant
            or message.node_in_data
            or self.matches[1:]
        )


class CommandView(NamedTuple):
    name: str
    enumerator: str
    number: str
    heading: str
    doc: tuple[str, ...]
    code: MacroView | None
    frames: tuple[FrameView, ...]


class EffectsView(NamedTuple):
    """Commands that have the same effects."""

    commands: tuple[str, ...]
    value: str


class AvailabilityView(NamedTuple):
    """Commands that a node has under the same condition."""

    commands: tuple[str, ...]
    condition: str


class ContentView(NamedTuple):
    """A command whose message of one direction has fields: its member in the union."""

    command: str
    member: str
    doc: str


class ContentsView(NamedTuple):
    """Commands whose messages of one direction have the same layout."""

    layout: LayoutView
    commands: tuple[ContentView, ...]

    @property
    def member(self) -> str:
        """One of the members; all have the same type."""
        return self.commands[0].member


@dataclass(frozen=True, eq=False, kw_only=True)
class DirectionView:
    """Any message of one direction.

    `without_node` are the commands whose id contains no node. `without_fields` is true if some commands have no fields.
    """

    word: str
    identify: tuple[RouteView, ...]
    decode: tuple[RouteView, ...]
    contents: tuple[ContentsView, ...]
    without_node: tuple[str, ...]
    without_fields: bool
    checks_availability: bool

    @cached_property
    def cleared(self) -> list[str]:
        """Fields of the union that cover all its bytes that some commands do not write: few and large ones, in their order."""
        written = {content: _all_bytes(content.layout) for content in self.shown}
        everywhere = [*written.values(), *([frozenset[int]()] if self.without_fields else [])]
        missing = frozenset[int]().union(*everywhere).difference(frozenset.intersection(*everywhere))
        fields = {place.bytes: f"{some.member}.{place.name}" for some in written for place in some.layout.places}
        times = Counter(itertools.chain(*fields))
        for covered in sorted(fields, key=len):
            if all(times[byte] > 1 for byte in missing & covered):
                times.subtract(covered)
                del fields[covered]
        return [fields[covered] for covered in sorted(fields, key=max)]

    @cached_property
    def members(self) -> list[tuple[LayoutView, ContentView]]:
        """The members of the union: a struct and its command."""
        return [(some.layout, content) for some in self.contents if some.layout.members for content in some.commands]

    @cached_property
    def by_command(self) -> Mapping[str, ContentView]:
        """The members of the union by command."""
        return {content.command: content for _, content in self.members}

    def print(self, e: EditionView, frame: str) -> str:
        """The call that prints a frame into the array `text`."""
        parameters = "&parameters" if self.show_parameters else ""
        return call(f"{e.prefix}print_{self.word}", "text", "sizeof text", frame, parameters)

    @cached_property
    def depends(self) -> bool:
        return any(content.layout.depends for content in self.contents)

    @cached_property
    def shown(self) -> list[ContentsView]:
        """The contents that have something to print."""
        return [content for content in self.contents if content.layout.members]

    @cached_property
    def has_nodes(self) -> bool:
        return any(route.rule.has_nodes for route in self.decode)

    @cached_property
    def show_parameters(self) -> bool:
        return self.depends or any(content.layout.show_parameters for content in self.shown)

    @cached_property
    def checked(self) -> list[ContentsView]:
        """The contents that have something to check."""
        return [content for content in self.contents if content.layout.has_check]

    @cached_property
    def check_parameters(self) -> bool:
        return self.checks_availability or any(content.layout.check_parameters for content in self.contents)


class FloatingView(NamedTuple):
    """The conversions to one floating-point type, and the preprocessor condition under which they exist."""

    guard: str
    types: tuple[tuple[TypeView, ConversionView], ...]


class EditionView:
    """The content of a header. `spec` is the start of the hash of its spec; every name has `prefix` or `PREFIX`."""

    def __init__(self, edition: Edition) -> None:
        self.names = names = Names(edition)
        used, numbers, messages = layouts(edition), command_numbers(edition), Messages(names, edition)
        self.header = header(edition)
        self.spec = edition.hash[:8]
        self.prefix, self.PREFIX = names.lower(""), names.upper("")
        self.family, self.file = edition.family, edition.identifier
        self.title = english(edition.title)
        self.doc = _edition_doc(edition)
        self.facts = list(_facts(names, edition))
        self.parameters = parameters(names, edition)
        self.addresses = addresses(names, edition, messages)
        self.types = types(names, edition)
        self.fields = [(names.upper("field", name), name) for name in fields_named(used)]
        self._types = {view.name: view for view in self.types}
        views = {layout: LayoutView(names, edition, layout, self._types) for layout in used}
        self.layouts = [views[layout] for layout in used if layout.shared]
        self.commands = [_command(names, edition, messages, c, numbers[c.name], views) for c in edition.commands]
        self._frames = {frame.name: frame for command in self.commands for frame in command.frames}
        self.effects = _effects(names, edition)
        self.command_effects = _command_effects(names, edition)
        self.availability = _availability(names, edition)
        self.directions = [_direction(names, edition, messages, direction, views) for direction in Direction]
        self.answers = answers(names, edition, messages)

    def frame(self, message: Message) -> FrameView:
        return self._frames[self.names.lower(message.name)]

    def type(self, type_: Type) -> TypeView:
        return self._types[self.names.lower(self.names.type_stem(type_))]

    def has(self, type_: Type) -> bool:
        """Whether some field has a type."""
        return self.names.lower(self.names.type_stem(type_)) in self._types

    def direction(self, direction: Direction) -> DirectionView:
        return next(view for view in self.directions if view.word == direction.value)

    @property
    def parameters_argument(self) -> str:
        return f"const {self.prefix}parameters_t *parameters"

    @property
    def printed(self) -> list[LayoutView]:
        """The layouts that messages print."""
        return list({content.layout.name: content.layout for d in self.directions for content in d.shown}.values())

    @property
    def floating(self) -> list[FloatingView]:
        return [
            FloatingView("", tuple((type_, type_.single) for type_ in self.types if type_.single)),
            FloatingView("CANWRIGHT_HAS_DOUBLE", tuple((type_, type_.double) for type_ in self.types if type_.double)),
        ]

    @property
    def has_reply_time(self) -> bool:
        return any(fact.name == f"{self.PREFIX}REPLY_WITHIN_US" for fact in self.facts)

    @property
    def effect_bits(self) -> int:
        return 64 if len(self.effects) > 32 else 32

    @property
    def answers_use_from(self) -> bool:
        return any(answer.uses_from for answer in self.answers)


@lru_cache(maxsize=4)
def edition_view(edition: Edition) -> EditionView:
    """Everything that the templates of an edition print; cached, because examples on pages use it, too."""
    return EditionView(edition)


def _edition_doc(edition: Edition) -> list[str]:
    manual = english(edition.manual)
    source = f"Numbers in brackets are sections of: {manual}." if manual else ""
    return [text for text in (english(edition.about), source) if text]


def _facts(names: Names, edition: Edition) -> Iterator[MacroView]:
    """What a device can report of the edition, and the time-out of replies."""
    yield MacroView(names.upper("edition"), literal(edition.name), "The name of the edition.")
    yield MacroView(names.upper("spec_hash"), literal(edition.hash), "The SHA-256 of the spec, in hexadecimal.")
    within = edition.bus.reply_within_ms
    if within is not None:
        rounded = "" if (within * 1000).denominator == 1 else ", rounded up"
        slow = f" It does not apply to {', '.join(edition.slow_replies)}." if edition.slow_replies else ""
        doc = f"Maximum time from request to reply, in microseconds{rounded}.{slow}"
        yield MacroView(names.upper("reply_within_us"), f"{math.ceil(within * 1000)}u", doc)


def _command(
    names: Names,
    edition: Edition,
    message_views: Messages,
    command: Command,
    number: int,
    views: Mapping[Layout, LayoutView],
) -> CommandView:
    messages = [m for m in (command.request, command.reply) if m is not None and m.command == command.name]
    code = None
    if command.code is not None:
        code = MacroView(
            names.upper(command.name, "code"), f"0x{command.code:02X}u", "Identifies the command in a frame."
        )
    frames: list[FrameView] = []
    lacking = [f"{parameter} == {value}" for parameter, value in _lacking(names, edition, command)]
    for message in messages:
        layout = views[message.layout]
        own_struct = message.name == message.layout.name
        what = f"The {message.direction.value}" if own_struct else "Request and reply"
        frames.append(
            FrameView(
                message=message_views.message(message),
                layout=layout,
                own_layout=not message.layout.shared and all(f.layout is not layout for f in frames),
                own_struct=own_struct,
                title=f"{what} of {command.name}",
                deprecated=with_deprecation("", command.deprecated),
                lacking=joined("||", lacking) if lacking and message.direction is Direction.REQUEST else "",
            )
        )
    return CommandView(
        name=command.name,
        enumerator=names.command(command.name),
        number=f"0x{number:02X}",
        heading=english(command.title) + (f" ({command.manual})" if command.manual else ""),
        doc=tuple(_command_doc(edition, command)),
        code=code,
        frames=tuple(frames),
    )


def _command_doc(edition: Edition, command: Command) -> list[str]:
    paragraphs = [english(command.about), with_deprecation("", command.deprecated)]
    if not command.implemented:
        paragraphs.append("The manual says that this is not implemented yet.")
    if command.reply_within_ms is not None:
        paragraphs.append(f"Maximum time from request to reply: {formatting.exact(command.reply_within_ms)} ms.")
    if command.only:
        paragraphs.append(f"Only {formatting.condition(command.only)}.")
    for level in (Level.DANGER, Level.WARNING, Level.NOTE):
        titles = [formatting.effect(english(e.title), command, e) for e in command.effects if e.level is level]
        if titles:
            paragraphs.append(f"{level.value.capitalize()}: {'; '.join(titles)}.")
    for verb, settings in (("Limited by", command.limited_by), ("Not limited by", command.not_limited_by)):
        if settings:
            paragraphs.append(f"{verb}: {', '.join(english(s.title) for s in settings)}.")
    paragraphs.append(_reply_doc(command))
    paragraphs += [english(note) for note in command.notes]
    return [text for text in (*paragraphs, *errata(edition, command.path)) if text]


def _reply_doc(command: Command) -> str:
    nodes = command.from_each
    each = f", from each of the nodes {', '.join(map(str, nodes))} in this order" if nodes else ""
    if command.reply is None:
        return "There is no reply."
    if command.is_echoed:
        return f"The reply is the request, sent back{each}."
    if isinstance(command.replies[0], OtherReply):
        return f"The reply is that of {command.reply.command}{each}."
    return f"One reply{each}." if each else ""


def _effects(names: Names, edition: Edition) -> list[MacroView]:
    digits = 16 if len(edition.effects) > 32 else 8
    return [
        MacroView(names.upper("effect", e.name), _mask(1 << i, digits), f"{english(e.title)}.")
        for i, e in enumerate(edition.effects)
    ]


def _mask(value: int, digits: int) -> str:
    return f"UINT64_C(0x{value:016X})" if digits == 16 else f"0x{value:08X}u"


def _command_effects(names: Names, edition: Edition) -> list[EffectsView]:
    grouped: dict[str, list[str]] = {}
    for command in edition.commands:
        if command.effects:
            value = " | ".join(names.upper("effect", effect.name) for effect in command.effects)
            grouped.setdefault(value, []).append(names.command(command.name))
    return [EffectsView(tuple(commands), value) for value, commands in grouped.items()]


def _availability(names: Names, edition: Edition) -> list[AvailabilityView]:
    grouped: dict[str, list[str]] = {}
    for command in edition.commands:
        if command.only:
            lacking = [f"{parameter} != {value}" for parameter, value in _lacking(names, edition, command)]
            if lacking:
                grouped.setdefault(joined("&&", lacking), []).append(names.command(command.name))
    return [AvailabilityView(tuple(commands), condition) for condition, commands in grouped.items()]


def _lacking(names: Names, edition: Edition, command: Command) -> Iterator[tuple[str, str]]:
    """The parameters and the values of them under which a node does not have a command."""
    for name, values in command.only.items():
        for value in edition.parameter(name).values:
            if value.name not in values:
                yield parameter_access(name), names.upper(name, value.name)


def _direction(
    names: Names, edition: Edition, messages: Messages, direction: Direction, views: Mapping[Layout, LayoutView]
) -> DirectionView:
    contents: dict[Layout, list[ContentView]] = {}
    for message in edition.messages(direction):
        if views[message.layout].members or views[message.layout].depends:
            enumerator = names.command(message.command)
            content = ContentView(enumerator, member(names.short(message.command)), f"With {enumerator}.")
            contents.setdefault(message.layout, []).append(content)
    some = {layout: ContentsView(views[layout], tuple(commands)) for layout, commands in contents.items()}
    unpack = {layout: _unpack(direction, content) for layout, content in some.items()}
    return DirectionView(
        word=direction.value,
        identify=tuple(routes(names, edition, messages, direction, {})),
        decode=tuple(routes(names, edition, messages, direction, unpack)),
        contents=tuple(some.values()),
        without_node=tuple(names.command(m.command) for m in edition.messages(direction) if not m.id.nodes),
        checks_availability=direction is Direction.REQUEST and bool(_availability(names, edition)),
        without_fields=any(not views[m.layout].members for m in edition.messages(direction)),
    )


def _all_bytes(layout: LayoutView) -> frozenset[int]:
    """The bytes of a struct without padding."""
    return frozenset(itertools.chain(*(place.bytes for place in layout.places)))


def _unpack(direction: Direction, content: ContentsView) -> UnpackView:
    layout = content.layout
    given = [f"&{direction.value}->as.{content.member}"] if layout.members else []
    given += ["frame", *(["parameters"] if layout.depends else [])]
    return UnpackView(f"{layout.name}_unpack({', '.join(given)})", layout.depends)
