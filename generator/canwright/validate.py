"""A document against the language: pydantic's findings, put where they are and into words for the writer."""

from __future__ import annotations

import copy
import functools
import itertools
import re
import typing
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Generic, TypeVar, Union

from pydantic import BaseModel, Tag, ValidationError

from . import hints
from .diagnostics import MOST_FINDINGS, Diagnostic, SpecError, near
from .model import Path
from .scalars import MERGE
from .schema_types import Type
from .source import Document

M = TypeVar("M", bound=BaseModel)

Location = tuple[str | int, ...]


def validate(document: Document, concept: type[M]) -> M:
    """The document as an instance of `concept`. Raises SpecError with every structural finding."""
    found = validate_parts(document, concept)
    if found.diagnostics or found.spec is None:
        raise SpecError(found.diagnostics)
    return found.spec


@dataclass(frozen=True)
class Validated(Generic[M]):
    """What of a document could be read: without the parts at `dropped`; None when too little is left."""

    spec: M | None
    diagnostics: tuple[Diagnostic, ...]
    dropped: frozenset[Path]


def validate_parts(document: Document, concept: type[M]) -> Validated[M]:
    """As much of the document as is right, and every structural finding, so that one run tells all."""
    data: Any = document.data
    diagnostics = tuple(document.findings)
    dropped = {_entry(path) for path in document.spoilt}
    if dropped:
        data = copy.deepcopy(data)
        for path in dropped:
            _drop(data, path)
    for attempt in range(0 if () in dropped else ROUNDS):
        try:
            return Validated(concept.model_validate(data), diagnostics, frozenset(dropped))
        except ValidationError as error:
            errors = [dict(e) for e in error.errors()]
        data = copy.deepcopy(data) if data is document.data else data
        meant = dict(_meant(document, concept, errors))
        renamed = {(*path[:-1], name) for path, name in meant.items()}
        wrong = [e for e in errors if e["type"] != "missing" or _missing(document, e) not in renamed]
        if attempt == 0:
            told = (e for e in wrong if not _follows(document, e, dropped))
            diagnostics += tuple(_diagnostic(document, concept, e) for e in itertools.islice(told, MOST_FINDINGS))
        for path, name in meant.items():
            _rename(document, data, path, name)
        culprits = {_culprit(document, e) for e in wrong} - set(meant)
        if () in culprits:
            break
        for path in culprits:
            _drop(data, path)
        dropped |= culprits
    return Validated(None, diagnostics, frozenset(dropped))


def _follows(document: Document, error: dict[str, Any], dropped: Collection[Path]) -> bool:
    """Whether an error is only there because something has been dropped."""
    location: Location = error["loc"]
    if error["type"] == "missing":
        missing = _missing(document, error)
        return missing in dropped or (*missing[:-1], MERGE) in dropped
    return error["type"] == "too_short" and any(path[:-1] == _path(document, location) for path in dropped)


ROUNDS = 8
"""How often parts are dropped before giving up: a part without what it needs takes what holds it along."""


def _culprit(document: Document, error: dict[str, Any]) -> Path:
    """The entry of a mapping to drop for an error; empty when that would be everything."""
    location: Location = error["loc"]
    path = _path(document, location)
    if error["type"] == "missing":
        path = _path(document, location[:-1])
    return _entry(path)


def _entry(path: Path) -> Path:
    """The entry of a mapping that a path leads into, with all of a list."""
    while path and not isinstance(path[-1], str):
        path = path[:-1]
    return path


def _missing(document: Document, error: dict[str, Any]) -> Path:
    location: Location = error["loc"]
    return (*_path(document, location[:-1]), location[-1])


def _meant(document: Document, concept: type[BaseModel], errors: list[dict[str, Any]]) -> Iterator[tuple[Path, str]]:
    """The unknown keys that are a slip of the pen for a key that is not there: they are read as that one."""
    for error in errors:
        if error["type"] == "extra_forbidden":
            location: Location = error["loc"]
            path = _path(document, location)
            name = near(str(location[-1]), _keys(concept, location[:-1]))
            if path and name and (*path[:-1], name) not in document:
                yield path, name


def _rename(document: Document, data: Any, path: Path, name: str) -> None:
    owner = _owner(data, path)
    if isinstance(owner, dict) and path[-1] in owner:
        owner[name] = owner.pop(path[-1])
        meant: Path = (*path[:-1], name)
        document.renamed[meant] = path


def _drop(data: Any, path: Path) -> None:
    owner = _owner(data, path)
    if path and isinstance(owner, dict):
        owner.pop(path[-1], None)


def _owner(data: Any, path: Path) -> Any:
    for step in path[:-1]:
        inside = step in data if isinstance(data, dict) else isinstance(data, list) and isinstance(step, int)
        if not inside:
            return None
        data = data[step]
    return data


