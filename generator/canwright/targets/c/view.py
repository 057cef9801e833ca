"""The view of an edition for the template of its header."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from functools import cached_property, lru_cache

from ...model import formatting
from ...model.edition import Edition
from ...model.formatting import english
from ...model.message import Command, Direction, OtherReply
from ...model.metadata import Level
from ...semantics.dispatch import dispatch_plan
from ...semantics.exchange import exchange_plans
from ..base import header
from .choices import lacks
from .dispatch import RouteView, answers, grouped
from .expressions import UINT32, UINT64, call, joined
from .layouts import LayoutView
from .messages import Messages, MessageView
from .names import Names, layouts
from .text import MacroView, errata, heading, in_manual, literal, with_deprecation
from .types import TypeView


class CommandView:
    """A command with the messages that are defined in it."""

    def __init__(self, messages: Messages, command: Command) -> None:
        names = messages.names
        own = [message for message in command.messages if message.command == command.name]
        code = names.upper(command.name, "code"), f"0x{command.code or 0:02X}u", "Identifies the command in a frame."
        self.name, self.enumerator = command.name, names.command(command.name)
        self.number = f"0x{messages.numbers[command.name]:02X}"
        self.heading = heading(command)
        self.doc = _command_doc(messages.edition, command)
        self.constants = [] if command.code is None else [MacroView(*code)]
        self.constants += [macro for message in own for macro in names.facts(message)]
        self.messages = [messages.message(message) for message in own]


class DirectionView:
    """Any message of one direction."""

    def __init__(self, messages: Messages, direction: Direction) -> None:
        sent = [messages.message(message) for message in messages.edition.messages(direction)]
        self.contents: dict[LayoutView, list[MessageView]] = {}
        for message in sent:
            if message.layout.members or message.layout.depends:
                self.contents.setdefault(message.layout, []).append(message)
        plan = dispatch_plan(messages.edition, direction)
        self.word = direction.value
        self.identify = [RouteView(messages, route, {}) for route in plan.routes]
        self.decode = [RouteView(messages, route, self.contents) for route in plan.routes]
        """The routes of the dispatch plan, in the order in which they are tried."""
        self.without_node = [message.enumerator for message in sent if not message.pattern.rule.has_nodes]
        """The commands whose id contains no node."""
        self.has_nodes = any(route.rule.has_nodes for route in self.decode)
        self.members = [m for layout, listed in self.contents.items() if layout.members for m in listed]
        """The members of the union."""
        self.without_fields = any(not message.layout.members for message in sent)
        """True if some commands have no fields."""
        self.checks_availability = any(message.lacking for message in sent)
        self.identify_parameters = any(route.rule.whole for route in self.decode)
        """Whether ids contain a parameter."""
        self.unpacking_fails = any(layout.depends for layout in self.contents)
        """Whether reading fields needs the parameters."""
        self.depends = self.identify_parameters or self.unpacking_fails
        """Whether decoding needs the parameters."""
        self.show_parameters = self.depends or any(x.has_values and x.show_parameters for x in self.contents)
        self.check_parameters = self.checks_availability or any(x.check_parameters for x in self.contents)

    @cached_property
    def cleared(self) -> list[str]:
        """Fields of the union that cover all its bytes that some commands do not write: few and large ones, in their order."""
        first = {layout: listed[0].member for layout, listed in self.contents.items() if layout.members}
        everywhere = [frozenset(itertools.chain(*(place.bytes for place in layout.places))) for layout in first]
        everywhere += [frozenset[int]()] if self.without_fields else []
        missing = frozenset[int]().union(*everywhere).difference(frozenset.intersection(*everywhere))
        fields = {place.bytes: f"{name}.{place.name}" for layout, name in first.items() for place in layout.places}
        times = Counter(itertools.chain(*fields))
        for covered in sorted(fields, key=len):
            if all(times[byte] > 1 for byte in missing & covered):
                times.subtract(covered)
                del fields[covered]
        return [fields[covered] for covered in sorted(fields, key=max)]

    def print(self, e: EditionView, frame: str) -> str:
        """The call that prints a frame into the array `text`."""
        parameters = "&parameters" if self.show_parameters else ""
        return call(f"{e.prefix}print_{self.word}", "text", "sizeof text", frame, parameters)


class EditionView:
    """The content of a header. `spec` is the start of the hash of its spec; every name has `prefix` or `PREFIX`."""

    def __init__(self, edition: Edition) -> None:
        self.names = names = Names(edition)
        used = layouts(edition)
        self.header = header(edition)
        self.spec = edition.hash[:8]
        self.prefix, self.PREFIX = names.lower(""), names.upper("")
        self.family, self.file = edition.family, edition.identifier
        self.title = english(edition.title)
        manual = english(edition.manual)
        sections = f"Numbers in brackets are sections of: {manual}." if manual else ""
        self.doc = [text for text in (english(edition.about), sections) if text]
        self.facts = list(_facts(names, edition))
        self.parameters = edition.parameters
        types = {field.type for layout in used for field in layout.fields}
        self.of_type = {type_: TypeView(names, edition, type_) for type_ in edition.types if type_ in types}
        """The types that fields use, in spec order."""
        self.types = list(self.of_type.values())
        self.fields = [
            (names.upper("field", name), name)
            for name in dict.fromkeys(f.name for layout in used for f in layout.given)
        ]
        """The enumerator of each field, with its name."""
        self.has_joined = any(view.joined for view in self.types)
        views = {layout: LayoutView(names, edition, layout, self.of_type) for layout in used}
        self.layouts = [views[layout] for layout in used if layout.shared]
        crcs = (view.checksum.crc for view in views.values() if view.checksum)
        self.crcs = list({crc.name: crc for crc in crcs if crc}.values())
        messages = Messages(names, edition, views)
        self.message = messages.message
        self.fd = messages.fd
        self.frame = f"canwright_{self.fd}frame_t"
        self.frame_header = "canwright_fd.h" if self.fd else "canwright.h"
        self.most_data = f"CANWRIGHT_{self.fd.upper()}MAX_DATA"
        rate = " | CANWRIGHT_FD_BRS" if edition.bus.frame_format.switches_rate else ""
        self.frame_flags = f"CANWRIGHT_FD_FDF{rate}" if self.fd else ""
        self.addresses = messages.addresses
        self.commands = [CommandView(messages, command) for command in edition.commands]
        self.command_names = [(command.enumerator, command.name) for command in self.commands]
        self.effects_type = UINT64 if len(edition.effects) > 32 else UINT32
        self.effects = [
            MacroView(names.upper("effect", e.name), self.effects_type.bits(1 << i), f"{english(e.title)}.")
            for i, e in enumerate(edition.effects)
        ]
        self.command_effects = grouped(
            names,
            (
                (c, " | ".join(names.upper("effect", effect.name) for effect in c.effects))
                for c in edition.commands
                if c.effects
            ),
        )
        available = ((command, lacks(names, edition, command, "!=")) for command in edition.commands)
        self.availability = grouped(
            names, ((command, joined("&&", lacking)) for command, lacking in available if lacking)
        )
        """The commands that some nodes do not have, and the condition for one that has it."""
        self.directions = [DirectionView(messages, direction) for direction in Direction]
        self.answers = answers(messages)
        replies = (plan.reply for plans in exchange_plans(edition).values() for plan in plans)
        self.answers_use_from = any(reply.id.nodes is not None for reply in replies)
        """Whether the conditions of answers read the node that replies."""
        self.check_reply_parameters = any(direction.identify_parameters for direction in self.directions)
        """Whether the check of a reply needs the parameters: ids of messages with a reply contain them."""
        self.printed = list(dict.fromkeys(x for d in self.directions for x in d.contents if x.has_values))
        """The layouts that messages print."""
        self.parameters_argument = f"const {self.prefix}parameters_t *parameters"
        self.has_reply_time = edition.bus.reply_within_ms is not None


@lru_cache(maxsize=4)
def edition_view(edition: Edition) -> EditionView:
    """Everything that the templates of an edition print; cached, because examples on pages use it, too."""
    return EditionView(edition)


def _facts(names: Names, edition: Edition) -> Iterator[MacroView]:
    """What a device can report of the edition, and the time-out of replies."""
    yield MacroView(names.upper("edition"), literal(edition.name), "The name of the edition.")
    yield MacroView(
        names.upper("spec_hash"), literal(edition.hash), "The SHA-256 of what the spec means, in hexadecimal."
    )
    within = edition.bus.reply_within_ms
    if within is not None:
        rounded = "" if (within * 1000).denominator == 1 else ", rounded up"
        slow = f" It does not apply to {', '.join(edition.slow_replies)}." if edition.slow_replies else ""
        doc = f"Maximum time from request to reply, in microseconds{rounded}.{slow}"
        yield MacroView(names.upper("reply_within_us"), f"{math.ceil(within * 1000)}u", doc)


def _command_doc(edition: Edition, command: Command) -> list[str]:
    paragraphs = [english(command.about), with_deprecation("", command.deprecated)]
    if not command.implemented:
        paragraphs.append("The manual says that this is not implemented yet.")
    if command.reply_within_ms is not None:
        paragraphs.append(f"Maximum time from request to reply: {formatting.exact(command.reply_within_ms)} ms.")
    for message in command.messages:
        if message.command == command.name and message.sending is not None:
            paragraphs.append(f"Timing of the {message.direction.value}: {formatting.sending(message.sending)}.")
    if command.only:
        paragraphs.append(f"Only {formatting.condition(command.only)}.")
    for level in (Level.DANGER, Level.WARNING, Level.NOTE):
        titles = [formatting.effect(english(e.title), command, e) for e in command.effects if e.level is level]
        if titles:
            paragraphs.append(f"{level.value.capitalize()}: {'; '.join(titles)}.")
    for verb, settings in (("Limited by", command.limited_by), ("Not limited by", command.not_limited_by)):
        if settings:
            paragraphs.append(f"{verb}: {', '.join(english(s.title) for s in settings)}.")
    paragraphs += [_reply_doc(command), *in_manual(command.manual_name)]
    paragraphs += [english(note) for note in command.notes]
    return [text for text in (*paragraphs, *errata(edition, command.path)) if text]


def _reply_doc(command: Command) -> str:
    further = "; ".join(formatting.further_replies(command))
    return " ".join(filter(None, (_first_reply_doc(command), further and f"{further.capitalize()}.")))


def _first_reply_doc(command: Command) -> str:
    nodes = command.from_each
    each = f", from each of the nodes {', '.join(map(str, nodes))} in this order" if nodes else ""
    if command.reply is None:
        return "There is no reply."
    if command.is_echoed:
        return f"The reply is the request, sent back{each}."
    if isinstance(command.replies[0], OtherReply):
        return f"The reply is that of {command.reply.command}{each}."
    return f"One reply{each}." if each else ""
