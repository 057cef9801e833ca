"""Forms of values: each decodes plain data and has a JSON Schema."""

from __future__ import annotations

import functools
import re
import types
import typing
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from typing import Annotated, Any, Literal, NamedTuple, Union

from ..diagnostics.diagnostic import DocumentPath
from . import aliases, notation, suggestions
from .concept import (
    Choose,
    Concept,
    DeclaredKey,
    Defines,
    JsonSchema,
    Limits,
    Notation,
    Ref,
    Translated,
    keys,
    metadata,
    per_concept,
)
from .findings import Findings


def kind_of(data: object) -> str:
    """The kind of a value, with an article."""
    if isinstance(data, dict):
        return "a mapping"
    return "a list" if isinstance(data, list) else "a text" if isinstance(data, str) else "a single value"


INVALID: Any = object()
"""The result for a value that cannot be decoded and has a finding."""


class Location(NamedTuple):
    """The location of a value: its path, the nearest key of a concept, and whether the value is itself a key."""

    path: DocumentPath
    key: DeclaredKey | None = None
    is_key: bool = False
    owner: str = ""
    """The nearest definition that contains the value, or to which a key around it refers."""

    def at(self, step: str | int, key: DeclaredKey | None = None) -> Location:
        return Location((*self.path, step), key or self.key, owner=self.owner)

    @property
    def last(self) -> str:
        return str(self.path[-1]) if self.path else ""


class Form(ABC):
    """The form of a value."""

    example: Any = None
    """A value with a concept in this form; None for a form without a concept."""

    @abstractmethod
    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        """The decoded value; INVALID after a finding."""

    @abstractmethod
    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        """The JSON Schema; concepts are added to `definitions`."""

    def describe(self, location: Location) -> str:
        """The description of the nearest key, and an example."""
        if location.key is None:
            return "start with `canwright: 1` on its own line" if not location.path else ""
        if location.last == location.key.name or not isinstance(location.path[-1], str) or not self.example:
            examples = location.key.doc.examples
            example = examples[0] if examples else self.example if location.last == location.key.name else None
            shown = f" Example: {aliases.flow(example)}" if isinstance(example, (dict, list)) else ""
            return location.key.doc.description + shown
        return f"for example, {location.last}: {aliases.flow(self.example)}"

    def _type(self, report: Findings, location: Location, message: str, hint: str = "") -> Any:
        report.finding(location.path, "type", message, hint or self.describe(location), key=location.is_key)
        return INVALID

    def _value(self, report: Findings, location: Location, message: str, hint: str = "") -> Any:
        report.finding(location.path, "value", message, hint, key=location.is_key)
        return INVALID


@dataclass(frozen=True)
class TextForm(Form):
    """A text, or a name with a pattern and, if it is that of a definition, a role."""

    limits: Limits
    role: Defines | Ref | None = None

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if not isinstance(data, str):
            return self._type(report, location, "expected a text here", "put it in quotes" if is_scalar(data) else "")
        limits = self.limits
        if not data and (limits.min_length or limits.pattern):
            return self._value(report, location, "this text is empty", "write one, or omit the key")
        if limits.max_length is not None and len(data) > limits.max_length:
            message = f"{len(data)} characters exceed the maximum of {limits.max_length}"
            return self._value(report, location, message, "shorten it")
        if limits.pattern is None or re.search(_pattern(limits.pattern), data):
            if limits.pattern == suggestions.DATE and not suggestions.is_day(data):
                return self._value(report, location, f"`{data}` is not a date", "this month has fewer days")
            if self.role:
                report.add_name(self.role, data, location.path, location.owner, location.is_key)
            return data
        if limits.pattern == suggestions.VISIBLE:
            return self._value(report, location, "this text is blank", "write one, or omit the key")
        if limits.pattern == suggestions.DATE:
            return self._value(report, location, f"`{data}` is not a date", suggestions.date(data))
        shown = report.written(location.path, data, key=True) if location.is_key else data
        hint = suggestions.name(data, limits.pattern)
        report.finding(location.path, "name", f"`{shown}` is not a valid name here", hint, key=location.is_key)
        return INVALID

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "string", **_limits(self.limits, "Length")}


@functools.cache
def _pattern(pattern: str) -> re.Pattern[str]:
    return re.compile(re.sub(r"\$$", r"\\Z", pattern))


