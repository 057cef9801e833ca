"""A document against the language: as much of it as is right, and pydantic's findings put where they are."""

from __future__ import annotations

import copy
import itertools
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pydantic import ValidationError

from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath, SpecError, near
from ..document.document import Document
from ..document.scalars import MERGE
from ..model.types import UNNAMED
from . import error_messages, suggestions
from .edition import Concept
from .error_messages import Error, Location

M = TypeVar("M", bound=Concept)


def validate(document: Document, concept: type[M]) -> M:
    """The document as an instance of `concept`. Raises SpecError with every structural finding."""
    found = validate_parts(document, concept)
    if found.diagnostics or found.spec is None:
        raise SpecError(found.diagnostics)
    return found.spec


@dataclass(frozen=True)
class Validated(Generic[M]):
    """What of a document could be read: without the parts at `dropped`; None when too little is left.

    `doubtful` are the paths of what the dropped parts were meant for.
    """

    spec: M | None
    diagnostics: tuple[Diagnostic, ...]
    dropped: frozenset[DocumentPath]
    doubtful: frozenset[DocumentPath]


def validate_parts(document: Document, concept: type[M]) -> Validated[M]:
    """As much of the document as is right, and every structural finding, so that one run tells all."""
    other = _other_file(document, concept)
    if other:
        return Validated(None, (*document.findings, other), frozenset({()}), frozenset({()}))
    return _Reading(document, concept).read()


def _other_file(document: Document, concept: type[Concept]) -> Diagnostic | None:
    """A finding when this is a file of another kind."""
    data, (key, message, hint) = document.data, concept.mistaken
    needed = [name for name, field in concept.model_fields.items() if field.is_required()]
    if not isinstance(data, dict):
        return None
    if key in data and not {"commands", "frames"} - {key} & set(data):
        return document.finding((key,), "missing-key", message, hint, key=True)
    if not (set(data) | {path[0] for path in document.spoilt if path}) & set(needed):
        keys = ", ".join(f"`{name}`" for name in needed)
        return document.finding(
            (), "missing-key", f"none of {keys} is here, so this is something else", "`canwright: 1` comes first"
        )
    return None


