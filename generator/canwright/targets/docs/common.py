"""Content of the pages of an edition that is the same in every language, computed once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ...compare import Change, compare
from ...diagnostics.diagnostic import DocumentPath
from ...language.golden_frames import GoldenFrames
from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field, Layout, Variant
from ...model.message import Command, Direction, Message
from ...model.metadata import Mode
from ...templating.markup import code, markdown
from ..registry import own_targets
from .examples import Worked, worked
from .picture import Drawing, Drawings
from .tables import Cells, field_cells, index, key_cells


class Drawn(NamedTuple):
    """A picture without its title, its file, and the parameter values it is valid for if there are several pictures."""

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
    has_free_bits: bool
    """Whether a data bit belongs to no key and, for a parameter value that has the command, to no field."""
    drawn: Sequence[Drawn]
    examples: Sequence[Worked]


class Sheet(NamedTuple):
    """The page of a command: the variables of its template except the two sides, and the sides."""

    command: Command
    view: Mapping[str, Any]
    sides: Sequence[tuple[Direction, Side | None]]


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
        self._modes: Mapping[str | None, Mode] = {mode.name: mode for mode in edition.bus.modes}
        self._of_entry: dict[DocumentPath, list[Command]] = {}
        for command in edition.commands:
            if command.entry:
                self._of_entry.setdefault(command.entry.path, []).append(command)
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
        commands = self.edition.commands
        for previous, command, following in zip((None, *commands), commands, (*commands[1:], None), strict=False):
            entry = command.entry
            sections = dict.fromkeys(filter(None, (command.manual, entry.manual if entry else "")))
            view = {
                "command": command,
                "manual": ", ".join(map(markdown, sections)),
                "table": self.edition.table(entry.table) if entry else None,
                "index": code(index(command.request or command.reply)),
                "also": [other for other in self._of_entry[entry.path] if other is not command] if entry else [],
                "only": code(formatting.condition(command.only)),
                "mode": self._modes.get(command.mode),
                "previous": previous,
                "following": following,
                "errata": self._errata[command.name],
            }
            yield Sheet(command, view, [(direction, self._side(command, direction)) for direction in Direction])

    def _side(self, command: Command, direction: Direction) -> Side | None:
        """One direction of a command; None if the command has no frame in that direction."""
        message = command.message(direction)
        if message is None:
            return None
        layout = message.layout
        if layout not in self._fields:
            self._fields[layout] = [(field, field_cells(field)) for field in layout.fields]
        drawn = tuple(self._drawn(command, message))
        nodes = message.id.nodes
        return Side(
            message,
            tuple(map(key_cells, message.keys)),
            self._fields[layout],
            code(formatting.id_rule(message.id)),
            code(f"{nodes[0]}..{nodes[-1]}") if nodes is not None else "",
            not message.keys and self._has_selector_beside(message),
            not message.remote and any(picture.drawing.has_free_bits for picture in drawn),
            drawn,
            tuple(worked(self.golden, message, command.name)) if self.golden else (),
        )

    def _has_selector_beside(self, message: Message) -> bool:
        same = self.edition.of_rule(message.direction, message.id)
        return any(other.keys and other.remote == message.remote for other in same)

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
