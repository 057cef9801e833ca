"""What of a spec is certain while parts of it are amiss: so far, rules about the whole of it hold all the same.

A rule about the whole compares commands. What was left out of one of them can make it look like another, so that one is
not compared; those that are as they were written are. An address whose id is lost has one that no other has.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import IntEnum

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import NO_INDEX, Command, EditionSpec, Fields, MessageSpec
from ..model.edition import Edition


class Depth(IntEnum):
    """How much of messages a rule looks at; what is amiss leaves them certain up to one of these."""

    FRAMES = 0
    """Ids, lengths and byte orders."""
    CODES = 1
    """Codes, too."""
    BITS = 2
    """Fields with their bits, too."""
    VALUES = 3
    """What the bits mean, too."""


Reference = tuple[str, str]
"""What a command is made of: `types` and the name of a type, and so on."""

_TEXTS = frozenset({"title", "about", "notes", "manual", "differs", "plausible"})
_ASIDE = _TEXTS | {"effects", "limited_by", "not_limited_by", "implemented", "mode", "only"}
"""Keys of a command and of an entry that tell nothing apart."""
_FRAMES = frozenset({"address", "table", "dlc", "remote", "index"})
_CODES = frozenset({"code", "accept", "of", "kind", "commands"})
"""Keys of commands, messages and entries about something else than fields."""
_OF_NAMES = frozenset({"fields", "layout", "request", "reply", "enum", "flags", "entries", "values"})
"""Keys that have names below them."""


class Doubts:
    """What is not certain in a spec of which the parts at some paths are amiss.

    `first` is the address of commands that name none, as it is written.
    """

    def __init__(self, spec: EditionSpec, paths: Iterable[DocumentPath], first: str) -> None:
        self._spec = spec
        self._commands: dict[str, Depth] = {}
        self._all: Depth | None = None
        self._misses_commands = False
        every = list(paths)
        amiss = [(path, depth) for path in every if (depth := _depth(path)) is not None]
        self.any = any(not is_text(path) for path in every)
        """Whether anything but a text is amiss."""
        made_of = (
            {name: set(self._references(command, first)) for name, command in spec.commands.items()} if amiss else {}
        )
        for path, depth in amiss:
            self._note(path, depth, made_of)
        while self._any_passed_on():
            pass

    def certain(self, edition: Edition, depth: Depth) -> Edition:
        """The edition with only those commands that are certain up to some depth."""
        if not self.any:
            return edition
        beyond = len(Depth)
        rest = beyond if self._all is None else self._all
        commands = tuple(c for c in edition.commands if min(rest, self._commands.get(c.group, beyond)) > depth)
        return dataclasses.replace(edition, commands=commands)

    def knows(self, command: str) -> bool:
        """Whether a name that golden frames give is that of a command that is certain, or certainly of none."""
        doubtful = any(command == one or command.startswith(f"{one}_") for one in self._commands)
        return not (self._misses_commands or self._all is not None or doubtful)

    def _note(self, path: DocumentPath, depth: Depth, made_of: Mapping[str, Collection[Reference]]) -> None:
        what = (str(path[0]), str(path[1])) if len(path) > 1 else ("", "")
        if path == ("bus", "dlc"):
            self._doubt((name for name, command in self._spec.commands.items() if _has_dlc(command)), Depth.FRAMES)
            self._doubt_all(Depth.VALUES)
        elif what[0] == "commands":
            self._misses_commands |= what[1] not in self._spec.commands
            self._doubt([what[1]], depth)
        elif what[0] == "tables" and path[2:3] == ("entries",) and self._is_left_out(what[1], path[3:4]):
            self._misses_commands = True
        elif what[0] in ("types", "layouts", "tables", "addresses"):
            self._doubt((name for name, references in made_of.items() if what in references), depth)
        else:
            self._doubt_all(depth)

    def _is_left_out(self, table: str, entry: DocumentPath) -> bool:
        if table not in self._spec.tables or not entry:
            return False
        there = self._spec.tables[table].entries.get(str(entry[0]))
        return there is None or there.index == NO_INDEX

    def _doubt_all(self, depth: Depth) -> None:
        self._all = depth if self._all is None else min(depth, self._all)

    def _doubt(self, commands: Iterable[str], depth: Depth) -> None:
        for name in commands:
            self._commands[name] = min(depth, self._commands.get(name, depth))

    def _any_passed_on(self) -> bool:
        """Passes doubts on to the commands that take their reply from one in doubt; whether there were any."""
        before = dict(self._commands)
        for name, command in self._spec.commands.items():
            of = command.reply.of if isinstance(command.reply, MessageSpec) else None
            if of in before:
                self._doubt([name], max(Depth.BITS, before[of]))
        return self._commands != before

    def _references(self, command: Command, first: str) -> Iterator[Reference]:
        yield "addresses", command.address or first
        for message in (command.request, command.reply):
            if isinstance(message, MessageSpec):
                yield "addresses", message.address or first
                yield from self._of_layout(message.layout)
                yield from self._of_layout(message.fields)
            else:
                yield from self._of_layout(message)
        if command.table is not None:
            yield "tables", command.table
            table = self._spec.tables.get(command.table)
            for entry in table.entries.values() if table else ():
                yield from self._of_layout(entry.layout)

    def _of_layout(self, layout: str | Fields | None) -> Iterator[Reference]:
        if isinstance(layout, str):
            yield "layouts", layout
            layout = self._spec.layouts[layout].fields if layout in self._spec.layouts else None
        for field in (layout or {}).values():
            if field.type is not None:
                yield "types", field.type


def matters(path: DocumentPath) -> bool:
    """Whether something at a path is more than a text."""
    return _depth(path) is not None


def _depth(path: DocumentPath) -> Depth | None:
    """Where certainty ends when something at a path is amiss; None when it does not."""
    top, inner, key = (path[0] if path else ""), path[2:], str((*path, "", "", "")[2])
    if is_text(path):
        return None
    if top == "addresses" and key in ("id", "request", "reply", "nodes", "extended"):
        return Depth.VALUES
    if top in ("", "addresses", "byte_order") or "byte_order" in path[1:] or path in (("bus",), ("bus", "dlc")):
        return Depth.FRAMES
    if top == "selector" or path == ("commands",):
        return Depth.CODES
    if top == "parameters":
        return Depth.VALUES
    if top == "types":
        return Depth.BITS if key in ("", "raw") else Depth.VALUES
    if top == "layouts":
        return Depth.BITS
    if top in ("commands", "tables"):
        return _depth_within(inner[2:] if key == "entries" else inner)
    return None


def _depth_within(keys: DocumentPath) -> Depth | None:
    """As `_depth`, for the keys of a command, a table or an entry."""
    if not keys:
        return Depth.BITS
    if keys[0] in _ASIDE or keys[1:2] == ("from_each",):
        return None
    head = keys[1] if keys[0] in ("request", "reply") and len(keys) > 1 else keys[0]
    if head in _FRAMES or keys == ("request",):
        return Depth.FRAMES
    return Depth.CODES if head in _CODES else Depth.BITS


def is_text(path: DocumentPath) -> bool:
    """Whether a path leads to a text, or to one language of it."""
    return any(path[i] in _TEXTS and path[i - 1] not in _OF_NAMES for i in range(max(2, len(path) - 2), len(path)))


def _has_dlc(command: Command) -> bool:
    return any(isinstance(m, MessageSpec) and m.dlc is not None for m in (command.request, command.reply))
