"""The pages of one edition in one language: what the templates lay out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from ... import words
from ...golden import GoldenFrames
from ...model import Command, Direction, Edition, Erratum, Message, Path, Segment, Space, Variant
from . import picture, tables
from .examples import Example, examples
from .overview import overview
from .tables import Labels, Row
from .text import code, markdown


class Picture(NamedTuple):
    """A picture file, and under which parameter values it holds."""

    file: str
    svg: str
    alt: str
    only: str


class Half(NamedTuple):
    """One direction of a command. Of its byte table, columns that would be empty are left out."""

    title: str
    about: str
    reserved: str
    facts: tuple[tuple[str, str], ...]
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    pictures: tuple[Picture, ...]
    examples: tuple[Example, ...]


class Pages:
    """Builds what the templates of an edition are given."""

    def __init__(self, edition: Edition, golden: GoldenFrames | None, labels: Labels, language: str) -> None:
        self.edition = edition
        self._golden = golden
        self._labels = labels
        self._language = language
        self._of_entry: dict[Path, list[Command]] = {}
        for command in edition.commands:
            if command.entry:
                self._of_entry.setdefault(command.entry.path, []).append(command)
        self._places = {command.name: place for place, command in enumerate(edition.commands)}
        self._errata = {command.name: edition.errata_of(command) for command in edition.commands}
        self._touched: dict[str, list[str]] = {}
        for name, errata in self._errata.items():
            for erratum in errata:
                self._touched.setdefault(erratum.id, []).append(name)

    def overview(self) -> Mapping[str, Any]:
        """The first page of the edition."""
        return overview(self.edition, self._labels, self._language)

    def command(self, command: Command) -> Mapping[str, Any]:
        """The page of one command."""
        commands = self.edition.commands
        at = self._places[command.name]
        entry = command.entry
        sections = dict.fromkeys(filter(None, (command.manual, entry.manual if entry else "")))
        return {
            "command": command,
            "manual": ", ".join(map(markdown, sections)),
            "table": self.edition.table(entry.table) if entry else None,
            "index": code(tables.index(command.request or command.reply)),
            "also": [c for c in self._of_entry[entry.path] if c is not command] if entry else [],
            "halves": [self._half(command, d) for d in Direction],
            "only": code(words.condition(command.only)),
            "mode": next((mode for mode in self.edition.bus.modes if mode.name == command.mode), None),
            "previous": commands[at - 1] if at else None,
            "following": commands[at + 1] if at + 1 < len(commands) else None,
            "errata": self._errata[command.name],
        }

    def _half(self, command: Command, direction: Direction) -> Half:
        labels = self._labels
        message = command.message(direction)
        facts = list(tables.facts(message, labels)) if message else []
        if message and self._is_rest(message):
            facts.append((labels["selector_of"], labels["rest"]))
        if direction is Direction.REPLY:
            facts += tables.reply_facts(command, labels)
        elif message is None:
            facts.append((labels["form"], labels["no_request"]))
        if message is None:
            return Half(labels[direction.value], "", "", tuple(facts), (), (), (), ())
        layout = message.layout
        if layout.manual not in ("", command.manual, command.entry.manual if command.entry else ""):
            facts.append((labels["manual"], markdown(layout.manual)))
        about = self.said(layout) if layout.shared else markdown(layout.about[self._language])
        rows = list(tables.rows(message, command, labels, self._language))
        kept = [name for name in Row._fields if any(getattr(row, name) for row in rows)]
        return Half(
            labels[direction.value],
            "" if command.entry and layout.path[:4] == command.entry.path else about,
            labels["reserved"] if self._has_free_bits(command, message) else "",
            tuple(facts),
            tuple(labels[name] for name in kept),
            tuple(tuple(getattr(row, name) for name in kept) for row in rows),
            tuple(self._pictures(command, message)),
            tuple(examples(self._golden, message, command.name, labels, self._language)),
        )

    def _is_rest(self, message: Message) -> bool:
        """Whether a message has no selector, and others of its ids have one."""
        same = self.edition.of_rule(message.direction, message.id)
        return not message.keys and any(other.keys and other.remote == message.remote for other in same)

    def _pictures(self, command: Command, message: Message) -> Iterator[Picture]:
        variants = [v for v in message.layout.variants if self._can_be(command, message, v)]
        for variant in variants:
            suffix = "-" + "-".join(variant.values) if len(variants) > 1 else ""
            only = f"{message.layout.parameter} {', '.join(variant.values)}" if suffix else ""
            about = (command.name, self._labels[message.direction.value], only)
            title = f"{self._labels['picture']} {self._labels['comma'].join(filter(None, about))}"
            svg = picture.svg(message, variant, title)
            yield Picture(f"{command.name}-{message.direction.value}{suffix}.svg", svg, markdown(title), code(only))

    @staticmethod
    def _can_be(command: Command, message: Message, variant: Variant) -> bool:
        allowed = command.only.get(message.layout.parameter or "", variant.values)
        return not variant.values or bool(set(variant.values) & set(allowed))

    def _has_free_bits(self, command: Command, message: Message) -> bool:
        """Whether some data bit belongs to no key and, under some parameter value that has the command, to no field."""
        data = 0 if message.remote else 8 * message.dlc
        return any(
            sum(s.width for places in _data(message, v) for s in places) < data
            for v in message.layout.variants
            if self._can_be(command, message, v)
        )

    def types(self) -> Mapping[str, Any]:
        """The page of types."""
        return {"named_types": [t for t in self.edition.types if t.path[0] == "types"], "tables": tables}

    def said(self, thing: tables.Titled) -> str:
        """The title of a thing, and what else is said of it."""
        return tables.said(thing, self._labels, self._language)

    def condition(self, only: Mapping[str, tuple[str, ...]]) -> str:
        """Under which parameter values something is there."""
        return code(words.condition(only))

    def erratum_links(self, erratum: Erratum) -> list[str]:
        """The commands that an erratum touches."""
        return self._touched.get(erratum.id, [])


def _data(message: Message, variant: Variant) -> Iterator[tuple[Segment, ...]]:
    """The data bits that keys and fields take."""
    yield from (key.segments for key in message.keys if key.space is Space.DATA)
    yield from (e.segments for f in variant.fields if f.space is Space.DATA for e in f.elements)
