"""What pydantic finds in a document, in words for its writer: where, what was expected, what to write instead."""

from __future__ import annotations

import functools
import re
import typing
from collections.abc import Mapping, Sequence
from decimal import Decimal
from types import UnionType
from typing import Annotated, Any, Union

from pydantic import BaseModel, Tag

from ..diagnostics.diagnostic import Diagnostic, DocumentPath
from ..document.document import Document
from . import aliases, suggestions
from .edition import CONCEPTS
from .golden_frames import GoldenFrames

Location = tuple[str | int, ...]
Error = dict[str, Any]

SECOND = ("subindex", "sub_index", "sub")
REMOTE = ("rtr", "is_remote", "remote_frame", "is_remote_frame")
TEXTS = ("string", "str", "text", "ascii", "chars", "char[]", "bytes", "bytearray", "hex")
READ_ONLY = ("read_only", "readonly", "ro")
"""What others call the second number of an index, a remote frame, a text, and an entry that cannot be written."""


def diagnostic(document: Document, concept: type[BaseModel], error: Error, path: DocumentPath) -> Diagnostic:
    """An error about what stands at a path, as a finding."""
    rule, message, hint, at_key = _told(document, concept, error, path)
    return document.finding(path, rule, message, hint, key=at_key)


def _told(document: Document, concept: type[BaseModel], error: Error, path: DocumentPath) -> tuple[str, str, str, bool]:
    """Rule, message and hint, and whether it is about the key."""
    location: Location = error["loc"]
    kind: str = error["type"]
    context: dict[str, Any] = error.get("ctx", {})
    written = error["input"]
    about_key = location[-1:] == ("[key]",)
    last = str(location[-1]) if location else ""
    if kind == "missing":
        return "missing-key", f"`{last}` is missing here", _describe(concept, location), True
    if kind == "by_missing":
        return "missing-key", error["msg"], aliases.by(written) or _describe(concept, (*location, "by")), True
    if kind == "extra_forbidden":
        return "unknown-key", f"unknown key `{last}`", _instead(document, concept, error, path), True
    if kind == "names_first":
        return "value", error["msg"], f"write {aliases.names_first(written)}", False
    if kind == "string_type":
        is_text = not _is_map_wanted(concept, location)
        mapped = "expected a name or a mapping here" if _is_scalar(written) else "a list cannot stand here"
        hint = aliases.named(written) or _describe(concept, location)
        if is_text and _is_scalar(written):
            hint = "put it in quotes"
        return "type", "expected a text here" if is_text else mapped, hint, about_key
    if kind in ("dict_type", "model_type", "model_attributes_type"):
        while location and str(location[-1]) not in map(str, path[-1:]):
            location = location[:-1]
        hint = aliases.named(written) or aliases.listed(written, last)
        if last == "selector" and str(written).lower() in ("none", "null", "no", "false", "id"):
            hint = "leave `selector` out where nothing in a frame tells its command"
        if location[:1] == ("parameters",) and len(location) == 2 and isinstance(written, (int, Decimal)):
            hint = f"{last}: {{number: {{}}}}; whoever uses the output gives the value"
        if last == "number" and isinstance(written, (int, Decimal)):
            hint = "number: {}, or with its limits, {min: 1, max: 10}; whoever uses the output gives the value"
        if last == "number":
            hint = hint or aliases.limits(written)
        if written is True and last.lower() in REMOTE:
            hint = "did you mean `remote`?"
        hint = hint or _describe(concept, location)
        return "type", "expected a mapping here", hint, False
    if kind == "list_type":
        shown = _as_written(document, path, written)
        hint = f"write [{shown}]" if _is_scalar(written) else _describe(concept, location)
        hint = f"a dash has a space behind it: `- {shown[1:]}`" if re.match("-[A-Za-z]", shown) else hint
        return "type", "expected a list here", hint, False
    if kind == "bool_type":
        hint = f"write {aliases.truth(written)}" if aliases.truth(written) else "write true or false"
        is_text = isinstance(written, str)
        return "value", f"`{written}` is not true or false", f"{hint}, without quotes" if is_text else hint, False
    if kind in ("literal_error", "enum"):
        return "value", *_not_one_of(error), about_key
    if kind == "string_pattern_mismatch":
        return *_misspelt(document, path, error, about_key), about_key
    if kind in ("int_type", "int_parsing", "int_from_float"):
        message = (
            f"`{_as_yaml(written)}` is not a whole number" if _is_scalar(written) else "expected a whole number here"
        )
        return "value", message, suggestions.integer(written), False
    if kind in ("less_than_equal", "greater_than_equal"):
        limit = f"more than {context['le']}, the most" if "le" in context else f"less than {context['ge']}, the least"
        hint = aliases.mask(written) if "flags" in location else ""
        if "bit_rates_kbps" in location and "le" in context and written % 1000 == 0:
            hint = f"{written} bit/s are {written // 1000} kbit/s: write {written // 1000}"
        message = f"{_as_written(document, path, written)} is {limit} that can be here"
        return "value", message, hint or _describe(concept, location), False
    if kind == "too_short":
        return "value", "this is empty; at least one is needed here", _describe(concept, location), False
    if kind == "string_too_short":
        return "value", "this text is empty", "write one, or leave the key out", about_key
    if kind in ("string_too_long", "too_long"):
        there, most = len(written), context["max_length"]
        of = "characters" if kind == "string_too_long" else "of them"
        return "value", f"there are {there} {of} here, more than {most}", "shorten it", about_key
    message = error["msg"].removeprefix("Value error, ")
    types = document.data.get("types") if isinstance(document.data, dict) else None
    if "is not a raw format" in message and isinstance(types, dict) and written in types:
        return "value", message, f"`{written}` is a type: write `type: {written}`", False
    if "is not a raw format" in message and str(written).lower() in TEXTS:
        return "value", message, "a text is an array of bytes: raw: u8, array: 1..7", False
    hint = aliases.notation(written, message, str(path[-1]) if path else "") or (
        _describe(concept, location) if not _is_scalar(written) else ""
    )
    return "value", message[0].lower() + message[1:], hint, about_key


