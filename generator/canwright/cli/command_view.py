"""One command as a view for the terminal."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator, Sequence

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text as RichText

from ..diagnostics.diagnostic import nearest
from ..diagnostics.unicode_safety import visible
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field, Layout
from ..model.message import Command, EchoReply, IdRule, Message, OtherReply, SharedReply
from ..model.metadata import Consent, FrameFormat, Level, Repeat
from ..model.types import Type
from ..semantics.dispatch import node_of_id
from ..targets.field_contents import Content, contents

_STYLES = {Level.NOTE: "cyan", Level.WARNING: "yellow", Level.DANGER: "bold red"}


def find(editions: Sequence[Edition], wanted: str) -> tuple[list[tuple[Edition, Command]], str]:
    """The commands of this name, code or fixed CAN id in every edition, and a hint if there are none.

    The name of a command with a table finds all its forms.
    """
    try:
        number = int(wanted, 0)
    except ValueError:
        number = None
    pairs = [(edition, command) for edition in editions for command in edition.commands]
    matching = [
        (e, c) for e, c in pairs if wanted in (c.name, c.spec_name) or (number is not None and _has_number(c, number))
    ]
    return matching, (_rules_of(pairs, number) if number is not None else "") or nearest(
        wanted, dict.fromkeys(name for _, c in pairs for name in (c.name, c.spec_name))
    ) or "see `canwright show --help`"


def _has_number(command: Command, number: int) -> bool:
    """Whether a number is the code of a command, or the id of a frame that has the same id for all nodes."""
    fixed = (message for message in command.messages if message.id.nodes is None)
    return number == command.code or any(message.id.base == number & ~message.id_mask for message in fixed)


def _rules_of(pairs: Sequence[tuple[Edition, Command]], number: int) -> str:
    """A sentence about the addresses to which an id of one node belongs; empty without one."""
    messages = [message for _, command in pairs for message in command.messages]
    rules = {
        f"node {node} ({formatting.id_rule(m.id)})": None
        for m in messages
        if (node := node_of_id(m.id, number & ~m.id_mask)) is not None
    }
    return f"it is an id of {' or '.join(rules)}, which many commands have; give a code or a name" if rules else ""


def command_text(edition: Edition, command: Command, language: str) -> str:
    """A command for the terminal, in colour on one: description, effects and limits, frames, errata."""
    language = language if language in edition.languages else edition.languages[0]
    written = io.StringIO()
    console = Console(
        file=written,
        force_terminal=sys.stdout.isatty(),
        highlight=False,
        markup=False,
        emoji=False,
        legacy_windows=False,
    )
    console.print(Group(*_parts(edition, command, language)))
    return written.getvalue()


def _parts(edition: Edition, command: Command, language: str) -> Iterator[RenderableType]:
    head = RichText(command.name, "bold")
    if command.code is not None:
        head.append(f"  0x{command.code:02X}")
    head.append(f"  {visible(command.title[language])}")
    yield head
    cited = formatting.cited(command.manual, visible(command.manual_name))
    manual = f", manual {cited}" if cited else ""
    yield RichText(f"{edition.family} {edition.name}{manual}", "dim")
    if command.about[language]:
        yield Padding(RichText(command.about[language]), (1, 0, 0, 0))
    yield from _facts(command, language)
    for title, message in (("Request", command.request), ("Reply", command.reply)):
        note = "" if title == "Request" else _reply_form(command)
        yield Padding(RichText(f"{title}  {_frame(message, note, edition.bus.frame_format)}", "bold"), (1, 0, 0, 0))
        if message is not None:
            yield _table(command, message, language)
    for erratum in edition.errata_of(command):
        text = f"erratum {erratum.id}: {erratum.printed[language]} {erratum.used[language]}"
        yield Padding(RichText(text, "dim"), (1, 0, 0, 0))


def _facts(command: Command, language: str) -> Iterator[RichText]:
    if command.only:
        yield RichText(f"only {formatting.condition(command.only)}")
    if command.deprecated:
        yield RichText(f"deprecated {command.deprecated}", "yellow")
    if command.reply_within_ms is not None:
        yield RichText(f"replies within {formatting.exact(command.reply_within_ms)} ms")
    if not command.implemented:
        yield RichText("not implemented according to the manual", "yellow")
    for effect in command.effects:
        consent = "" if effect.consent is Consent.NONE else f"; consent: {effect.consent.value}"
        repeat = "; never repeated" if effect.repeat is Repeat.NEVER else ""
        kept = "" if effect.kept is None else f"; kept: {effect.kept.value}"
        text = formatting.effect(effect.title[language], command, effect)
        yield RichText(f"{text}{consent}{repeat}{kept}", _STYLES[effect.level])
    if command.repeat is not None:
        yield RichText(f"repeated after a missing reply: {command.repeat.value}")
    if command.ends_motion is not None:
        yield RichText(f"ends the motion of a node: {command.ends_motion.value.replace('_', ' ')}")
    if command.limited_by:
        yield RichText("limited by " + ", ".join(s.title[language] for s in command.limited_by))
    if command.not_limited_by:
        yield RichText("not limited by " + ", ".join(s.title[language] for s in command.not_limited_by))
    for note in command.notes:
        yield RichText(note[language])


def _reply_form(command: Command) -> str:
    form = ""
    for reply in command.replies[:1]:
        if isinstance(reply, EchoReply):
            form = "echo of the request"
        elif isinstance(reply, OtherReply):
            form = f"the reply of {reply.of}"
        elif isinstance(reply, SharedReply):
            form = f"the shared layout {reply.message.layout.name}"
    each = f"one from each of {', '.join(map(str, command.from_each))}, in this order" if command.from_each else ""
    return ", ".join(part for part in (form, each, *formatting.further_replies(command)) if part)


def _frame(message: Message | None, note: str, frame_format: FrameFormat) -> str:
    if message is None:
        return "none"
    keys = ", ".join(f"{formatting.place(k.space, k.segments)} = 0x{k.value:02X}" for k in message.keys)
    accept = "".join(f" or 0x{value:02X}" for value in message.accepted_codes)
    sending = formatting.sending(message.sending) if message.sending else ""
    numbers = formatting.frame_numbers(message.sequence) if message.sequence else ""
    parts = (
        f"id {id_rule(message.id)}",
        f"{message.dlc} bytes{' of CAN FD' if frame_format.is_fd else ''}",
        keys + accept,
        note,
        sending,
        numbers,
    )
    return ", ".join(part for part in parts if part)


def id_rule(rule: IdRule) -> str:
    """An id rule with its nodes: `0x100 + node (1..32)`."""
    if rule.nodes is None:
        return formatting.id_rule(rule)
    return f"{formatting.id_rule(rule)} ({rule.nodes[0]}..{rule.nodes[-1]})"


def _table(command: Command, message: Message, language: str) -> RenderableType:
    if not message.layout.fields:
        return RichText("  no fields; all other bytes are 0", "dim")
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for column in ("  position", "field", "raw", "1 LSB", "raw range", "title"):
        table.add_column(column)
    fixed = contents(message)
    for field in message.layout.fields:
        for name, segments in formatting.elements(field):
            table.add_row(
                "  " + formatting.place(field.space, segments, order=field.type.order),
                name + (f" ({', '.join(field.only)})" if field.only else ""),
                formatting.raw_format(field.type),
                *_meaning(field, fixed.get(field), _relevant(command, message.layout, field)),
                visible(field.title[language])
                + (f" ({visible(field.manual_name)})" if field.manual_name else "")
                + (f" (variable {field.variable})" if field.variable else "")
                + (f" (deprecated {field.deprecated})" if field.deprecated else ""),
            )
    return table


def _relevant(command: Command, layout: Layout, field: Field) -> tuple[str, ...]:
    """The parameter values under which command and field exist, of the parameter that the scale depends on."""
    parameter = field.type.linear.parameter
    if parameter is None:
        return ()
    here = field.only if layout.parameter == parameter else ()
    return here or command.only.get(parameter, ())


def _meaning(field: Field, content: Content | None, among: tuple[str, ...]) -> tuple[str, str]:
    if field.counter:
        return "counter", f"{field.counter.first}..{field.counter.last}"
    if content is None:
        return _values(field.type, among)
    if content.kind == "checksum":
        return f"checksum: {content.written}", ""
    return "reserved, sent as" if content.kind == "reserved" else content.kind, str(content.written)


def _values(type_: Type, among: tuple[str, ...]) -> tuple[str, str]:
    if type_.enum:
        return "\n".join(f"{m.value} {m.name}" for m in type_.enum), ""
    if type_.flags:
        return "\n".join(f"bit {m.value} {m.name}" for m in type_.flags), ""
    scale = formatting.with_cases(formatting.scale(type_, among), "\n")
    limits = [formatting.with_cases(formatting.ranges(type_), "\n")]
    limits += [f"{formatting.no_value(no_value)} {no_value.name}" for no_value in type_.no_values]
    limits += [f"{member.value} {member.name}" for member in type_.names]
    return scale, "\n".join(filter(None, limits))