class _Reading(Generic[M]):
    """Reads a document, leaving out what is wrong until the rest is right."""

    def __init__(self, document: Document, concept: type[M]) -> None:
        self._document = document
        self._concept = concept
        self._data: Any = document.data
        self._findings = list(document.findings)
        self._stand_ins: dict[DocumentPath, object] = {(key,): value for key, value in concept.stand_ins.items()}
        self._dropped = {_entry(path) for path in document.spoilt}
        self._dropped |= {before for path in document.spoilt if (before := _before(document, path))}
        self._dropped |= set(_second_ones(document))
        self._doubtful = set(self._dropped)

    def read(self) -> Validated[M]:
        if self._dropped:
            self._leave_out(self._dropped)
        spec = None
        for attempt in range(0 if () in self._dropped else ROUNDS):
            try:
                spec = self._concept.model_validate(self._data)
                break
            except ValidationError as error:
                errors = [dict(e) for e in error.errors()]
            if not self._learn(errors, attempt == 0):
                break
        found = tuple(self._findings)
        return Validated(spec, found, frozenset(self._dropped), frozenset(self._doubtful))

    def _learn(self, errors: list[Error], is_first: bool) -> bool:
        """Tells what is wrong, the first time, and leaves it out; false when too little would be left."""
        slips = dict(self._slips(errors))
        renamed = {(*path[:-1], name) for path, name in slips.items()}
        wrong = [e for e in errors if e["type"] != "missing" or self._missing(e) not in renamed]
        said = set(self._said(errors))
        told = (e for e in wrong if (is_first or self._is_renamed(e)) and not self._follows(e, said))
        for error in itertools.islice(told, MOST_FINDINGS):
            self._findings.append(
                error_messages.diagnostic(self._document, self._concept, error, self._path(error["loc"]))
            )
        culprits = {self._culprit(e) for e in wrong} - set(slips)
        self._doubtful |= {meant for e in wrong if (meant := self._meant_for(e)) is not None and meant not in renamed}
        for path, name in slips.items():
            self._rename(path, name)
        for error in wrong:
            if error["type"] == "extra_forbidden" and len(error["loc"]) == 1 and isinstance(error["input"], dict):
                key = (self._meant_for(error) or ("",))[0]
                self._dropped |= {(key,)} if key in _NAMED and key not in self._data else set()
        if () in culprits:
            return False
        self._leave_out(culprits)
        self._dropped |= culprits
        return True

    def _path(self, location: Location) -> DocumentPath:
        """Pydantic's location without the steps that only it knows (the tags of unions)."""
        path: DocumentPath = ()
        data: object = self._data
        kind: Any = self._concept
        for step in location:
            is_tag, kind = error_messages.is_tag(kind, step), error_messages.into(kind, step)
            if is_tag:
                continue
            if isinstance(data, dict) and str(step) in data:
                data = data[str(step)]
                path = (*path, str(step))
            elif isinstance(data, list) and isinstance(step, int) and step < len(data):
                data = data[step]
                path = (*path, step)
        return path

    def _missing(self, error: Error) -> DocumentPath:
        location: Location = error["loc"]
        return (*self._path(location[:-1]), location[-1])

    def _culprit(self, error: Error) -> DocumentPath:
        """The entry of a mapping to drop, or to put a stand-in for; empty when that would be everything."""
        path = self._path(error["loc"])
        if error["type"] == "missing":
            missing = self._missing(error)
            stand_ins = getattr(error_messages.at(self._concept, error["loc"][:-1]), "stand_ins", {})
            if missing[-1] in stand_ins:
                self._stand_ins.setdefault(missing, stand_ins[missing[-1]])
            path = missing if missing in self._stand_ins else self._path(error["loc"][:-1])
        return _entry(path)

    def _meant_for(self, error: Error) -> DocumentPath | None:
        """Where something is amiss because of an error: for an unknown key, that which it was meant for, if any."""
        path, location = self._path(error["loc"]), error["loc"]
        if error["type"] != "extra_forbidden":
            return self._culprit(error)
        known, written = error_messages.keys(self._concept, location[:-1]), str(location[-1])
        if error_messages.is_field(error["input"]) and "layout" in known:
            return (*path[:-1], "layout")
        there = error_messages.beside(self._document, path)
        name = suggestions.meant(written, known, there, error["input"])
        if name is None or name in there:
            name = next((key for key in self._by_value(error["input"]) if key in known and key not in there), None)
        return (*path[:-1], name) if name else path if error_messages.elsewhere(written, known) else None

    def _by_value(self, value: object) -> Iterator[str]:
        """Keys that may be meant by one that says nothing, for what stands behind it."""
        data = self._document.data
        if isinstance(value, int):
            yield "code"
        elif isinstance(value, str):
            yield from (
                key
                for key in ("address", "table", "type")
                if isinstance(data, dict) and value in self._names(f"{key}s")
            )
            yield from ("byte_order",) if value in ("big", "little") else ()
            yield from ("reply", "request") if value in (*self._names("layouts"), "echo", "none", "entry") else ()
        elif isinstance(value, dict) and {"at", "raw"} <= set(value):
            yield "selector"
        elif isinstance(value, dict):
            yield from ("request", "reply", "types", "layouts", "tables", "parameters", "addresses")

    def _names(self, key: str) -> Collection[str]:
        key = {"addresss": "addresses"}.get(key, key)
        found = self._document.data.get(key) if isinstance(self._document.data, dict) else None
        return found if isinstance(found, dict) else ()

    def _said(self, errors: list[Error]) -> Iterator[DocumentPath]:
        """The paths of the keys that unknown ones are words of other people for."""
        for error in errors:
            if error["type"] == "extra_forbidden" and (meant := self._meant_for(error)) is not None:
                yield meant

    def _slips(self, errors: list[Error]) -> Iterator[tuple[DocumentPath, str]]:
        """The unknown keys that are a slip of the pen for a key that is not there: they are read as that one."""
        for error in errors:
            if error["type"] == "extra_forbidden":
                path, written = self._path(error["loc"]), str(error["loc"][-1])
                name = near(written, error_messages.keys(self._concept, error["loc"][:-1]))
                if (
                    path
                    and name
                    and name == suggestions.meant(written, [name])
                    and (*path[:-1], name) not in self._document
                ):
                    yield path, name

    def _follows(self, error: Error, said: Collection[DocumentPath]) -> bool:
        """Whether an error is only there because of another, or because something has been dropped."""
        if error["type"] == "missing":
            missing = self._missing(error)
            there = (str(path[-1]) for path in self._dropped if path[:-1] == missing[:-1])
            return (
                missing in self._dropped
                or missing in said
                or any(key == MERGE or key.startswith(f"{missing[-1]}:") for key in there)
            )
        path = self._path(error["loc"])
        return error["type"] == "too_short" and any(lost[:-1] == path for lost in self._dropped)

    def _is_renamed(self, error: Error) -> bool:
        path = self._path(error["loc"])
        return any(path[: len(meant)] == meant for meant in self._document.renamed)

    def _leave_out(self, paths: Collection[DocumentPath]) -> None:
        self._own()
        for path in paths:
            owner = _owner(self._data, path)
            if path in self._stand_ins and isinstance(owner, dict):
                owner[path[-1]] = self._stand_ins[path]
            elif path and isinstance(owner, dict):
                owner.pop(path[-1], None)

    def _rename(self, path: DocumentPath, name: str) -> None:
        self._own()
        owner = _owner(self._data, path)
        if isinstance(owner, dict) and path[-1] in owner:
            owner[name] = owner.pop(path[-1])
            meant: DocumentPath = (*path[:-1], name)
            self._document.renamed[meant] = path

    def _own(self) -> None:
        if self._data is self._document.data:
            self._data = copy.deepcopy(self._data)