@dataclass(frozen=True)
class IntegerForm(Form):
    """An integer."""

    limits: Limits
    role: Defines | Ref | None = None

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if not isinstance(data, int) or isinstance(data, bool):
            shown = suggestions.as_yaml(data)
            text = f"`{shown}` is not a whole number" if is_scalar(data) else "expected a whole number here"
            return self._value(
                report, location, text, aliases.raw_integer(location.path[:-1]) or suggestions.integer(data)
            )
        low, high = self.limits.ge, self.limits.le
        if low is not None and data < low:
            shown = report.written(location.path, data)
            return self._value(report, location, f"{shown} is below the minimum of {low}", self.describe(location))
        if high is not None and data > high:
            hint = aliases.limit(data, location.path) or self.describe(location)
            shown = report.written(location.path, data)
            return self._value(report, location, f"{shown} exceeds the maximum of {high}", hint)
        if self.role:
            report.add_name(self.role, str(data), location.path, location.owner, location.is_key)
        return data

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        bounds = {"minimum": self.limits.ge, "maximum": self.limits.le}
        return {"type": "integer", **{key: bound for key, bound in bounds.items() if bound is not None}}


class BooleanForm(Form):
    """`true` or `false`."""

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if isinstance(data, bool):
            return data
        hint = f"write {aliases.truth(data) or 'true or false'}"
        hint += ", without quotes" if isinstance(data, str) else ""
        return self._value(report, location, f"`{data}` is not true or false", hint)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "boolean"}


@dataclass(frozen=True)
class ChoiceForm(Form):
    """One of several words or numbers."""

    words: Mapping[Any, Any]

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
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
        return self._value(report, location, message, hint)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        words = list(self.words)
        kind = "string" if isinstance(words[0], str) else "integer"
        return {"const": words[0], "type": kind} if len(words) == 1 else {"enum": words, "type": kind}


@dataclass(frozen=True)
class NotationForm(Form):
    """A value in a notation."""

    notation: Notation
    role: Ref | None = None

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        takes = isinstance(data, (str, int, Decimal)) and (self.notation.any_scalar or not isinstance(data, bool))
        try:
            if not takes:
                raise ValueError(f"expected {self.notation.expected}")
            if len(str(data)) > notation.LONGEST:
                raise ValueError(f"this has more than {notation.LONGEST} characters; expected {self.notation.expected}")
            value = self.notation.parse(data if self.notation.any_scalar else notation.text_of(data))
            for name in dict.fromkeys(self.notation.names(value)) if self.role else ():
                if self.role and name is not None:
                    report.add_name(self.role, name, location.path, location.owner, location.is_key)
            return value
        except ValueError as error:
            hint = aliases.notation(data, self.notation.parse) if len(str(data)) <= notation.LONGEST else ""
            hint = (
                f"`{data}` is a type: write `type: {data}`" if location.last == "raw" and report.is_type(data) else hint
            )
            return self._value(
                report, location, str(error), hint or ("" if is_scalar(data) else self.describe(location))
            )

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return dict(self.notation.schema)


@dataclass(frozen=True)
class ListForm(Form):
    """A list."""

    item: Form
    limits: Limits

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", [self.item.example] if self.item.example else None)

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if not isinstance(data, list):
            shown = report.written(location.path, data)
            hint = f"write [{shown}]" if is_scalar(data) else ""
            hint = f"write a space after a dash: `- {shown[1:]}`" if re.match("-[A-Za-z]", shown) else hint
            if isinstance(data, dict) and data and not self.item.example:
                hint = f"write a list of names: [{', '.join(data)}]"
            return self._type(report, location, f"expected a list here, not {kind_of(data)}", hint)
        if not _has_valid_size(self, report, data, location, self.limits):
            return INVALID
        return [self.item.decode(report, item, location.at(i)) for i, item in enumerate(data)]

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return {"type": "array", "items": self.item.schema(definitions), **_limits(self.limits, "Items")}


