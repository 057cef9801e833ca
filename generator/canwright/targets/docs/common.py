"""Content of the pages of an edition that is the same in every language, computed once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from ...compare import Change, compare
from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, GoldenFrames, Value
from ...model.layout import Field, Layout, Variant
from ...model.message import Command, Direction, Message
from ...model.metadata import Consent, EndsMotion, Mode
from ...templating.markup import code, markdown
from ..availability import is_available
from ..base import WorkedExchange
from ..examples import Examples
from ..registry import own_targets, targets
from .editions import affecting
from .links import COMMANDS, explorer_link, field_anchor
from .picture import Drawing, Drawings
from .tables import code_of, codes, index

MANY = 4
"""An erratum of more commands than these, as of a type that many have, is only a link on their pages."""


class Worked(NamedTuple):
    """A golden frame and its meaning in Markdown, without a language: `means % labels` is the meaning."""

    golden: GoldenFrame
    frame: str
    given: str
    means: str

    def origin(self, labels: Mapping[str, str], sources: Mapping[str, str], language: str) -> str:
        """The source in a language, in Markdown; `sources` are texts in that language, by name."""
        remarks = [labels["section"].format(self.golden.manual)] if self.golden.manual else []
        remarks += filter(None, [self.golden.note.get(language)])
        source = markdown(sources[self.golden.source].rstrip(".。"))
        return source + (labels["remark"].format(markdown(labels["and"].join(remarks))) if remarks else "")


def worked(edition: str, frame: GoldenFrame, message: Message) -> Worked:
    """A golden frame of a message with its meaning."""
    units = {f.name: f" {f.type.unit.symbol}" for f in message.layout.fields if f.type.unit}
    return Worked(
        frame,
        f"[`{formatting.sent(frame)}`]({explorer_link(edition, frame, message)})",
        ", ".join(code(f"{name} = {value}") for name, value in formatting.parameter_values(frame.parameters).items()),
        "<br>".join(_meanings(frame, units)) or "%(none)s",
    )


def sources(golden: GoldenFrames, language: str) -> Mapping[str, str]:
    """Texts of the sources in one language, by name; a plain text is for all languages."""
    return {
        name: source if isinstance(source, str) else source.get(language, "") for name, source in golden.sources.items()
    }


def _meanings(frame: GoldenFrame, units: Mapping[str, str]) -> Iterator[str]:
    """The node and each field with its value; labels are inserted later by `%`."""
    if frame.node is not None:
        yield code(f"node = {frame.node}")
    for name, raw in frame.raw.items():
        value = frame.values.get(name)
        if value is None:
            yield code(f"{name}: raw {_list(raw)}")
        elif value == "none":
            yield f"{code(f'{name}: raw {_list(raw)}')}, %(raw_only)s"
        else:
            shown = _value(value, units.get(name, "")).replace("%", "%%") or "%(none)s"
            yield code(f"{name} = {shown}") + _raw(raw, value)


def _raw(raw: int | list[int], value: Value) -> str:
    return "" if raw == value else f" ({code(f'raw {_list(raw)}')})"


def _value(value: Value, unit: str) -> str:
    if isinstance(value, list):
        return ", ".join(_value(v, "") for v in value) + unit
    return formatting.decimal(value) + unit if isinstance(value, Fraction) else value


def _list(raw: int | list[int]) -> str:
    return ", ".join(map(str, raw)) if isinstance(raw, list) else str(raw)


class Drawn(NamedTuple):
    """A picture, its file, and the parameter values it is valid for if there are several pictures."""

    file: str
    drawing: Drawing
    only: str


class Side(NamedTuple):
    """One direction of a command that has a message; texts are Markdown."""

    message: Message
    is_rest: bool
    """Whether the message has no selector while other messages on its ids have one."""
    is_repeated: bool
    """Whether the message is a reply with the bytes of its request, which has the byte table and the pictures."""
    has_free_bits: bool
    """Whether a data bit belongs to no key and, for a parameter value that has the command, to no field."""
    drawn: Sequence[Drawn]
    examples: Sequence[Worked]


class Form(NamedTuple):
    """A command, or one entry of a command with a table."""

    command: Command
    key: str
    """The bytes that identify the entry, in Markdown; empty without an entry."""
    sides: Sequence[tuple[Direction, Side | None]]


class Program(NamedTuple):
    """The program of a target for a command; `text` is not Markdown."""

    title: str
    language: str
    text: str
    essence: str


class Sheet(NamedTuple):
    """The page of a command with all its forms, one for each entry; and the variables of its template."""

    name: str
    forms: Sequence[Form]
    exchange: WorkedExchange | None
    programs: Sequence[Program]
    """Programs for the exchange."""
    view: Mapping[str, Any]


class Since(NamedTuple):
    """The changes since an older edition: all, and those that affect each command, by its name in the spec."""

    changes: Sequence[Change]
    by_command: Mapping[str, Sequence[Change]]


class Common:
    """Computes everything before the first page is written: that is faster than between pages."""

    def __init__(self, edition: Edition, golden: GoldenFrames | None) -> None:
        self.edition = edition
        self.golden = golden
        self.touched: dict[str, list[str]] = {}
        """Names of the commands that each erratum affects."""
        self._errata = {command.name: edition.errata_of(command) for command in edition.commands}
        for name, errata in self._errata.items():
            for erratum in errata:
                self.touched.setdefault(erratum.id, []).append(name)
        self._drawings = Drawings()
        self._examples = Examples(edition, golden)
        self._modes: Mapping[str | None, Mode] = {mode.name: mode for mode in edition.bus.modes}
        self._since: dict[Edition, Since] = {}
        self.sheets = list(self._sheets())
        self.uses = self._uses()
        """Links to the rows of fields from the page of types, by the name of the type, and by field and direction."""

    def _uses(self) -> Mapping[str, Mapping[tuple[str, Direction], Sequence[str]]]:
        uses: dict[str, dict[tuple[str, Direction], list[str]]] = {}
        forms = [form for sheet in self.sheets for form in sheet.forms]
        sides = [(form, direction, side) for form in forms for direction, side in form.sides]
        shown = [(form, direction, side.message) for form, direction, side in sides if side and not side.is_repeated]
        for form, direction, message in shown:
            for field in message.layout.fields:
                if field.type.path[0] == "types" and is_available(message.layout, field, form.command):
                    links = uses.setdefault(field.type.name, {}).setdefault((field.name, direction), [])
                    links.append(self._row_link(form, direction, field))
        return uses

    def _row_link(self, form: Form, direction: Direction, field: Field) -> str:
        command = form.command
        title = command.spec_name if command.code is None else " ".join(filter(None, (code_of(command), form.key)))
        return f"[{title}]({COMMANDS}{command.spec_name}.md#{field_anchor(command, direction, field)})"

    def since(self, old: Edition) -> Since:
        """The changes since an older edition."""
        if old not in self._since:
            changes = compare(old, self.edition, own_targets())
            by_command = {name: affecting(changes, commands) for name, commands in self.edition.groups.items()}
            self._since[old] = Since(changes, by_command)
        return self._since[old]

    def _sheets(self) -> Iterator[Sheet]:
        groups = list(self.edition.groups.values())
        stops = [command for command in self.edition.commands if command.ends_motion is EndsMotion.STOP]
        for previous, group, following in zip((None, *groups), groups, (*groups[1:], None), strict=False):
            first, entry = group[0], group[0].entry
            chosen = [self._examples.select(command) for command in group]
            exchange = next((selection.exchange for selection in chosen if selection.exchange), None)
            errata = list(dict.fromkeys(erratum for command in group for erratum in self._errata[command.name]))
            only = first.only if all(command.only == first.only for command in group) else {}
            view = {
                "command": first,
                "codes": ", ".join(dict.fromkeys(code for command in group for code in codes(command))),
                "code": ", ".join(dict.fromkeys(code_of(command) for command in group if command.code is not None)),
                "manual": markdown(first.manual),
                "table": self.edition.table(entry.table) if entry else None,
                "only": only,
                "mode": self._modes.get(first.mode),
                "effects": [e for e in first.effects if all(e in command.effects for command in group)],
                "previous": previous[0] if previous else None,
                "following": following[0] if following else None,
                "errata": [e for e in errata if len(self.touched[e.id]) <= MANY],
                "errata_of_many": [e for e in errata if len(self.touched[e.id]) > MANY],
                "shared_errata": [e.id for e in errata if not {*self.touched[e.id]} <= {c.name for c in group}],
                "stops": [s for s in stops if s.mode == first.mode] if _moves(first) and not first.ends_motion else [],
            }
            forms = [
                Form(
                    command,
                    code(index(command.request or command.reply)),
                    [
                        (Direction.REQUEST, self._side(command, Direction.REQUEST, selection.requests)),
                        (Direction.REPLY, self._side(command, Direction.REPLY, selection.replies)),
                    ],
                )
                for command, selection in zip(group, chosen, strict=True)
            ]
            yield Sheet(first.spec_name, forms, exchange, list(self._programs(exchange)), view)

    def _programs(self, exchange: WorkedExchange | None) -> Iterator[Program]:
        for target in targets() if exchange else ():
            made = target.example(self.edition, exchange) if exchange else None
            if made is not None:
                yield Program(target.title, made.language, made.text, made.essence)

    def _side(self, command: Command, direction: Direction, frames: Sequence[Any]) -> Side | None:
        """One direction of a command; None if the command has no frame in that direction."""
        message = command.message(direction)
        if message is None:
            return None
        layout = message.layout
        drawn = list(self._drawn(command, message))
        request = command.request if direction is Direction.REPLY else None
        is_repeated = request is not None and (
            command.is_echoed
            or (layout is request.layout and (message.keys, message.accepted_codes) == (request.keys, ()))
        )
        return Side(
            message,
            not message.keys and self._has_selector_beside(message),
            is_repeated,
            not message.remote and any(picture.drawing.has_free_bits for picture in drawn),
            [] if is_repeated else [picture for picture in drawn if picture.drawing.has_fields],
            [worked(self.edition.name, frame, message) for frame in frames],
        )

    def _has_selector_beside(self, message: Message) -> bool:
        same = self.edition.of_rule(message.direction, message.id)
        return any(sibling.keys and sibling.remote == message.remote for sibling in same)

    def _drawn(self, command: Command, message: Message) -> Iterator[Drawn]:
        variants = [v for v in message.layout.variants if _can_be(command, message.layout, v)]
        for variant in variants:
            several = len(variants) > 1
            suffix = "-" + "-".join(variant.values) if several else ""
            only = f"{message.layout.parameter} {', '.join(variant.values)}" if several else ""
            file = f"{command.name}-{message.direction.value}{suffix}.svg"
            yield Drawn(file, self._drawings.drawing(message, variant), only)


def _moves(command: Command) -> bool:
    """Whether a command needs the consent for motion."""
    return any(effect.consent is Consent.MOTION for effect in command.effects)


def _can_be(command: Command, layout: Layout, variant: Variant) -> bool:
    allowed = command.only.get(layout.parameter or "", variant.values)
    return not variant.values or not set(variant.values).isdisjoint(allowed)
