"""The pages of one edition in one language: what the templates lay out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from ... import words
from ...golden import GoldenFrames
from ...model import Command, Direction, Edition, Erratum, Message, Variant
from . import picture, tables
from .examples import Example, examples
from .tables import Labels, Row
from .text import code, markdown


class Picture(NamedTuple):
    """A picture file, and under which parameter values it holds."""

    file: str
    svg: str
    alt: str
    only: str


class Half(NamedTuple):
    """One direction of a command."""

    title: str
    about: str
    facts: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]
    pictures: tuple[Picture, ...]
    examples: tuple[Example, ...]


class Line(NamedTuple):
    """A command in the overview."""

    name: str
    code: str
    title: str
    reply: str
    only: str
    effects: str


class Pages:
    """Builds what the templates of an edition are given."""

    def __init__(self, edition: Edition, golden: GoldenFrames | None, labels: Labels, language: str) -> None:
        self.edition = edition
        self._golden = golden
        self._labels = labels
        self._language = language
        self._places = {command.name: place for place, command in enumerate(edition.commands)}
        self._errata = {command.name: edition.errata_of(command) for command in edition.commands}
        self._touched: dict[str, list[str]] = {}
        for name, errata in self._errata.items():
            for erratum in errata:
                self._touched.setdefault(erratum.id, []).append(name)

    def overview(self) -> Mapping[str, Any]:
        """The first page of the edition."""
        return {"lines": [self._line(command) for command in self.edition.commands]}

    def _line(self, command: Command) -> Line:
        return Line(
            command.name,
            code(f"0x{command.code:02X}") if command.code is not None else "",
            markdown(command.title[self._language]),
            tables.reply_form(command, self._labels, "commands/"),
            code(words.condition(command.only)),
            ", ".join(code(effect.name) for effect in command.effects),
        )

    def command(self, command: Command) -> Mapping[str, Any]:
        """The page of one command."""
        commands = self.edition.commands
        at = self._places[command.name]
        return {
            "command": command,
            "halves": [self._half(command, d) for d in Direction],
            "only": code(words.condition(command.only)),
            "mode": next((mode for mode in self.edition.bus.modes if mode.name == command.mode), None),
            "previous": commands[at - 1] if at else None,
            "following": commands[at + 1] if at + 1 < len(commands) else None,
            "errata": self._errata[command.name],
        }

    def _half(self, command: Command, direction: Direction) -> Half:
        labels = self._labels
        message = command.request if direction is Direction.REQUEST else command.reply
        facts = list(tables.facts(message, labels)) if message else []
        if message and self._is_rest(message):
            facts.append((labels["selector_of"], labels["rest"]))
        if direction is Direction.REPLY:
            facts += tables.reply_facts(command, labels)
        elif message is None:
            facts.append((labels["form"], labels["no_request"]))
        if message is None:
            return Half(labels[direction.value], "", tuple(facts), (), (), ())
        return Half(
            labels[direction.value],
            markdown(message.layout.about[self._language]),
            tuple(facts),
            tuple(tables.rows(message, command, labels, self._language)),
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

    def types(self) -> Mapping[str, Any]:
        """The page of types."""
        return {"named_types": [t for t in self.edition.types if t.path[0] == "types"], "tables": tables}

    def erratum_links(self, erratum: Erratum) -> list[str]:
        """The commands that an erratum touches."""
        return self._touched.get(erratum.id, [])