@dataclass(frozen=True)
class MapForm(Form):
    """A mapping from names that the author chooses."""

    name: Form
    value: Form
    limits: Limits

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", {"NAME": self.value.example} if self.value.example else None)

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if not isinstance(data, dict):
            hint = aliases.named(data) or aliases.listed(data, location.last) or aliases.mapping(data, location.path)
            return self._type(report, location, f"expected a mapping here, not {kind_of(data)}", hint)
        if self._is_reversed(data):
            text = "names and values are reversed here"
            return self._value(report, location, text, f"write {aliases.names_first(data)}")
        if not _has_valid_size(self, report, data, location, self.limits):
            return INVALID
        decoded = {}
        owns = getattr(self.name, "role", None) is not None
        for name, value in data.items():
            here = location.at(name)
            decoded_name = self.name.decode(report, name, Location(here.path, location.key, True, here.owner))
            decoded[decoded_name] = self.value.decode(report, value, here._replace(owner=name) if owns else here)
        return decoded

    def _is_reversed(self, data: dict[str, Any]) -> bool:
        """Whether the keys are numbers and the values are names."""
        is_named = isinstance(self.name, TextForm) and not re.search(_pattern(self.name.limits.pattern or ""), "0")
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
class ConceptForm(Form):
    """A mapping with the keys of a concept."""

    concept: type[Concept]

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", self.concept.example or None)

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if not isinstance(data, dict):
            hint = aliases.named(data) or aliases.mapping(data, location.path)
            return self._type(report, location, f"expected a mapping here, not {kind_of(data)}", hint)
        known, cases = declared(self.concept), self.concept.cases
        if cases and "by" not in data:
            text = "`by` is missing here"
            report.finding(location.path, "missing-key", text, aliases.by(data) or _about(*known["by"]), key=True)
            return INVALID
        before = report.number
        values: dict[str, Any] = {}
        suggested = self._report_unknown_keys(report, data, location) if not cases else set()
        for name, (key, form) in known.items():
            if name in data:
                values[name] = form.decode(report, data[name], location.at(name, key))
            elif key.required and name not in suggested:
                report.finding(location.path, "missing-key", f"`{name}` is missing here", _about(key, form), key=True)
            elif isinstance(form, TranslatedForm):
                values[name] = report.no_text()
        if cases:
            rest = {name: value for name, value in data.items() if name not in known}
            values[cases] = _rest(self.concept).decode(report, rest, location._replace(owner=str(data["by"])))
        if report.number > before:
            return INVALID
        instance = self.concept(**values)
        for problem in instance.problems(location.last):
            path = (*location.path, *problem.path)
            report.finding(path, problem.rule, problem.message, problem.hint, key=problem.key)
        return instance

    def _report_unknown_keys(self, report: Findings, data: dict[str, Any], location: Location) -> set[str]:
        """Reports unknown keys, and findings in misspelled ones; returns the keys that the hints suggest."""
        known = declared(self.concept)
        suggested: set[str] = set()
        for name, value in data.items():
            if name in known:
                continue
            path, text = (*location.path, name), f"unknown key `{name}`"
            if report.is_full:  # hints take long, and are not shown
                report.finding(path, "unknown-key", text)
                continue
            corrected = suggestions.corrected_key(name, known, data)
            hint = suggestions.unknown_key(self.concept, name, value, data)
            report.finding(path, "unknown-key", text, hint, key=True)
            if corrected and corrected not in suggested:
                key, form = known[corrected]
                form.decode(report, value, location.at(name, key))
            suggested |= {corrected} if corrected else set(suggestions.likely_keys(self.concept, name, value, data))
        return suggested

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
class UnionForm(Form):
    """One of several forms; the kind of data determines which one."""

    scalars: Sequence[Form]
    lists: Sequence[Form]
    mappings: Sequence[Form]
    choose: Choose | None

    def __post_init__(self) -> None:
        examples = (form.example for form in (*self.mappings, *self.lists) if form.example)
        object.__setattr__(self, "example", next(examples, None))

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        if isinstance(data, dict) and self.mappings:
            index = self.choose.which(data) if self.choose else 0
            return self.mappings[index].decode(report, data, location)
        if isinstance(data, list) and self.lists:
            return self.lists[0].decode(report, data, location)
        if not self.scalars:
            return (*self.mappings, *self.lists)[0].decode(report, data, location)
        words = (
            form for form in self.scalars if isinstance(form, ChoiceForm) and is_scalar(data) and data in form.words
        )
        wanted = IntegerForm if isinstance(data, int) else (TextForm, NotationForm)
        matching = (form for form in self.scalars if isinstance(form, wanted))
        form = next(words, None) or next(matching, None) or self.scalars[-1]
        if (
            isinstance(form, TextForm)
            and isinstance(data, str)
            and suggestions.is_quoted_number(data, form.limits.pattern)
        ):
            form = next((number for number in self.scalars if isinstance(number, IntegerForm)), form)
        if isinstance(form, TextForm) and self.example and not isinstance(data, str):
            text = f"expected a name or a mapping here{'' if is_scalar(data) else ', not a list'}"
            return self._type(report, location, text, aliases.named(data) or aliases.fields(data))
        return form.decode(report, data, location)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        overlap = any(isinstance(form, NotationForm) and form.notation.any_scalar for form in self.scalars)
        forms = [form.schema(definitions) for form in (*self.scalars, *self.lists, *self.mappings)]
        return {"anyOf" if overlap else "oneOf": forms}


