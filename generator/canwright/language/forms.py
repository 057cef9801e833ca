"""Forms of values: each decodes plain data and knows its JSON Schema."""

from __future__ import annotations

import functools
import re
import types
import typing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from typing import Annotated, Any, Literal, NamedTuple, Union

from ..diagnostics.diagnostic import DocumentPath
from . import aliases, notation, suggestions
from .concept import Choose, Concept, Declared, JsonSchema, Limits, Notation, keys, metadata, per_concept
from .findings import Findings

INVALID: Any = object()
"""In place of a value that could not be decoded; there is a finding about it."""


class Place(NamedTuple):
    """Where a value stands: its path, the nearest key of a concept, and whether the value is itself a key."""

    path: DocumentPath
    key: Declared | None = None
    is_key: bool = False

    def at(self, step: str | int, key: Declared | None = None) -> Place:
        return Place((*self.path, step), key or self.key)

    @property
    def last(self) -> str:
        return str(self.path[-1]) if self.path else ""


class Form:
    """How one kind of value is decoded."""

    example: Any = None
    """How a concept in this form is written; None without a concept."""

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        """The value; INVALID after a finding."""
        raise NotImplementedError

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        """The JSON Schema; concepts are added to `definitions`."""
        raise NotImplementedError

    def describe(self, place: Place) -> str:
        """The description of the nearest key, and an example."""
        if place.key is None:
            return "`canwright: 1` comes first, on a line of its own" if not place.path else ""
        if place.last == place.key.name or not isinstance(place.path[-1], str) or not self.example:
            examples = place.key.key.examples
            example = examples[0] if examples else self.example if place.last == place.key.name else None
            shown = f" Like {aliases.flow(example)}" if isinstance(example, (dict, list)) else ""
            return place.key.key.description + shown
        return f"Like {place.last}: {aliases.flow(self.example)}"

    def _type(self, report: Findings, place: Place, message: str, hint: str = "") -> Any:
        report.finding(place.path, "type", message, hint or self.describe(place), key=place.is_key)
        return INVALID

    def _value(self, report: Findings, place: Place, message: str, hint: str = "") -> Any:
        report.finding(place.path, "value", message, hint, key=place.is_key)
        return INVALID


@dataclass(frozen=True)
class Text(Form):
    """A text, or a name with a pattern."""

    limits: Limits

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if not isinstance(data, str):
            return self._type(report, place, "expected a text here", "put it in quotes" if is_scalar(data) else "")
        limits = self.limits
        if not data and (limits.min_length or limits.pattern):
            return self._value(report, place, "this text is empty", "write one, or leave the key out")
        if limits.max_length is not None and len(data) > limits.max_length:
            message = f"{len(data)} characters exceed the maximum of {limits.max_length}"
            return self._value(report, place, message, "shorten it")
        if limits.pattern is None or re.search(_pattern(limits.pattern), data):
            return data
        if limits.pattern == suggestions.VISIBLE:
            return self._value(report, place, "this text is blank", "write one, or leave the key out")
        if limits.pattern == suggestions.DATE:
            return self._value(report, place, f"`{data}` is not a date", suggestions.date(data))
        shown = report.written(place.path, data, key=True) if place.is_key else data
        hint = suggestions.name(data, limits.pattern)
        report.finding(place.path, "name", f"`{shown}` is not a valid name here", hint, key=place.is_key)
        return INVALID

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "string", **_limits(self.limits, "Length")}


@functools.cache
def _pattern(pattern: str) -> re.Pattern[str]:
    return re.compile(re.sub(r"\$$", r"\\Z", pattern))


@dataclass(frozen=True)
class Integer(Form):
    """A whole number."""

    limits: Limits

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if not isinstance(data, int) or isinstance(data, bool):
            shown = suggestions.as_yaml(data)
            text = f"`{shown}` is not a whole number" if is_scalar(data) else "expected a whole number here"
            return self._value(report, place, text, suggestions.integer(data))
        low, high = self.limits.ge, self.limits.le
        if low is not None and data < low:
            shown = report.written(place.path, data)
            return self._value(report, place, f"{shown} is below the minimum of {low}", self.describe(place))
        if high is not None and data > high:
            hint = aliases.limit(data, place.path) or self.describe(place)
            shown = report.written(place.path, data)
            return self._value(report, place, f"{shown} exceeds the maximum of {high}", hint)
        return data

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        bounds = {"minimum": self.limits.ge, "maximum": self.limits.le}
        return {"type": "integer", **{key: bound for key, bound in bounds.items() if bound is not None}}