def _misspelt(document: Document, path: DocumentPath, error: Error, about_key: bool) -> tuple[str, str, str]:
    """Rule, message and hint for a text that is not as its pattern wants it."""
    pattern, text = error["ctx"]["pattern"], error["input"]
    if pattern == suggestions.VISIBLE:
        return "value", "this text is blank", "write one, or leave the key out"
    shown = _as_written(document, path, text, about_key) if about_key else text
    if not text:
        return "value", "this text is empty", "write one, or leave the key out"
    if pattern == suggestions.DATE:
        return "value", f"`{shown}` is not a date", suggestions.date(text)
    return "name", f"`{shown}` is not a name that can be used here", suggestions.name(text, pattern)


def _as_written(document: Document, path: DocumentPath, value: object, about_key: bool = False) -> str:
    """A number as it stands in the file: 0x80 and not 128."""
    at = document.position(path, key=about_key)
    text = at.text[at.column - 1 :][: at.length].strip("'\"")
    is_number = about_key or (isinstance(value, (int, Decimal)) and not isinstance(value, bool))
    return text if is_number and text and len(text) < 40 else str(value)


def _instead(document: Document, concept: type[BaseModel], error: Error, path: DocumentPath) -> str:
    """What to write in place of an unknown key."""
    location: Location = error["loc"]
    owner, last, value = at(concept, location[:-1]), str(location[-1]), error["input"]
    keys = list(owner.model_fields) if owner else []
    within = next((called for concept_, called in CONCEPTS.items() if concept_ is owner), "")
    number, raw = beside(document, path).get("index"), beside(document, path).get("raw")
    if str(raw).lower() in TEXTS and "array" in keys and isinstance(value, int):
        return f"did you mean `array`? array: 1..{value}"
    if last in SECOND and "index" in keys and isinstance(number, int) and isinstance(value, int):
        return f"a second number stands behind the first: index: [0x{number:04X}, {value}]"
    if last in READ_ONLY and value is True and "commands" in keys:
        return "say which commands have it: commands: [READ], by the name of the one that reads"
    if is_field(value) and {"layout", "fields"} <= set(keys):
        return f"a field stands in `layout` here: {{layout: {{{last}: …}}, dlc: …}}"
    if is_field(value) and within == "a layout":
        return "a field stands in `fields`; indent it further"
    if is_field(value) and within == "a command":
        return "a field stands in `request` or `reply`; indent it further"
    if isinstance(value, dict) and {"code", "reply"} & set(value) and within in ("a command", "the edition"):
        return f"a command stands in `commands`; indent it {'less' if within == 'a command' else 'further'}"
    if within == "the edition" and last in GoldenFrames.model_fields and "commands" in beside(document, path):
        return GoldenFrames.mistaken[2]
    return suggestions.key(last, keys, beside(document, path), elsewhere(last, keys), _within(owner, last), value)


def _within(owner: type[BaseModel] | None, key: str) -> str:
    """The key of a concept that holds another, which has this key."""
    for name, field in owner.model_fields.items() if owner else ():
        inner = _concept(field.annotation)
        if inner and _outermost(field.annotation) not in (dict, list) and key in inner.model_fields:
            return name
    return ""


def is_field(value: object) -> bool:
    """Whether this is a field, by its keys."""
    return isinstance(value, dict) and "at" in value


