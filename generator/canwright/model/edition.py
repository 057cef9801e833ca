"""The resolved edition: frozen, complete and exact. Targets read nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from ..diagnostics.diagnostic import DocumentPath
from .layout import Layout
from .meaning import meaning_hash
from .message import Address, Command, Direction, IdRule, Message, Table
from .metadata import Bus, Effect, Erratum, Setting, State
from .types import Order, Parameter, Text, Type


@dataclass(frozen=True, eq=False, kw_only=True)
class Edition:
    """One edition of a protocol, resolved."""

    family: str
    name: str
    date: str
    languages: tuple[str, ...]
    title: Text
    about: Text
    manual: Text
    order: Order
    bus: Bus
    parameters: tuple[Parameter, ...]
    settings: tuple[Setting, ...]
    effects: tuple[Effect, ...]
    states: tuple[State, ...]
    addresses: tuple[Address, ...]
    types: tuple[Type, ...]
    layouts: tuple[Layout, ...]
    tables: tuple[Table, ...]
    commands: tuple[Command, ...]
    errata: tuple[Erratum, ...]

    @cached_property
    def hash(self) -> str:
        """The SHA-256 of its meaning, in hex. Texts, comments and the order of keys do not change it."""
        return meaning_hash(self)

    @property
    def identifier(self) -> str:
        """The edition's name as an identifier: `v2.35-2024-02` is `v2_35_2024_02`, and `2.0` is `v2_0`."""
        return ("v" if self.name[0].isdigit() else "") + "".join(c if c.isalnum() else "_" for c in self.name)

    def messages(self, direction: Direction) -> Sequence[Message]:
        """The distinct messages of one direction, in spec order."""
        return self._index.messages[direction]

    def all_messages(self) -> Sequence[Message]:
        """The distinct messages of both directions."""
        return self._index.all_messages

    def of_rule(self, direction: Direction, rule: IdRule) -> Sequence[Message]:
        """The messages of one direction that have an id rule."""
        return self._index.of_rule.get((direction, rule), ())

    def of_layout(self, layout: Layout) -> Sequence[Message]:
        """The messages that have this layout; an equal layout of another message does not count."""
        return self._index.of_layout.get(layout, ())

    def command(self, name: str) -> Command:
        return self._index.commands[name]

    @property
    def groups(self) -> Mapping[str, Sequence[Command]]:
        """The forms of each command, by its name in the spec."""
        return self._index.forms

    def forms(self, group: str) -> Sequence[Command]:
        """The commands with a name in the spec: one for each entry if it has a table; none for an unknown name."""
        return self._index.forms.get(group, ())

    def parameter(self, name: str) -> Parameter:
        return next(p for p in self.parameters if p.name == name)

    def is_factor(self, parameter: Parameter) -> bool:
        """Whether a scale is a multiple of a parameter; the parameter must be above 0 then."""
        return any(parameter.name in type_.times for type_ in self.types)

    def address(self, name: str) -> Address:
        return self._index.addresses[name]

    def table(self, name: str) -> Table:
        return next(t for t in self.tables if t.name == name)

    def errata_of(self, command: Command) -> tuple[Erratum, ...]:
        """The errata that affect a command: its own and those of the entry, layouts and types it uses."""
        if not self.errata:
            return ()
        messages = command.messages
        paths = [command.path, *(path for m in messages for path in (m.path, m.layout.path))]
        paths += [path for m in messages for f in m.layout.fields for path in (f.path, f.type.path)]
        paths += [command.entry.path] if command.entry else []
        numbers = self._errata_at(paths)
        if command.entry is not None:
            table = ("tables", command.entry.table)
            numbers |= {n for n in self._errata_at([table]) if any(_is_about(w, table) for w in self.errata[n].where)}
        return tuple(self.errata[number] for number in sorted(numbers))

    def errata_at(self, *paths: DocumentPath) -> tuple[Erratum, ...]:
        """The errata about the items at some paths and their parts, in spec order."""
        return tuple(self.errata[number] for number in sorted(self._errata_at(paths)))

    @cached_property
    def slow_replies(self) -> tuple[str, ...]:
        """Commands with a reply time of their own, to which that of the bus does not apply."""
        return tuple(c.name for c in self.commands if c.reply_within_ms is not None)

    def _errata_at(self, paths: Iterable[DocumentPath]) -> set[int]:
        return {number for path in paths for number in self._index.errata.get(".".join(map(str, path)), ())}

    @cached_property
    def _index(self) -> _Index:
        return _Index(self)


def _is_about(where: str, table: DocumentPath) -> bool:
    """Whether a dotted path leads to a table or a part of it other than an entry."""
    dotted = ".".join(map(str, table))
    return where == dotted or (where.startswith(f"{dotted}.") and not where.startswith(f"{dotted}.entries."))


class _Index:
    """Lookup tables of an edition. Of several items with one name, the first is found."""

    def __init__(self, edition: Edition) -> None:
        self.commands = {command.name: command for command in reversed(edition.commands)}
        self.forms: dict[str, list[Command]] = {}
        for command in edition.commands:
            self.forms.setdefault(command.spec_name, []).append(command)
        self.addresses = {address.name: address for address in reversed(edition.addresses)}
        self.messages: dict[Direction, list[Message]] = {direction: [] for direction in Direction}
        for command in edition.commands:
            for direction, message in ((Direction.REQUEST, command.request), (Direction.REPLY, command.reply)):
                if message is not None and message.command == command.name:
                    self.messages[direction].append(message)
        self.all_messages = [message for messages in self.messages.values() for message in messages]
        self.of_rule: dict[tuple[Direction, IdRule], list[Message]] = {}
        self.of_layout: dict[Layout, list[Message]] = {}
        for message in self.all_messages:
            self.of_rule.setdefault((message.direction, message.id), []).append(message)
            self.of_layout.setdefault(message.layout, []).append(message)
        self.errata: dict[str, list[int]] = {}
        """The numbers of the errata, by each prefix of the dotted paths that they are about."""
        for number, erratum in enumerate(edition.errata):
            for where in erratum.where:
                steps = where.split(".")
                for end in range(1, len(steps) + 1):
                    self.errata.setdefault(".".join(steps[:end]), []).append(number)