class Truth(Form):
    """`true` or `false`."""

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if isinstance(data, bool):
            return data
        hint = f"write {aliases.truth(data) or 'true or false'}"
        hint += ", without quotes" if isinstance(data, str) else ""
        return self._value(report, place, f"`{data}` is not true or false", hint)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "boolean"}


@dataclass(frozen=True)
class Words(Form):
    """One of a few words, or of numbers."""

    words: Mapping[Any, Any]

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if is_scalar(data) and not isinstance(data, bool) and data in self.words:
            return self.words[data]
        listed = [f"`{word}`" for word in self.words]
        expected = " or ".join(part for part in (", ".join(listed[:-1]), listed[-1]) if part)
        texts = [word for word in self.words if isinstance(word, str)]
        if not is_scalar(data):
            message, hint = "expected one word here", f"write {expected}"
        elif texts:
            message = f"`{suggestions.as_yaml(data)}` is not {expected}"
            hint = f"write {suggestions.word(suggestions.as_yaml(data), texts)}"
        else:
            quoted = isinstance(data, str) and data in map(str, self.words)
            message = f"the text `{data}` is not the number" if quoted else f"`{suggestions.as_yaml(data)}` is not"
            message, hint = f"{message} {expected}", f"write {expected}{', without quotes' if quoted else ''}"
        return self._value(report, place, message, hint)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        words = list(self.words)
        kind = "string" if isinstance(words[0], str) else "integer"
        return {"const": words[0], "type": kind} if len(words) == 1 else {"enum": words, "type": kind}


@dataclass(frozen=True)
class Written(Form):
    """A value in a notation."""

    notation: Notation

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        takes = isinstance(data, (str, int, Decimal)) and (self.notation.any_scalar or not isinstance(data, bool))
        try:
            if not takes:
                raise ValueError(f"expected {self.notation.expected}")
            if len(str(data)) > notation.LONGEST:
                raise ValueError(
                    f"this is longer than {notation.LONGEST} characters; expected {self.notation.expected}"
                )
            return self.notation.parse(data if self.notation.any_scalar else str(data))
        except ValueError as error:
            hint = aliases.notation(data, str(error), place.last) if len(str(data)) <= notation.LONGEST else ""
            hint = f"`{data}` is a type: write `type: {data}`" if place.last == "raw" and report.is_type(data) else hint
            return self._value(report, place, str(error), hint or ("" if is_scalar(data) else self.describe(place)))

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return dict(self.notation.schema)


@dataclass(frozen=True)
class Items(Form):
    """A list."""

    item: Form
    limits: Limits

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", [self.item.example] if self.item.example else None)

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if not isinstance(data, list):
            shown = report.written(place.path, data)
            hint = f"write [{shown}]" if is_scalar(data) else ""
            hint = f"a dash has a space behind it: `- {shown[1:]}`" if re.match("-[A-Za-z]", shown) else hint
            return self._type(report, place, "expected a list here", hint)
        if not _has_room(self, report, data, place, self.limits):
            return INVALID
        items = ((place.at(i), one) for i, one in enumerate(data))
        decoded = [self.item.decode(report, one, at) for at, one in items if not report.is_unreadable(at.path)]
        return [one for one in decoded if one is not INVALID]

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "array", "items": self.item.schema(definitions), **_limits(self.limits, "Items")}


@dataclass(frozen=True)
class Names(Form):
    """A mapping of names that the author chooses."""

    name: Form
    value: Form
    limits: Limits

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", {"NAME": self.value.example} if self.value.example else None)

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if not isinstance(data, dict):
            hint = aliases.named(data) or aliases.listed(data, place.last) or aliases.mapping(data, place.path)
            return self._type(report, place, "expected a mapping here", hint)
        if self._is_reversed(data):
            text = "names come first here, followed by their values"
            return self._value(report, place, text, f"write {aliases.names_first(data)}")
        if report.has_unreadable_key(place.path, data) and not data:
            return INVALID
        if not _has_room(self, report, data, place, self.limits):
            return INVALID
        decoded = {}
        for name, value in data.items():
            here = place.at(name)
            if not report.is_unreadable(here.path):
                known = self.name.decode(report, name, Place(here.path, place.key, is_key=True))
                found = self.value.decode(report, value, here)
                if known is not INVALID and found is not INVALID:
                    decoded[known] = found
        return decoded if decoded or not data else INVALID

    def _is_reversed(self, data: dict[str, Any]) -> bool:
        """Whether numbers stand in place of names, and names in place of numbers."""
        is_named = isinstance(self.name, Text) and not re.search(_pattern(self.name.limits.pattern or ""), "0")
        return is_named and bool(data) and all(n.isdigit() and isinstance(value, str) for n, value in data.items())

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        name, value = self.name.schema(definitions), self.value.schema(definitions)
        limits = _limits(self.limits, "Properties")
        names = {key: part for key, part in name.items() if key not in ("pattern", "type")}
        shared: JsonSchema = {"type": "object", **({"propertyNames": names} if names else {}), **limits}
        if "pattern" not in name:
            return {**shared, "additionalProperties": value}
        return {**shared, "patternProperties": {name["pattern"]: value}, "additionalProperties": False}


