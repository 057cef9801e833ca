"""The base of the language's classes: keys with descriptions, limits and notations, declared in annotations."""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

JsonSchema = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Key:
    """What people read of a key."""

    description: str
    examples: tuple[Any, ...] = ()


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of a number (`ge`, `le`), of the length of a text or collection, and the pattern of a text."""

    ge: int | None = None
    le: int | None = None
    min_length: int | None = None
    max_length: int | None = None
    pattern: str | None = None


@dataclass(frozen=True, eq=False)
class Notation:
    """A value written as a number or a short text; `parse` raises ValueError with a sentence for the author."""

    parse: Callable[[Any], Any]
    expected: str
    """What was expected, where the value is neither a number nor a text."""
    schema: JsonSchema
    any_scalar: bool = False
    """Whether `parse` takes the scalar itself, `true` and `false` included, instead of its text."""


@dataclass(frozen=True, eq=False)
class Choose:
    """Which of several concepts a mapping is: the index of the form."""

    which: Callable[[Mapping[str, object]], int]


class Concept:
    """What all concepts share: a frozen dataclass of keyword arguments; unknown keys are rejected."""

    called: ClassVar[str] = ""
    """What messages call the concept, where it owns keys that are written elsewhere by mistake."""
    example: ClassVar[Mapping[str, Any]] = {}
    """The concept as it is written. An invalid required value is replaced by that of the example."""
    advice: ClassVar[Mapping[str, str]] = {}
    """What to write instead of certain unknown keys."""
    cases: ClassVar[str] = ""
    """The attribute that takes all keys without a declaration of their own."""
    other: ClassVar[tuple[str, str, str]] = ("", "", "")
    """A key of the file that this one may be mistaken for, the message and the hint."""
    schema_extra: ClassVar[JsonSchema] = {}
    """Conditions on several keys, for the JSON Schema."""
    all: ClassVar[list[type[Concept]]] = []

    def __init_subclass__(cls) -> None:
        if "called" in vars(cls):
            Concept.all.append(cls)


@dataclass(frozen=True)
class Declared:
    """A key as a class declares it."""

    name: str
    annotation: Any
    key: Key
    required: bool
    default: Any

    @property
    def limits(self) -> Limits:
        return metadata(self.annotation, Limits) or Limits()


T = TypeVar("T")


def per_concept(compute: Callable[[type[Concept]], T]) -> Callable[[type[Concept]], T]:
    """Computes something about a concept once."""
    return typing.cast(Callable[[type[Concept]], T], functools.cache(compute))


@per_concept
def keys(concept: type[Concept]) -> Mapping[str, Declared]:
    """The keys of a concept, by name."""
    hints = typing.get_type_hints(concept, include_extras=True)
    return {
        field.name: Declared(
            field.name,
            hints[field.name],
            metadata(hints[field.name], Key) or Key(""),
            field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING,
            field.default_factory() if field.default_factory is not dataclasses.MISSING else field.default,
        )
        for field in dataclasses.fields(concept)  # type: ignore[arg-type]
        if field.name != concept.cases
    }


def metadata(annotation: Any, kind: type[T]) -> T | None:
    """The last annotation of a kind."""
    return next((one for one in reversed(getattr(annotation, "__metadata__", ())) if isinstance(one, kind)), None)
