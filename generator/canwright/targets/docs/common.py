"""Content of the pages of an edition that is the same in every language, computed once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ...compare import Change, compare
from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrames
from ...model.layout import Field, Layout, Variant
from ...model.message import Command, Direction, Message
from ...model.metadata import Mode
from ...templating.markup import code, markdown
from ..base import WorkedExchange
from ..examples import Examples
from ..registry import own_targets, targets
from .examples import Worked, worked
from .picture import Drawing, Drawings
from .tables import Cells, code_of, field_cells, index, key_cells


class Drawn(NamedTuple):
    """A picture, its file, and the parameter values it is valid for if there are several pictures."""

    file: str
    drawing: Drawing
    only: str


class Side(NamedTuple):
    """One direction of a command that has a message; texts are Markdown."""

    message: Message
    keys: Sequence[Cells]
    fields: Sequence[tuple[Field, Sequence[Cells]]]
    id: str
    nodes: str
    """The range of nodes; empty if the id is fixed."""
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
        self._fields: dict[Layout, Sequence[tuple[Field, Sequence[Cells]]]] = {}
        """Rows by layout: many messages share one."""
        self._since: dict[Edition, Sequence[Change]] = {}
        self.sheets = list(self._sheets())

    def since(self, old: Edition) -> Sequence[Change]:
        """Changes since an older edition."""
        if old not in self._since:
            self._since[old] = compare(old, self.edition, own_targets())
        return self._since[old]

    def _sheets(self) -> Iterator[Sheet]:
        groups = list(self.edition.groups.values())
        for previous, group, following in zip((None, *groups), groups, (*groups[1:], None), strict=False):
            first, entry = group[0], group[0].entry
            chosen = [self._examples.select(command) for command in group]
            exchange = next((selection.exchange for selection in chosen if selection.exchange), None)
            errata = list(dict.fromkeys(erratum for command in group for erratum in self._errata[command.name]))
            only = first.only if all(command.only == first.only for command in group) else {}
            view = {
                "command": first,
                "code": ", ".join(dict.fromkeys(code_of(command) for command in group if command.code is not None)),
                "manual": markdown(first.manual),
                "table": self.edition.table(entry.table) if entry else None,
                "only": only,
                "mode": self._modes.get(first.mode),
                "effects": [e for e in first.effects if all(e in command.effects for command in group)],
                "previous": previous[0] if previous else None,
                "following": following[0] if following else None,
                "errata": errata,
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
        if layout not in self._fields:
            self._fields[layout] = [(field, field_cells(field)) for field in layout.fields]
        drawn = list(self._drawn(command, message))
        request = command.request if direction is Direction.REPLY else None
        is_repeated = request is not None and (
            command.is_echoed
            or (layout is request.layout and (message.keys, message.accepted_codes) == (request.keys, ()))
        )
        nodes = message.id.nodes
        return Side(
            message,
            tuple(map(key_cells, message.keys)),
            self._fields[layout],
            code(formatting.id_rule(message.id)),
            code(f"{nodes[0]}..{nodes[-1]}") if nodes is not None else "",
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


def _can_be(command: Command, layout: Layout, variant: Variant) -> bool:
    allowed = command.only.get(layout.parameter or "", variant.values)
    return not variant.values or not set(variant.values).isdisjoint(allowed)
