"""Definitions with errors, and definitions that depend on them. Rules check the others."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Iterator
from typing import Any

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition

Definition = tuple[str, str]

_SECTIONS = ("addresses", "parameters", "settings", "effects", "types", "layouts", "tables", "commands")
_ALL_COMMANDS = frozenset({(), ("selector",), ("byte_order",), ("bus",), ("bus", "dlc"), ("addresses",)})
_INDEPENDENT = frozenset({"unit", "effects", "limited_by", "not_limited_by", "implemented", "mode", "reply_within_ms"})
_TEXTS = frozenset({"title", "about", "notes", "manual", "differs", "plausible"})
_CODE_KEYS = frozenset({"code", "accept", "address", "table", "of", "dlc", "remote", "index", "kind", "commands"})
"""Keys of commands, messages and entries that, besides fields, determine the code of a message."""
_NAME_KEYS = frozenset({"fields", "layout", "request", "reply", "enum", "flags", "entries", "values"})
"""Keys with mappings of names, which are not texts."""


class Affected:
    """The definitions affected by errors at some paths of a document."""

    def __init__(self, data: Any, paths: Iterable[DocumentPath]) -> None:
        data = data if isinstance(data, dict) else {}
        paths = list(paths)
        self._touched = {path[:end] for path in paths for end in range(2, len(path) + 1)}
        self.paths = [path for path in paths if not _is_text(path)]
        self.sections = frozenset(str(path[0]) for path in self.paths if path)
        """Sections with an error."""
        self.incomplete = frozenset(str(path[0]) for path in self.paths if path and len(path) <= 2)
        """Sections with unknown names."""
        if any(path and path[0] not in data for path in self.paths) or () in self.paths:
            self.incomplete |= {section for section in _SECTIONS if section not in data}
        entries = {key: data[key] for key in _SECTIONS if isinstance(data.get(key), dict)}
        first = next(iter(entries.get("addresses", ())), "")
        direct = {(str(path[0]), str(path[1])) for path in self.paths if len(path) > 1 and path[0] in _SECTIONS}
        affects_all = not _ALL_COMMANDS.isdisjoint(path[:2] for path in self.paths) or ("addresses", first) in direct
        if affects_all or any(path[0] in ("selector", "byte_order") for path in self.paths if path):
            direct |= {("commands", name) for name in entries.get("commands", ())}
        self._definitions = _with_dependents(entries, direct) if direct else direct

    def __contains__(self, path: DocumentPath) -> bool:
        """Whether a path is in an affected definition."""
        return (path[0], path[1]) in self._definitions if len(path) > 1 else False

    def has_error(self, path: DocumentPath) -> bool:
        """Whether there is an error at or below a path."""
        return path in self._touched

    def may_hide(self, dotted: str) -> bool:
        """Whether an error may be the reason that a dotted path does not exist."""
        steps = tuple(dotted.split("."))
        return any(tuple(map(str, path[:2])) == steps[: len(path[:2])] for path in self.paths) or (
            steps[0] in self.incomplete
        )

    def others(self, edition: Edition) -> Edition:
        """The edition with its unaffected commands."""
        if not self._definitions:
            return edition
        commands = tuple(c for c in edition.commands if ("commands", c.spec_name) not in self._definitions)
        return dataclasses.replace(edition, commands=commands)


def _with_dependents(entries: dict[str, dict[str, Any]], direct: set[Definition]) -> set[Definition]:
    """Definitions, and those that depend on them."""
    mentions: dict[str, list[Definition]] = {}
    for section, named in entries.items():
        for name, value in named.items():
            for word in set(_words(value)):
                mentions.setdefault(word, []).append((section, name))
    result, pending = set(direct), list(direct)
    while pending:
        _, name = pending.pop()
        dependents = [one for one in mentions.pop(name, ()) if one not in result]
        result.update(dependents)
        pending += dependents
    return result


def _words(value: Any, key: str = "") -> Iterator[str]:
    """The words of a definition that may be names of other definitions."""
    if isinstance(value, str):
        yield from re.findall("[A-Za-z][A-Za-z0-9_]*", value)
    elif isinstance(value, list):
        for item in value:
            yield from _words(item, key)
    elif isinstance(value, dict):
        yield from value if key == "only" else ()
        for name, inner in value.items():
            if name not in _TEXTS or key in _NAME_KEYS:
                yield from _words(inner, name)


def decides_code(path: DocumentPath) -> bool:
    """Whether the value at a path determines codes or ids of messages, and not only their fields."""
    section, keys = path[0] if path else "", path[4:] if path[2:3] == ("entries",) else path[2:]
    if section in ("types", "layouts", "parameters"):
        return False
    return section not in ("commands", "tables") or len(keys) < 2 or path[-1] == "constant" or keys[1] in _CODE_KEYS


def _is_text(path: DocumentPath) -> bool:
    """Whether a path leads to a text, or to a value that no other definition depends on."""
    if path[2:3] and path[2] in _INDEPENDENT and path[0] in ("types", "commands"):
        return True
    return any(path[i] in _TEXTS and path[i - 1] not in _NAME_KEYS for i in range(max(2, len(path) - 2), len(path)))
