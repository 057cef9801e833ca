"""Names of the bindings that disappear without a change of their item, such as functions of a type with another prefix."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from .change import Category, Change, Item
from .collector import BOTH_SIDES, Collector, Subject
from .exported_names import ExportedNames

_KINDS = {
    "addresses": "address",
    "commands": "command",
    "effects": "effect",
    "layouts": "layout",
    "parameters": "parameter",
    "settings": "setting",
    "tables": "table",
    "types": "type",
}
"""The kind of item in each section of a spec."""
_WIDE = ("command", "entry", "layout", "table")
"""The kinds of items whose changes can cause changes of names of other items: those that their commands use."""


def compare(collector: Collector, names: ExportedNames, old: Edition) -> None:
    """Adds a change for each item with names that disappear, unless a change of the item or of its users explains it."""
    groups: dict[DocumentPath, list[DocumentPath]] = defaultdict(list)
    changes = [change for change in collector if change.rule.category is not Category.DOC]
    users, parameters = _users(old), _parameters(old)
    for path in sorted(names.missing(), key=repr):
        related = users.get(path[:2], frozenset()), parameters.get(path[:2], frozenset())
        if not any(_explains(change, path, *related) for change in changes):
            groups[path[:2]].append(path)
    for item, paths in groups.items():
        named = Item(_KINDS[str(item[0])], str(item[1])) if item[0] in _KINDS else Item(str(item[0]), "")
        subject = Subject(collector, named, (item, item), BOTH_SIDES)
        subject.add("names-changed", names=names.disappeared(paths))


def _explains(change: Change, path: DocumentPath, users: frozenset[str], parameters: frozenset[str]) -> bool:
    """Whether a change is about the item at a path, about something around or in it, or about a command that uses it.

    Names of an item contain those of the values of the `parameters` that it depends on.
    """
    if change.rule.id.endswith("-added"):
        return False
    if change.item.kind == "parameter" and change.item.name in parameters:
        return True
    if change.item.kind in _WIDE and users & {*change.used_by}:
        return True
    if change.item.kind in ("edition", "bus") and change.rule.category is Category.WIRE:
        return True
    return _is_near(change.old or (), path)


def _is_near(changed: DocumentPath, path: DocumentPath) -> bool:
    """Whether one path leads to the other, or the changed one is that of a key of something around the other."""
    common = next(
        (i for i, (a, b) in enumerate(zip(changed, path, strict=False)) if a != b), min(len(changed), len(path))
    )
    return common >= 2 and (common == len(path) or len(changed) - common <= 1)


def _parameters(edition: Edition) -> dict[DocumentPath, frozenset[str]]:
    """The parameters that the scale, the offset or the range of a type depends on, by its path."""
    return {type_.path[:2]: frozenset((*type_.parameters, *type_.numbers)) for type_ in edition.types}


def _users(edition: Edition) -> dict[DocumentPath, frozenset[str]]:
    """The commands that use an item, by its path."""
    users: dict[DocumentPath, set[str]] = defaultdict(set)
    for command in edition.commands:
        layouts = [message.layout for message in command.messages]
        tables = [command.entry.path] if command.entry else []
        used: Iterable[DocumentPath] = (
            command.path,
            *tables,
            *(layout.path for layout in layouts),
            *(field.type.path for layout in layouts for field in layout.fields),
            *(("effects", effect.name) for effect in command.effects),
            *(("settings", setting.name) for setting in (*command.limited_by, *command.not_limited_by)),
            *(("addresses", message.address) for message in command.messages),
        )
        for path in used:
            users[path[:2]].add(command.spec_name)
    return {path: frozenset(commands) for path, commands in users.items()}
