"""Which command, field and member of one edition stands for which of the other."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Command
from ...model.types import Type
from .. import match


class Counterparts:
    """The pairs of commands, fields and members that the structural comparison matches; fields and members are cached."""

    def __init__(self, old: Edition, new: Edition) -> None:
        matched = match.commands(old, new)
        self.commands = matched.pairs
        self.removed, self.added = matched.removed, matched.added
        self._fields: dict[tuple[Layout, Layout], list[tuple[Field, Field]]] = {}
        self._members: dict[tuple[Type, Type], Mapping[str, str]] = {}
        self._former_members: dict[tuple[Type, Type], Mapping[str, str]] = {}
        self._same: dict[tuple[Type, Type], bool] = {}
        self._of: dict[Command, Command] = {}
        for old_command, new_command in matched.pairs:
            self._of[old_command], self._of[new_command] = new_command, old_command

    def of(self, command: Command) -> Command | None:
        """The command of the other edition; None without one."""
        return self._of.get(command)

    def fields(self, old: Layout, new: Layout) -> list[tuple[Field, Field]]:
        """The pairs of fields of two layouts."""
        if (old, new) not in self._fields:
            self._fields[old, new] = list(match.fields(old, new).pairs)
        return self._fields[old, new]

    def members(self, old: Type, new: Type) -> Mapping[str, str]:
        """The names of the new members, by those of the old ones."""
        if (old, new) not in self._members:
            pairs = (*match.members(old.enum, new.enum).pairs, *match.members(old.flags, new.flags).pairs)
            self._members[old, new] = {old_member.name: new_member.name for old_member, new_member in pairs}
        return self._members[old, new]

    def former_members(self, old: Type, new: Type) -> Mapping[str, str]:
        """The names of the old members, by those of the new ones."""
        if (old, new) not in self._former_members:
            self._former_members[old, new] = {now: was for was, now in self.members(old, new).items()}
        return self._former_members[old, new]

    def is_same_type(self, old: Type, new: Type) -> bool:
        """Whether two types give every raw integer the same value and allow the same ones."""
        if (old, new) not in self._same:
            self._same[old, new] = _facts(old) == _facts(new)
        return self._same[old, new]


def _facts(type_: Type) -> tuple[object, ...]:
    members = tuple(frozenset((m.name, m.value) for m in named) for named in (type_.enum, type_.flags))
    unit = type_.unit and type_.unit.name
    return (type_.width, type_.encoding, type_.order, unit, type_.linear, type_.raw_range, members)