@dataclass(frozen=True)
class TranslatedForm(Form):
    """A text in every language of the file."""

    written: Form

    def decode(self, report: Findings, data: Any, location: Location) -> Any:
        before = report.number
        written = self.written.decode(report, data, location)
        return INVALID if report.number > before else report.translated(location.path, written)

    def schema(self, definitions: dict[str, JsonSchema]) -> JsonSchema:
        return self.written.schema(definitions)


def form_of(
    annotation: Any,
    limits: Limits | None = None,
    choose: Choose | None = None,
    role: Defines | Ref | None = None,
) -> Form:
    """The form of a type annotation."""
    if typing.get_origin(annotation) is Annotated:
        role = metadata(annotation, Defines) or metadata(annotation, Ref) or role
        if written := metadata(annotation, Notation):
            return NotationForm(written, role if isinstance(role, Ref) else None)
        if translated := metadata(annotation, Translated):
            return TranslatedForm(form_of(translated.written))
        inner = metadata(annotation, Limits) or limits
        return form_of(typing.get_args(annotation)[0], inner, metadata(annotation, Choose) or choose, role)
    limits, origin, arguments = limits or Limits(), typing.get_origin(annotation), typing.get_args(annotation)
    if origin in (Union, types.UnionType):
        forms = [form_of(part, limits, choose, role) for part in arguments if part is not type(None)]
        return forms[0] if len(forms) == 1 else _either(forms, choose)
    if origin is list:
        return ListForm(form_of(arguments[0]), limits)
    if origin is dict:
        return MapForm(form_of(arguments[0]), form_of(arguments[1]), limits)
    if origin is Literal:
        return ChoiceForm({word: word for word in arguments})
    if issubclass(annotation, Enum):
        return ChoiceForm({member.value: member for member in annotation})
    if issubclass(annotation, Concept):
        return ConceptForm(annotation)
    return {str: TextForm(limits, role), int: IntegerForm(limits, role), bool: BooleanForm()}[annotation]


def _either(forms: list[Form], choose: Choose | None) -> UnionForm:
    nested = [form for form in forms if isinstance(form, UnionForm)]
    flat = [form for form in forms if not isinstance(form, UnionForm)]
    flat += [part for form in nested for part in (*form.scalars, *form.lists, *form.mappings)]
    mappings = [form for form in flat if isinstance(form, (MapForm, ConceptForm))]
    lists = [form for form in flat if isinstance(form, ListForm)]
    scalars = [form for form in flat if not isinstance(form, (MapForm, ConceptForm, ListForm))]
    return UnionForm(scalars, lists, mappings, choose or next((form.choose for form in nested if form.choose), None))


@per_concept
def declared(concept: type[Concept]) -> Mapping[str, tuple[DeclaredKey, Form]]:
    """The keys of a concept with their forms."""
    return {name: (key, form_of(key.annotation)) for name, key in keys(concept).items()}


@per_concept
def _rest(concept: type[Concept]) -> MapForm:
    hint = typing.get_type_hints(concept, include_extras=True)[concept.cases]
    return typing.cast(MapForm, form_of(hint))


def is_scalar(value: object) -> bool:
    return not isinstance(value, (dict, list))


def _has_valid_size(form: Form, report: Findings, data: Any, location: Location, limits: Limits) -> bool:
    """Whether the number of elements is within the limits; adds a finding if not."""
    if len(data) < (limits.min_length or 0):
        form._value(report, location, "this is empty; at least one element is required", form.describe(location))
    elif limits.max_length is not None and len(data) > limits.max_length:
        form._value(report, location, f"{len(data)} elements exceed the maximum of {limits.max_length}", "shorten it")
    else:
        return True
    return False


def _about(key: DeclaredKey, form: Form | None = None) -> str:
    return (form or form_of(key.annotation)).describe(Location((key.name,), key))


def _limits(limits: Limits, of: str) -> JsonSchema:
    named = {f"min{of}": limits.min_length, f"max{of}": limits.max_length, "pattern": limits.pattern}
    return {key: limit for key, limit in named.items() if limit is not None}


def _of_key(key: DeclaredKey, form: Form, definitions: dict[str, JsonSchema]) -> JsonSchema:
    default = key.default.value if isinstance(key.default, Enum) else key.default
    examples = {"examples": list(key.doc.examples)} if key.doc.examples else {}
    plain = isinstance(default, (str, int, list, dict)) and not key.required and not isinstance(form, TranslatedForm)
    return {
        **form.schema(definitions),
        "description": key.doc.description,
        **examples,
        **({"default": default} if plain else {}),
    }