@dataclass(frozen=True)
class Mapped(Form):
    """A concept."""

    concept: type[Concept]

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", self.concept.example or None)

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if not isinstance(data, dict):
            hint = aliases.named(data) or aliases.mapping(data, place.path)
            return self._type(report, place, "expected a mapping here", hint)
        known, cases = declared(self.concept), self.concept.cases
        if cases and "by" not in data:
            text = "`by` is missing here"
            report.finding(place.path, "missing-key", text, aliases.by(data) or _about(*known["by"]), key=True)
            return INVALID
        values: dict[str, Any] = {}
        meant = self._unknown(report, data, place, values) if not cases else set()
        for name, (key, form) in known.items():
            if name in data:
                if not report.is_unreadable((*place.path, name)):
                    values[name] = form.decode(report, data[name], place.at(name, key))
            elif key.required and name not in meant:
                text = f"`{name}` is missing here"
                report.finding(place.path, "missing-key", text, _about(key, form), key=True, about=name)
        if cases:
            form = _rest(self.concept)
            rest = {name: value for name, value in data.items() if name not in known}
            values[cases] = form.decode(report, rest, place)
        return self._made(report, {name: value for name, value in values.items() if value is not INVALID})

    def _unknown(self, report: Findings, data: dict[str, Any], place: Place, values: dict[str, Any]) -> set[str]:
        """Reports unknown keys; the keys that they stand for. A slip of the pen is read as the key it is near to."""
        known = declared(self.concept)
        meant = set(known) if report.has_unreadable_key(place.path, data) else set()
        for name, value in data.items():
            if name in known:
                continue
            here = place.at(name)
            if report.is_unreadable(here.path):
                meant |= {key for key in known if name.startswith(key)}
                continue
            slip = suggestions.slip(name, known, data)
            hint = suggestions.unknown_key(self.concept, name, value, data)
            report.finding(here.path, "unknown-key", f"unknown key `{name}`", hint, key=True)
            before = len(report.invalid)
            if slip and slip not in values:
                key, form = known[slip]
                values[slip] = form.decode(report, value, place.at(name, key))
            stands_for = {slip} if slip else set(suggestions.all_meant(self.concept, name, value, data))
            meant |= stands_for
            if not slip or len(report.invalid) > before:
                report.invalid |= {(*place.path, one) for one in stands_for}
        return meant

    def _made(self, report: Findings, values: dict[str, Any]) -> Any:
        """The concept, with values of its example in place of invalid ones that it needs."""
        for name, (key, form) in declared(self.concept).items():
            if key.required and name not in values:
                if name not in self.concept.example:
                    return INVALID
                example = self.concept.example[name]
                is_empty = example in ({}, [])
                values[name] = example if is_empty else form.decode(report, example, Place(("", name), key))
        return self.concept(**values) if not self.concept.cases or self.concept.cases in values else INVALID

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        if self.concept.__name__ not in definitions:
            definitions[self.concept.__name__] = {}
            definitions[self.concept.__name__] = self.body(definitions)
        return {"$ref": f"#/$defs/{self.concept.__name__}"}

    def body(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        """The schema of the concept itself."""
        known = declared(self.concept)
        required = [name for name, (key, _) in known.items() if key.required]
        rest = _rest(self.concept).value.schema(definitions) if self.concept.cases else False
        return {
            "title": self.concept.__name__,
            "description": (self.concept.__doc__ or "").replace("\n    ", "\n").strip(),
            "type": "object",
            "properties": {name: _of_key(key, form, definitions) for name, (key, form) in known.items()},
            **({"required": required} if required else {}),
            "additionalProperties": rest,
            **self.concept.schema_extra,
        }


@dataclass(frozen=True)
class Either(Form):
    """Several forms; the shape of the data decides."""

    scalars: Sequence[Form]
    lists: Sequence[Form]
    mappings: Sequence[Form]
    choose: Choose | None

    def __post_init__(self) -> None:
        examples = (form.example for form in (*self.mappings, *self.lists) if form.example)
        object.__setattr__(self, "example", next(examples, None))

    def decode(self, report: Findings, data: Any, place: Place) -> Any:
        if isinstance(data, dict) and self.mappings:
            index = self.choose.which(data) if self.choose else 0
            return self.mappings[index].decode(report, data, place)
        if isinstance(data, list) and self.lists:
            return self.lists[0].decode(report, data, place)
        if not self.scalars:
            return (*self.mappings, *self.lists)[0].decode(report, data, place)
        words = (form for form in self.scalars if isinstance(form, Words) and is_scalar(data) and data in form.words)
        wanted = Integer if isinstance(data, int) else (Text, Written)
        fitting = (form for form in self.scalars if isinstance(form, wanted))
        form = next(words, None) or next(fitting, None) or self.scalars[-1]
        if isinstance(form, Text) and self.example and not isinstance(data, str):
            text = "expected a name or a mapping here" if is_scalar(data) else "a list cannot stand here"
            return self._type(report, place, text, aliases.named(data))
        return form.decode(report, data, place)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        overlap = any(isinstance(form, Written) and form.notation.any_scalar for form in self.scalars)
        forms = [form.schema(definitions) for form in (*self.scalars, *self.lists, *self.mappings)]
        return {"anyOf" if overlap else "oneOf": forms}


def form_of(annotation: Any, limits: Limits | None = None, choose: Choose | None = None) -> Form:
    """The form that a type annotation declares."""
    if typing.get_origin(annotation) is Annotated:
        written = metadata(annotation, Notation)
        if written:
            return Written(written)
        inner = metadata(annotation, Limits) or limits
        return form_of(typing.get_args(annotation)[0], inner, metadata(annotation, Choose) or choose)
    limits, origin, arguments = limits or Limits(), typing.get_origin(annotation), typing.get_args(annotation)
    if origin in (Union, types.UnionType):
        forms = [form_of(part, limits, choose) for part in arguments if part is not type(None)]
        return forms[0] if len(forms) == 1 else _either(forms, choose)
    if origin is list:
        return Items(form_of(arguments[0]), limits)
    if origin is dict:
        return Names(form_of(arguments[0]), form_of(arguments[1]), limits)
    if origin is Literal:
        return Words({word: word for word in arguments})
    if issubclass(annotation, Enum):
        return Words({one.value: one for one in annotation})
    if issubclass(annotation, Concept):
        return Mapped(annotation)
    return {str: Text(limits), int: Integer(limits), bool: Truth()}[annotation]


def _either(forms: list[Form], choose: Choose | None) -> Either:
    nested = [form for form in forms if isinstance(form, Either)]
    flat = [form for form in forms if not isinstance(form, Either)]
    flat += [one for form in nested for one in (*form.scalars, *form.lists, *form.mappings)]
    mappings = [form for form in flat if isinstance(form, (Names, Mapped))]
    lists = [form for form in flat if isinstance(form, Items)]
    scalars = [form for form in flat if not isinstance(form, (Names, Mapped, Items))]
    return Either(scalars, lists, mappings, choose or next((form.choose for form in nested if form.choose), None))


@per_concept
def declared(concept: type[Concept]) -> Mapping[str, tuple[Declared, Form]]:
    """The keys of a concept with their forms."""
    return {name: (key, form_of(key.annotation)) for name, key in keys(concept).items()}


@per_concept
def _rest(concept: type[Concept]) -> Names:
    hint = typing.get_type_hints(concept, include_extras=True)[concept.cases]
    return typing.cast(Names, form_of(hint))


def is_scalar(value: object) -> bool:
    return not isinstance(value, (dict, list))


def _has_room(form: Form, report: Findings, data: Any, place: Place, limits: Limits) -> bool:
    """Whether a collection has as many elements as it may have; a finding where it has not."""
    if len(data) < (limits.min_length or 0):
        form._value(report, place, "this is empty; at least one is needed here", form.describe(place))
    elif limits.max_length is not None and len(data) > limits.max_length:
        form._value(report, place, f"{len(data)} elements exceed the maximum of {limits.max_length}", "shorten it")
    else:
        return True
    return False


def _about(key: Declared, form: Form | None = None) -> str:
    return (form or form_of(key.annotation)).describe(Place((key.name,), key))


def _limits(limits: Limits, of: str) -> JsonSchema:
    found = {f"min{of}": limits.min_length, f"max{of}": limits.max_length, "pattern": limits.pattern}
    return {key: limit for key, limit in found.items() if limit is not None}


def _of_key(key: Declared, form: Form, definitions: dict[str, JsonSchema]) -> JsonSchema:
    default = key.default.value if isinstance(key.default, Enum) else key.default
    examples = {"examples": list(key.key.examples)} if key.key.examples else {}
    plain = isinstance(default, (str, int, list, dict)) and not key.required
    return {
        **form.schema(definitions),
        "description": key.key.description,
        **examples,
        **({"default": default} if plain else {}),
    }
