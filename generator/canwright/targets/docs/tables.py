"""Byte tables and type tables: everything that a reader or a parser needs to decode a frame."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol

from ...model import formatting
from ...model.deprecation import Deprecation
from ...model.edition import Edition
from ...model.layout import Field, Layout, Space
from ...model.message import (
    Command,
    Direction,
    EchoReply,
    KeyRole,
    Message,
    OtherReply,
    OwnReply,
    SharedReply,
)
from ...model.types import Encoding, Linear, Member, Range, Text, Type
from ...semantics.frame import sent_id_rule
from ...semantics.plan import message_plan
from ...templating.markup import code, markdown
from ..availability import is_available, values_of
from ..field_contents import Content, contents
from .links import command_link, field_anchor

Labels = Mapping[str, str]
_FORM_LABELS = {EchoReply: "echo", OwnReply: "own", SharedReply: "layout", OtherReply: "other"}
_KEY_LABELS = {KeyRole.CODE: "selector", KeyRole.INDEX: "selector_of_entry", KeyRole.CONSTANT: "constant"}
_CONTENT_LABELS = {"constant": "constant", "reserved": "sent_so"}
MAX_MEMBERS = 8
"""Most members or commands shown in a row; the page of types has all members with their titles."""


class Titled(Protocol):
    """An object with texts."""

    @property
    def title(self) -> Text: ...
    @property
    def about(self) -> Text: ...


class Row(NamedTuple):
    """One row of a byte table, its cells in Markdown."""

    place: str
    field: str
    raw: str
    """The raw format, and the range of the raw integer or the constant on further lines."""
    scale: str
    value_range: str
    only: str
    what: str


def code_of(command: Command) -> str:
    """The code of a command, or a check mark if it has none."""
    return f"0x{command.code:02X}" if command.code is not None else "✓"


def codes(command: Command) -> Sequence[str]:
    """The code of a command; without one, the ids of its messages that no node is part of, unless nodes are asked by id."""
    if command.code is not None:
        return [code_of(command)]
    if command.request and command.request.id.nodes is not None:
        return []
    messages = [message for message in map(command.message, Direction) if message is not None]
    return sorted({formatting.id_rule(m.id) for m in messages if m.id.nodes is None and not m.id_mask})


def index(message: Message | None) -> str:
    """The bytes that identify the entry: `0x05 0x0A`."""
    return " ".join(f"0x{key.value:02X}" for key in message.keys if key.role is KeyRole.INDEX) if message else ""


def key_rows(message: Message, command: Command, labels: Labels) -> Iterator[Row]:
    """The rows of the keys of a frame."""
    for i, key in enumerate(message.keys):
        place = formatting.key_place(key)
        note = labels[_KEY_LABELS[key.role] if command.entry or key.role is not KeyRole.INDEX else "selector"]
        if i == 0 and message.accepted_codes:
            accepted = ", ".join(code(f"0x{value:02X}") for value in message.accepted_codes)
            note += f"{labels['and']}{labels['accepted']} {accepted}"
        raw = f"{code(place.raw)}<br>{code(formatting.constant(key.value))}"
        yield Row(code(place.position), "", raw, "", "", "", note)


def field_rows(message: Message, command: Command, labels: Labels, language: str) -> Iterator[Row]:
    """The rows of the fields that a command has, in the order of the spec; an array has one for each element."""
    layout, holds = message.layout, labels["holds_low_bits" if message.has_low_bits_of_node else "holds_node"]
    fixed = contents(message)
    for field in layout.fields:
        if is_available(layout, field, command):
            content = fixed.get(field)
            resolution, raw, values = _numbers(field, content, layout, command, labels)
            what = (
                description(field, labels, language)
                + (f" ({deprecation(field.deprecated, labels)})" if field.deprecated else "")
                + (f"{labels['and']}{holds}" if field.is_node else "")
                + _computed(field, content, labels)
                + (f"{labels['stop']}{labels['variable']} {code(field.variable)}" if field.variable else "")
            )
            link = f"[%s](../types.md#types.{field.type.name})" if field.type.path[0] == "types" else "%s"
            only = code(f"{layout.parameter} {', '.join(field.only)}") if field.only else ""
            anchor = f'<a id="{field_anchor(command, message.direction, field)}"></a>'
            places = formatting.field_places(field)
            for place, manual_name in zip(places, _manual_names(field, len(places)), strict=True):
                formats = "<br>".join(filter(None, (code(place.raw), raw)))
                yield Row(
                    anchor + code(place.position),
                    link % code(place.name),
                    formats,
                    resolution,
                    values,
                    only,
                    what + _in_manual(field, manual_name, layout, command, labels) + _members(field.type, labels),
                )
                anchor = ""


def description(thing: Titled, labels: Labels, language: str) -> str:
    """Title and description of an object, in Markdown."""
    about = thing.about[language]
    return markdown(thing.title[language] + (labels["stop"] + about if about else ""))


def deprecation(deprecated: Deprecation, labels: Labels) -> str:
    """`Deprecated: since v2, until v3`."""
    period = labels["deprecated_until" if deprecated.until else "deprecated_since"]
    return labels["deprecated"] + labels["colon"] + period.format(since=deprecated.since, until=deprecated.until)


def _computed(field: Field, content: Content | None, labels: Labels) -> str:
    """How the sender computes a counter or a checksum; empty for another field."""
    if field.counter:
        return f"{labels['stop']}{labels['counter'].format(first=field.counter.first, last=field.counter.last)}"
    if content and content.kind == "checksum":
        return f"{labels['stop']}{labels['checksum']} {code(str(content.written))}"
    return ""


def _members(type_: Type, labels: Labels) -> str:
    """The names of values or bits if there are few: `0` `on` · `16` `off`."""
    without = ""
    if type_.no_values:
        named = " · ".join(f"{code(formatting.no_value(n))} {code(n.name)}" for n in type_.no_values[:MAX_MEMBERS])
        without = f"<br>{labels['no_value']}{labels['colon']}{named}"
    members = type_.enum or type_.flags or type_.names
    if not members or len(members) > MAX_MEMBERS:
        return without
    listed = " · ".join(f"{code(member_value(type_, member))} {code(member.name)}" for member in members)
    label = labels["bits"] if type_.flags else labels["named"] + labels["colon"] if type_.names else ""
    return f"{without}<br>{label}{listed}"


def member_value(type_: Type, member: Member) -> str:
    """The value of a member; of a named value in hexadecimal, as manuals print bytes, where one has several digits."""
    values = [named.value for named in type_.enum]
    is_byte = bool(values) and min(values) >= 0 and 9 < max(values) <= 0xFF
    return f"0x{member.value:02X}" if is_byte else str(member.value)


def _manual_names(field: Field, count: int) -> Sequence[str]:
    """The name in the manual of each element of a field; the same for all if the manual does not name each."""
    names = field.manual_name.split(", ")
    return names if len(names) == count else [field.manual_name] * count


def _in_manual(field: Field, manual_name: str, layout: Layout, command: Command, labels: Labels) -> str:
    """The name of a field in the manual, and the section if it differs from that of its layout and command."""
    known = ("", layout.manual, command.manual, command.entry.manual if command.entry else "")
    cited = formatting.cited("" if field.manual in known else field.manual, manual_name)
    return f" ({labels['manual']} {markdown(cited)})" if cited else ""


def _numbers(
    field: Field, content: Content | None, layout: Layout, command: Command, labels: Labels
) -> tuple[str, str, str]:
    """The resolution of a field, its raw range or content, and the range of its value."""
    if content is None:
        among = values_of(field.type.linear.parameter or "", layout, field, command)
        return scale(field.type, labels, among), raw_range(field.type), value_range(field.type, among)
    if content.kind == "checksum":
        return "", "", ""
    written = content.written if isinstance(content.written, str) else formatting.constant(content.written)
    return "", code(written), labels[_CONTENT_LABELS[content.kind]]


def cases(pairs: Sequence[tuple[str, str]]) -> str:
    """`A: 16.5/2048 V`, one line for each case."""
    return "<br>".join(f"{names}: {code(text)}" if names else code(text) for names, text in pairs)


def scale(type_: Type, labels: Labels, among: tuple[str, ...] = ()) -> str:
    """The exact resolution, with the offset."""
    if not type_.is_number:
        return ""
    scales = formatting.scale(type_, among, labels["offset"])
    return "<br>".join(
        (f"{names}: " if names else "") + (labels["not_given"] if text == "not given" else code(text))
        for names, text in scales
        if text
    )


def raw_range(type_: Type) -> str:
    """The exact raw range; empty for a float, whose range is that of its value."""
    return "" if type_.encoding is Encoding.FLOAT else cases(formatting.ranges(type_))


@functools.lru_cache(maxsize=1 << 12)
def value_range(type_: Type, among: tuple[str, ...] = ()) -> str:
    """The range in the unit; empty if scale or range is not known."""
    unit = f" {type_.unit.symbol}" if type_.unit else ""
    if type_.encoding is Encoding.FLOAT:
        return cases([(names, limits + unit) for names, limits in formatting.ranges(type_)])

    def shown(linear: Linear | None, limits: Range | None) -> str:
        if linear is None or limits is None or not type_.is_number:
            return ""
        return formatting.span(formatting.in_unit(limits, linear)) + unit

    ranges = type_.linear.combined(type_.raw_range, shown).named
    return cases([(name, text) for name, text in ranges if text and (not name or not among or name in among)])


def facts(message: Message, labels: Labels) -> Iterator[tuple[str, str]]:
    """Id, nodes and frame of a message."""
    nodes = message.id.nodes
    yield labels["id"], code(formatting.id_rule(message.id))
    sent = message_plan(message).sent
    varies = any(field.space is Space.ID and field not in sent for field in message.layout.fields)
    if sent_id_rule(message) != message.id and not varies:
        yield labels["sent_id"], code(formatting.id_rule(sent_id_rule(message)))
    if nodes is not None:
        yield labels["nodes"], code(f"{nodes[0]}..{nodes[-1]}")
    kind = labels["extended" if message.id.extended else "standard"]
    frame = labels["remote_frame" if message.remote else "data_frame"]
    yield labels["frame"], labels["comma"].join((kind, frame, f"`{message.dlc}` {labels['data_bytes']}"))
    if message.sending is not None:
        words = formatting.words_of(formatting.SendingWords, labels, "sending")
        yield labels["sent"], formatting.sending(message.sending, words)
    if message.sequence is not None:
        first, last = message.sequence.numbers[0], message.sequence.numbers[-1]
        yield labels["frames"], labels["frame_numbers"].format(code(message.sequence.field), code(f"{first}..{last}"))


def reply_form(edition: Edition, command: Command, labels: Labels, commands: str) -> str:
    """The form of the reply with its shared layout or the linked command; `commands` is the folder of the link."""
    form = labels[_form_label(command)]
    for reply in command.replies[:1]:
        if isinstance(reply, OtherReply):
            return f"{form} {_link(edition, reply, commands)}"
        if isinstance(reply, SharedReply):
            return f"{form} {code(reply.message.layout.name)}"
    return form


def _link(edition: Edition, reply: OtherReply, commands: str) -> str:
    return f"[{markdown(reply.of)}]({commands}{command_link(edition, reply.of)})"


def _form_label(command: Command) -> str:
    return _FORM_LABELS[type(command.replies[0])] if command.replies else "none"


@functools.lru_cache(maxsize=1 << 8)
def _repliers(edition: Edition, layout: Layout) -> Sequence[Command]:
    """The commands of the replies with a layout."""
    return [edition.command(m.command) for m in edition.of_layout(layout) if m.direction is Direction.REPLY]


def _sharers(edition: Edition, layout: Layout, command: Command, labels: Labels) -> str:
    """Which other replies have a layout: those of `0x9C`, `0xA0` to `0xA8`, by name where a code is not enough."""
    sharers = [sharer for sharer in _repliers(edition, layout) if sharer is not command]
    names = dict.fromkeys(sharer.name for sharer in sharers if sharer.code is None or sharer.entry)
    codes = {sharer.code for sharer in sharers if sharer.code is not None and not sharer.entry}
    runs = [run.partition("..") for run in formatting.numbers(sorted(codes)).split(", ")] if codes else []
    listed = [labels["through"].join(code(f"0x{int(end):02X}") for end in (low, high) if end) for low, _, high in runs]
    shown = (*listed, *map(code, names))
    if not shown:
        return labels["means_own"]
    if len(shown) > MAX_MEMBERS:
        return labels["means_many"].format(len(codes) + len(names))
    return labels["means_layout"].format(labels["listed"].join(shown))


def reply_facts(edition: Edition, command: Command, labels: Labels) -> Iterator[tuple[str, str]]:
    """Form and senders of the reply."""
    form = labels[f"means_{_form_label(command)}"]
    for reply in command.replies[:1]:
        if isinstance(reply, OtherReply):
            form = form.format(_link(edition, reply, ""))
        elif isinstance(reply, SharedReply):
            form = _sharers(edition, reply.message.layout, command, labels)
    yield labels["form"], form
    if command.from_each:
        yield labels["from_each"], code(", ".join(map(str, command.from_each)))
    links_to = {"further_replies": command.further_replies, "alternative_replies": command.alternative_replies}
    for label, replies in links_to.items():
        links = [_link(edition, reply, "") for reply in replies if isinstance(reply, OtherReply)]
        if links:
            yield labels[label], labels["comma"].join(links)