ROUNDS = 8
"""How often parts are dropped before giving up: a part without what it needs takes what holds it along."""


def _entry(path: DocumentPath) -> DocumentPath:
    """The entry of a mapping that a path leads into, with all of a list."""
    while path and not isinstance(path[-1], str):
        path = path[:-1]
    return path


def _second_ones(document: Document) -> Iterator[DocumentPath]:
    """The places of what is left out because something before it has the same name: what it is called is not known."""
    for finding in document.findings:
        first = re.search("first on line ([0-9]+)", finding.message) if finding.rule == "duplicate-key" else None
        at = finding.position
        name = at.text[at.column - 1 :][: at.length].strip("'\"")
        line = int(first[1]) if first else 0
        for key in _NAMED:
            if (key, name) in document and document.position((key, name), key=True).line == line:
                yield key, UNNAMED


_NAMED = ("addresses", "parameters", "settings", "effects", "types", "layouts", "tables", "commands")


def _before(document: Document, path: DocumentPath) -> DocumentPath:
    """The entry before a number without a value: `scale: 0,1` within braces is `scale: 0` and `1`."""
    owner = _owner(document.data, path)
    names = list(owner) if isinstance(owner, dict) else []
    if not (path and str(path[-1]).isdigit() and path[-1] in names[1:]):
        return ()
    return (*path[:-1], names[names.index(path[-1]) - 1])


def _owner(data: Any, path: DocumentPath) -> Any:
    for step in path[:-1]:
        inside = step in data if isinstance(data, dict) else isinstance(data, list) and isinstance(step, int)
        if not inside:
            return None
        data = data[step]
    return data
