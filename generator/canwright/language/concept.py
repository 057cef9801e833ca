"""The base class of concepts; annotations declare the description, limits and notation of each key."""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, TypeVar

from ..diagnostics.diagnostic import DocumentPath

JsonSchema = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Doc:
    """The documentation of a key."""

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
    """A value written as a number or a short text; `parse` raises ValueError with a message for the author."""

    parse: Callable[[Any], Any]
    expected: str
    """The expected value, for a message about a value that is neither a number nor a text."""
    schema: JsonSchema
    any_scalar: bool = False
    """Whether `parse` takes the scalar itself, `true` and `false` included, instead of its text."""
    names: Callable[[Any], Iterable[str | None]] = lambda value: ()
    """The names in a parsed value."""


@dataclass(frozen=True, eq=False)
class Choose:
    """The choice among several forms of a mapping; `which` returns the index of the form."""

    which: Callable[[Mapping[str, object]], int]


@dataclass(frozen=True, eq=False)
class Defines:
    """A name of a definition of a kind, such as a type; with `of`, a part of the definition of another kind."""

    kind: str
    of: str = ""


@dataclass(frozen=True, eq=False)
class Ref:
    """A name of a definition of a kind, or a notation with such names; `words` have a meaning of their own."""

    kind: str
    of: str = ""
    words: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Translated:
    """A text in every language of the file; `written` are its forms in the file."""

    written: Any


class Problem(NamedTuple):
    """A contradiction between the keys of a concept: its path below the concept, what is wrong, what to write."""

    path: tuple[str, ...]
    rule: str
    message: str
    hint: str
    key: bool = True
    """Whether the finding is at a key, not at its value."""


class Concept:
    """A mapping of the language with fixed keys: a frozen dataclass with keyword arguments."""

    called: ClassVar[str] = ""
    """The name of the concept in a message about one of its keys in another concept."""
    example: ClassVar[Mapping[str, Any]] = {}
    """A valid mapping, for hints."""
    advice: ClassVar[Mapping[str, str]] = {}
    """Hints for certain unknown keys."""
    cases: ClassVar[str] = ""
    """The attribute that contains all keys without a declaration."""
    other_file: ClassVar[tuple[str, str, str]] = ("", "", "")
    """A key that identifies a file of another kind, the message and the hint."""
    schema_extra: ClassVar[JsonSchema] = {}
    """Conditions on several keys in the JSON Schema."""
    all: ClassVar[list[type[Concept]]] = []

    def __init_subclass__(cls) -> None:
        if "called" in vars(cls):
            Concept.all.append(cls)

    def problems(self, name: str) -> Iterable[Problem]:
        """Contradictions between keys; `name` is the key of this concept in the mapping that contains it."""
        return ()


class DeclaredKey(NamedTuple):
    """A key and its annotation."""

    name: str
    annotation: Any
    doc: Doc
    required: bool
    default: Any

    @property
    def limits(self) -> Limits:
        return metadata(self.annotation, Limits) or Limits()


T = TypeVar("T")


def per_concept(compute: Callable[[type[Concept]], T]) -> Callable[[type[Concept]], T]:
    """Caches a function of a concept."""
    return typing.cast(Callable[[type[Concept]], T], functools.cache(compute))


@per_concept
def keys(concept: type[Concept]) -> Mapping[str, DeclaredKey]:
    """The keys of a concept, by name."""
    hints = typing.get_type_hints(concept, include_extras=True)
    return {
        field.name: DeclaredKey(
            field.name,
            hints[field.name],
            metadata(hints[field.name], Doc) or Doc(""),
            field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING,
            field.default_factory() if field.default_factory is not dataclasses.MISSING else field.default,
        )
        for field in dataclasses.fields(concept)  # type: ignore[arg-type]
        if field.name != concept.cases
    }


def metadata(annotation: Any, kind: type[T]) -> T | None:
    """The last metadata of a class in an annotation."""
    return next((item for item in reversed(getattr(annotation, "__metadata__", ())) if isinstance(item, kind)), None)


def parts(value: object) -> Iterator[tuple[DocumentPath, object]]:
    """A decoded concept, and the concepts, mappings and lists in it, with their paths."""
    waiting: list[tuple[DocumentPath, object]] = [((), value)]
    while waiting:
        path, value = waiting.pop()
        yield path, value
        items: Iterable[tuple[str | int, object]]
        items = (
            enumerate(value) if isinstance(value, list) else (value if isinstance(value, dict) else vars(value)).items()
        )
        waiting += [((*path, step), part) for step, part in items if isinstance(part, Concept | dict | list)][::-1]