def beside(document: Document, path: DocumentPath) -> Mapping[str, Any]:
    """A key and those that stand beside it, with their values."""
    owner: Any = document.data
    for step in path[:-1]:
        there = isinstance(owner, list) or (isinstance(owner, dict) and step in owner)
        owner = owner[step] if there else None
    return owner if isinstance(owner, dict) else {}


def elsewhere(key: str, known: Sequence[str]) -> list[str]:
    """The concepts that have a key which stands where it does not belong."""
    owners = {
        name: [called for concept, called in CONCEPTS.items() if name in concept.model_fields]
        for name in suggestions.words_for(key)
    }
    return next((called for name, called in owners.items() if called and name not in known), [])


def _not_one_of(error: Error) -> tuple[str, str]:
    expected: str = error["ctx"]["expected"]
    value = error["input"]
    known, written = re.findall(r"'([^']*)'", expected), _as_yaml(value)
    if not _is_scalar(error["input"]):
        return "expected one word here", f"one of {', '.join(known)}" if known else f"write {expected}"
    if known:
        return (
            f"`{written}` is not {'one of ' if len(known) > 1 else ''}{expected}",
            f"write {suggestions.word(written, known)}",
        )
    if isinstance(error["input"], str) and written == expected:
        return f"the text `{written}` is not the number {expected}", f"write {expected}, without quotes"
    return f"`{written}` is not {expected}", f"write {expected}"


def _as_yaml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _is_scalar(value: object) -> bool:
    return not isinstance(value, (dict, list))


def _is_map_wanted(concept: type[BaseModel], location: Location) -> bool:
    """Whether fields could stand where there is a list, and not only a text."""
    return location[-1:] == ("name",) and at(concept, location[:-1]) is not None


def is_tag(kind: Any, step: str | int) -> bool:
    """Whether a step of a location only says which of several forms a value has."""
    if typing.get_origin(kind) is Annotated:
        return is_tag(typing.get_args(kind)[0], step)
    forms = typing.get_args(kind) if typing.get_origin(kind) in (Union, UnionType) else ()
    tags = [m.tag for form in forms for m in typing.get_args(form)[1:] if isinstance(m, Tag)]
    return step in tags if tags else any(is_tag(form, step) for form in forms)


def into(kind: Any, step: str | int) -> Any:
    """The type that one step of a location leads to: a key, an index, or the tag of a union."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is Annotated:
        return into(arguments[0], step)
    if origin in (Union, UnionType):
        tagged = (a for a in arguments if any(isinstance(m, Tag) and m.tag == step for m in typing.get_args(a)[1:]))
        plain = (into(a, step) for a in arguments if a is not type(None))
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
    if typing.get_origin(kind) is None and isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    found = (_concept(a) for a in typing.get_args(kind))
    return next((c for c in found if c is not None), None)


def at(concept: type[BaseModel], location: Location) -> type[BaseModel] | None:
    """The concept that a location leads to."""
    return _concept(functools.reduce(into, location, concept))


def keys(concept: type[BaseModel], location: Location) -> list[str]:
    """The keys of the concept that a location leads to."""
    found = at(concept, location)
    return list(found.model_fields) if found else []


def _describe(concept: type[BaseModel], location: Location) -> str:
    """The description of the key that a location ends with, or nearest to its end; of what has a name, an example."""
    for end in range(len(location), 0, -1):
        found = at(concept, location[: end - 1])
        key = str(location[end - 1])
        if found and key in found.model_fields:
            field = found.model_fields[key]
            example = next(iter(field.examples or ()), None) or _example(concept, location[:end])
            shown = f" Like {suggestions.flow(example)}" if isinstance(example, (dict, list)) else ""
            return f"{field.description or ''}{shown}"
        example = _example(concept, location[:end])
        if example and end == len(location):
            return f"Like {key}: {suggestions.flow(example)}"
    return "" if location else "`canwright: 1` comes first, on a line of its own"


def _example(concept: type[BaseModel], location: Location) -> object:
    """How the concept at a location is written; under a name, where there are several by name."""
    kind: Any = functools.reduce(into, location, concept)
    found = _concept(kind)
    example = suggestions.EXAMPLES.get(found.__name__) if found else None
    if example and _outermost(kind) is dict:
        return {"NAME": example}
    return [example] if example and _outermost(kind) is list else example


def _outermost(kind: Any) -> Any:
    """`dict` or `list`, of a type that is one, once annotations are off."""
    origin = typing.get_origin(kind)
    if origin in (Union, UnionType):
        return next((dict for part in typing.get_args(kind) if _outermost(part) is dict), None)
    return _outermost(typing.get_args(kind)[0]) if origin is Annotated else origin