def _diagnostic(document: Document, concept: type[BaseModel], error: dict[str, Any]) -> Diagnostic:
    location: Location = error["loc"]
    kind: str = error["type"]
    context: dict[str, Any] = error.get("ctx", {})
    about_key = location[-1:] == ("[key]",)
    path = _path(document, location)
    last = str(location[-1]) if location else ""
    if kind == "missing":
        return document.finding(
            path, "missing-key", f"`{last}` is missing here", _describe(concept, location), key=True
        )
    if kind == "extra_forbidden":
        return document.finding(path, "unknown-key", f"unknown key `{last}`", _instead(concept, error), key=True)
    if kind == "string_type":
        hint = "put it in quotes" if not isinstance(error["input"], (dict, list)) else _describe(concept, location)
        return document.finding(path, "type", "expected a text here", hint, key=about_key)
    if kind in ("dict_type", "model_type"):
        return document.finding(path, "type", "expected a mapping here", _describe(concept, location))
    if kind == "list_type":
        return document.finding(path, "type", "expected a list here", _describe(concept, location))
    if kind in ("literal_error", "enum"):
        return _not_one_of(document, path, error, about_key)
    if kind == "string_pattern_mismatch":
        message = f"`{error['input']}` is not a name that can be used here"
        return document.finding(path, "name", message, hints.name(error["input"], context["pattern"]), key=about_key)
    if kind in ("int_type", "int_parsing", "int_from_float"):
        message, hint = f"`{error['input']}` is not a whole number", hints.integer(error["input"])
        return document.finding(path, "value", message if _is_scalar(error) else "expected a whole number here", hint)
    if kind in ("less_than_equal", "greater_than_equal"):
        limit = f"more than {context['le']}, the most" if "le" in context else f"less than {context['ge']}, the least"
        message = f"{error['input']} is {limit} that can be here"
        return document.finding(path, "value", message, _describe(concept, location))
    if kind == "too_short":
        return document.finding(
            path, "value", "this is empty; at least one is needed here", _describe(concept, location)
        )
    if kind == "string_too_long":
        message = f"this has {len(str(error['input']))} characters, {context['max_length']} is the most"
        return document.finding(path, "value", message, "write it shorter", key=about_key)
    message = error["msg"].removeprefix("Value error, ")
    return document.finding(path, "value", message[0].lower() + message[1:], _near_raw(error), key=about_key)


def _instead(concept: type[BaseModel], error: dict[str, Any]) -> str:
    """What to write in place of an unknown key."""
    location: Location = error["loc"]
    keys, last = _keys(concept, location[:-1]), str(location[-1])
    if isinstance(error["input"], dict) and "at" in error["input"] and {"layout", "fields"} <= set(keys):
        return f"a field stands in `layout` here: {{layout: {{{last}: …}}, dlc: …}}"
    if {"at", "type"} <= set(keys) and last in Type.model_fields:
        return f"`{last}` is said of a type: write a type with it under `types`, and `type: NAME` here"
    return hints.key(last, keys)


def _not_one_of(document: Document, path: Path, error: dict[str, Any], about_key: bool) -> Diagnostic:
    expected: str = error["ctx"]["expected"]
    known, written = re.findall(r"'([^']*)'", expected), str(error["input"])
    if not _is_scalar(error):
        message, hint = "expected one word here", f"one of {', '.join(known)}" if known else f"write {expected}"
    elif known:
        message, hint = f"`{written}` is not one of {expected}", f"write {hints.word(written, known)}"
    else:
        message = f"`{written}` is not {expected}"
        hint = f"write {expected}, without quotes" if isinstance(error["input"], str) else f"write {expected}"
    return document.finding(path, "value", message, hint, key=about_key)


def _near_raw(error: dict[str, Any]) -> str:
    meant = hints.raw_format(str(error["input"])) if "is not a raw format" in error["msg"] else ""
    return f"did you mean `{meant}`?" if meant else ""


def _is_scalar(error: dict[str, Any]) -> bool:
    return not isinstance(error["input"], (dict, list))


def _path(document: Document, location: Location) -> Path:
    """Pydantic's location without the steps that only it knows (the tags of unions)."""
    path: Path = ()
    data: object = document.data
    for step in location:
        if isinstance(data, dict) and str(step) in data:
            data = data[str(step)]
            path = (*path, str(step))
        elif isinstance(data, list) and isinstance(step, int) and step < len(data):
            data = data[step]
            path = (*path, step)
    return path


def _into(kind: Any, step: str | int) -> Any:
    """The type that one step of a location leads to: a key, an index, or the tag of a union."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is Annotated:
        return _into(arguments[0], step)
    if origin in (Union, UnionType):
        tagged = (a for a in arguments if any(isinstance(m, Tag) and m.tag == step for m in typing.get_args(a)[1:]))
        plain = (_into(a, step) for a in arguments if a is not type(None))
        return next(tagged, None) or next(plain, None)
    if origin is dict:
        return arguments[1]
    if origin is list:
        return arguments[0]
    if isinstance(kind, type) and issubclass(kind, BaseModel) and step in kind.model_fields:
        return kind.model_fields[str(step)].annotation
    return None


def _concept(kind: Any) -> type[BaseModel] | None:
    """The concept that a type stands for, once optionals and annotations are off."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    found = (_concept(a) for a in typing.get_args(kind))
    return next((c for c in found if c is not None), None)


def _at(concept: type[BaseModel], location: Location) -> type[BaseModel] | None:
    return _concept(functools.reduce(_into, location, concept))


def _keys(concept: type[BaseModel], location: Location) -> list[str]:
    found = _at(concept, location)
    return list(found.model_fields) if found else []


def _describe(concept: type[BaseModel], location: Location) -> str:
    """The description of the key that a location ends with, or nearest to its end."""
    for end in range(len(location), 0, -1):
        found = _at(concept, location[: end - 1])
        key = str(location[end - 1])
        if found and key in found.model_fields:
            field = found.model_fields[key]
            example = next(iter(field.examples or ()), None)
            shown = f" Like {hints.flow(example)}" if isinstance(example, (dict, list)) else ""
            return f"{field.description or ''}{shown}"
    return ""
