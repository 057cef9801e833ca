"""Variables of the templates for the pages of one edition in one language."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model import formatting
from ...model.deprecation import Deprecation
from ...model.message import Address, Command, Direction
from ...model.metadata import Consent, Effect, Erratum, Level, Repeat, State
from ...model.types import ImpliedTitle
from ...templating.markup import code, markdown
from . import tables
from .common import Common, Drawn, Form, Side, Worked, sources
from .editions import Book
from .links import COMMANDS, entry_anchor, pages_of
from .tables import Row


class Half(NamedTuple):
    """One direction of a command. Empty columns of its byte table are omitted."""

    title: str
    about: str
    reserved: str
    facts: Sequence[tuple[str, str]]
    columns: Sequence[str]
    rows: Sequence[tuple[str, ...]]
    pictures: Sequence[tuple[Drawn, str]]
    """Each with its alternative text."""
    examples: Sequence[tuple[Worked, str]]
    """Each with its source."""


Admonition = tuple[str, Sequence[str]]
"""The texts of a block that code hosts and the site highlight, after their word for it."""


_KINDS = {Level.DANGER: "CAUTION", Level.WARNING: "WARNING", Level.NOTE: "NOTE"}


class Pages:
    """Builds the variables of the templates of an edition."""

    def __init__(self, common: Common, book: Book) -> None:
        self._common, self._labels, self._language = common, book.labels, book.language
        self._sources = sources(common.golden, book.language) if common.golden else {}
        self._field_rows: dict[tuple[object, ...], Sequence[Row]] = {}

    def halves(self, form: Form) -> Sequence[Half]:
        """The directions of a form."""
        return [self._half(form.command, direction, side) for direction, side in form.sides]

    def admonitions(
        self, effects: Sequence[Effect], forms: Sequence[Form], command: Command | None = None
    ) -> Sequence[Admonition]:
        """Blocks with these effects of these forms, the worst first; with what else is to be known of a command."""
        texts: dict[str, list[str]] = {kind: [] for kind in _KINDS.values()}
        if command is not None and command.deprecated:
            texts["WARNING"].append(self.deprecation(command.deprecated))
        if command is not None and not command.implemented:
            texts["WARNING"].append(self._labels["not_implemented"])
        for effect in effects:
            texts[_KINDS[effect.level]].append(self._effect(effect, forms))
        if command is not None and command.reply_within_ms is not None:
            time = f"{formatting.exact(command.reply_within_ms)} ms"
            texts["NOTE"].append(f"{self._labels['reply_within']}{self._labels['colon']}{time}")
        if command is not None and command.ends_motion is not None:
            texts["NOTE"].append(self._labels[f"ends_motion_{command.ends_motion.value}"])
        if command is not None and command.repeat is Repeat.NEVER:
            texts["WARNING"].append(self._labels["not_repeated"])
        texts["NOTE"] += [markdown(note[self._language]) for note in command.notes] if command else []
        return [(kind, listed) for kind, listed in texts.items() if listed]

    def _effect(self, effect: Effect, forms: Sequence[Form]) -> str:
        """An effect of these forms, with the values of their requests without it."""
        values = (value for form in forms for value in form.command.exemptions(effect))
        texts = dict.fromkeys(f"{code(field.name)} = {code(member.name)}" for field, member in values)
        listed = self._labels["listed"].join(texts)
        needs = "" if effect.consent is Consent.NONE else self._labels[f"consent_{effect.consent.value}"]
        return "".join(
            (
                self.description(effect),
                self._labels["effect_except"].format(listed) if listed else "",
                self._labels["needs_consent"].format(needs) if needs else "",
            )
        )

    def _half(self, command: Command, direction: Direction, side: Side | None) -> Half:
        """One direction of a command; `side` is its content for every language."""
        labels = self._labels
        title = labels[direction.value]
        facts = list(tables.facts(side.message, labels)) if side else []
        if side and side.is_rest:
            facts.append((labels["selector_of"], labels["rest"]))
        if direction is Direction.REPLY:
            facts += tables.reply_facts(self._common.edition, command, labels)
        elif side is None:
            facts.append((labels["form"], labels["no_request"]))
        if side is None:
            return Half(title, "", "", facts, (), (), (), ())
        layout = side.message.layout
        if side.is_repeated:
            facts.append((labels["fields"], labels["as_request"]))
        if layout.manual not in ("", command.manual, command.entry.manual if command.entry else ""):
            facts.append((labels["manual"], markdown(layout.manual)))
        about = self.description(layout) if layout.shared else markdown(layout.about[self._language])
        rows = [*tables.key_rows(side.message, command, labels), *self._rows_of_fields(command, side)]
        columns = zip(Row._fields, zip(*rows, strict=True), strict=False) if not side.is_repeated else ()
        kept = [(name, cells) for name, cells in columns if any(cells)]
        return Half(
            title,
            "" if command.entry and layout.path[:4] == command.entry.path else about,
            labels["reserved"] if side.has_free_bits and not side.is_repeated else "",
            facts,
            [labels[name] for name, _ in kept],
            list(zip(*(cells for _, cells in kept), strict=True)),
            [(drawn, self._alternative(command, title, drawn)) for drawn in side.drawn],
            [(worked, worked.origin(labels, self._sources, self._language)) for worked in side.examples],
        )

    def _rows_of_fields(self, command: Command, side: Side) -> Sequence[Row]:
        """Computed once for all commands that show a layout alike."""
        message = side.message
        about = (command.manual, entry_anchor(command), *command.only.items())
        key = (message.layout, message.direction, message.has_low_bits_of_node, *about)
        if key not in self._field_rows:
            rows = tables.field_rows(message, command, self._labels, self._language)
            self._field_rows[key] = tuple(rows)
        return self._field_rows[key]

    def _alternative(self, command: Command, side: str, drawn: Drawn) -> str:
        """The alternative text of a picture."""
        parts = [markdown(command.name), side, *([markdown(drawn.only)] if drawn.only else [])]
        return f"{self._labels['picture']} {self._labels['comma'].join(parts)}"

    def reply_ids(self, address: Address) -> Sequence[str]:
        """The ids of the replies to requests on an address, which can be those of another address."""
        commands = [command for command in self._common.edition.commands if command.address == address.name]
        rules = [command.reply.id for command in commands if command.reply] if commands else [address.reply]
        return list(dict.fromkeys(code(formatting.id_rule(rule)) for rule in rules))

    def nodes_of(self, address: Address) -> str:
        """The nodes of an address; of a fixed id, those that reply one by one to its requests."""
        nodes = address.request.nodes or self._replying_nodes(address)
        return code(formatting.numbers(nodes)) if nodes else ""

    def _replying_nodes(self, address: Address) -> Sequence[int]:
        commands = (command for command in self._common.edition.commands if command.address == address.name)
        return sorted({node for command in commands for node in command.from_each})

    def formats_of(self, address: Address) -> str:
        """The kinds of frames on an address: width of the id and number of data bytes."""
        messages = [message for message in self._common.edition.all_messages() if message.address == address.name]
        lengths = formatting.numbers(sorted({message.length for message in messages}))
        width = 29 if address.request.extended else 11
        return self._labels["frame_formats"].format(width, lengths) if messages else ""

    def commands_with(self, effect: Effect) -> str:
        """Links to the commands that have an effect, from a page of the edition."""
        return self._links([command.name for command in self._common.edition.commands if effect in command.effects])

    def links(self, groups: Sequence[str]) -> str:
        """Links to commands by the names of their groups, from a page of the edition."""
        return self._links([command.name for group in groups for command in self._common.edition.groups[group]])

    def _links(self, names: Sequence[str]) -> str:
        links = pages_of(self._common.edition, names).items()
        return self._labels["listed"].join(f"[{markdown(name)}]({COMMANDS}{page})" for name, page in links)

    @property
    def prevented(self) -> Collection[Effect]:
        """Effects that depend on the state of the node."""
        return {effect for state in self._common.edition.states for effect in state.prevents}

    def states_after(self, command: Command) -> Sequence[State]:
        """The states that a command leads to."""
        return [state for state in self._common.edition.states if command.spec_name in state.entered_by]

    def states_without(self, effects: Sequence[Effect]) -> Iterator[tuple[State, Sequence[Effect]]]:
        """The states in which some of these effects do not occur, with those."""
        for state in self._common.edition.states:
            absent = [effect for effect in effects if effect in state.prevents]
            if absent:
                yield state, absent

    def description(self, thing: tables.Titled) -> str:
        """Title and description of an object, in Markdown."""
        return tables.description(thing, self._labels, self._language)

    def deprecation(self, deprecated: Deprecation) -> str:
        """Since when, and until when, an object is deprecated."""
        return tables.deprecation(deprecated, self._labels)

    def availability(self, only: Mapping[str, tuple[str, ...]]) -> str:
        """The parameter values that a command is limited to, by their titles, or by their names where they have none."""
        return self._labels["and"].join(self._available(name, values) for name, values in only.items())

    def _available(self, name: str, values: Sequence[str]) -> str:
        titles = {value.name: value.title for value in self._common.edition.parameter(name).values}
        if any(isinstance(titles[value], ImpliedTitle) for value in values):
            return code(formatting.condition({name: tuple(values)}))
        return self._labels["listed"].join(markdown(titles[value][self._language]) for value in values)

    def erratum_links(self, erratum: Erratum) -> Mapping[str, str]:
        """Names and pages of the commands that an erratum affects."""
        return pages_of(self._common.edition, self._common.touched.get(erratum.id, ()))
