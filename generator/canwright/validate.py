"""A document against the language: pydantic's findings, put where they are and into words for the writer."""

from __future__ import annotations

import functools
import typing
from types import UnionType
from typing import Annotated, Any, TypeVar, Union

from pydantic import BaseModel, Tag, ValidationError

from .diagnostics import Diagnostic, SpecError, nearest
from .model import Path
from .source import Document

M = TypeVar("M", bound=BaseModel)

Location = tuple[str | int, ...]


def validate(document: Document, concept: type[M]) -> M:
    """The document as an instance of `concept`. Raises SpecError with every structural finding."""
    try:
        return concept.model_validate(document.data)
    except ValidationError as error:
        raise SpecError([_diagnostic(document, concept, dict(e)) for e in error.errors()]) from None


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
        return document.finding(
            path, "unknown-key", f"unknown key `{last}`", nearest(last, _keys(concept, location[:-1])), key=True
        )
    if kind == "string_type":
        hint = "put it in quotes" if not isinstance(error["input"], (dict, list)) else ""
        return document.finding(path, "type", "expected a text here", hint, key=about_key)
    if kind in ("dict_type", "model_type"):
        return document.finding(path, "type", "expected a mapping here", _describe(concept, location))
    if kind in ("literal_error", "enum"):
        return document.finding(path, "value", f"`{error['input']}` is not one of {context['expected']}", key=about_key)
    if kind == "string_pattern_mismatch":
        message = f"`{error['input']}` is not a name that can be used here"
        return document.finding(path, "name", message, f"it has to match {context['pattern']}", key=about_key)
    message = error["msg"].removeprefix("Value error, ")
    return document.finding(path, "value", message[0].lower() + message[1:], key=about_key)


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
            return found.model_fields[key].description or ""
    return ""
