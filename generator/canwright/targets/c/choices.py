"""What depends on a parameter, as a `switch`; and the parameters themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

from ...model.edition import Edition
from ...model.types import Dependent, Parameter
from .names import Names, member
from .text import english

ENUM_MAX = 0x7FFF


class Alternative(Protocol):
    """What a choice is between."""

    @property
    def uses_parameters(self) -> bool: ...


T = TypeVar("T")
A = TypeVar("A", bound=Alternative)


@dataclass(frozen=True, kw_only=True)
class Branch(Generic[T]):
    """What applies under some labels of a `switch`."""

    labels: tuple[str, ...]
    value: T


@dataclass(frozen=True, kw_only=True)
class Choice(Generic[A]):
    """A value for each case of a `switch` over `subject` and one for all others, which is the only one without a subject."""

    subject: str | None
    cases: tuple[Branch[A], ...]
    otherwise: A

    @property
    def alternatives(self) -> list[A]:
        return [*(case.value for case in self.cases), self.otherwise]

    @property
    def uses_parameters(self) -> bool:
        return self.subject is not None or self.otherwise.uses_parameters


class EnumeratorView(NamedTuple):
    name: str
    number: int


class ParameterView(NamedTuple):
    """One member of the struct of parameters; enumerators where it is a choice."""

    kind: str
    member: str
    doc: tuple[str, ...]
    title: str
    unknown: str
    enumerators: tuple[EnumeratorView, ...]


def choose(names: Names, found: Dependent[T], view: Callable[[T | None], A], unknown: A) -> Choice[A]:
    """The view of what is found, by the value of its parameter; `unknown` when that is not given."""
    if found.parameter is None:
        return Choice(subject=None, cases=(), otherwise=view(found.constant))
    grouped: dict[A, list[str]] = {}
    for values, value in found.distinct():
        grouped.setdefault(view(value), []).extend(values)
    grouped.pop(unknown, None)
    if not grouped:
        return Choice(subject=None, cases=(), otherwise=unknown)
    cases = (
        Branch(labels=tuple(names.upper(found.parameter, v) for v in values), value=value)
        for value, values in grouped.items()
    )
    return Choice(subject=parameter_access(found.parameter), cases=tuple(cases), otherwise=unknown)


def parameter_access(parameter: str) -> str:
    """The value of a parameter as C reads it."""
    return f"parameters->{member(parameter)}"


def parameters(names: Names, edition: Edition) -> list[ParameterView]:
    return [_parameter(names, parameter) for parameter in edition.parameters]


def enumerator_numbers(parameter: Parameter) -> Mapping[str, int]:
    """The number of each value: its own where all have one that fits, else its place; 0 is left for `unknown`."""
    own = {v.name: v.number for v in parameter.values if v.number is not None and 0 < v.number <= ENUM_MAX}
    if len(own) == len(parameter.values):
        return own
    return {v.name: place for place, v in enumerate(parameter.values, 1)}


def _parameter(names: Names, parameter: Parameter) -> ParameterView:
    title, about = english(parameter.title), english(parameter.about)
    doc = tuple(text for text in (title + ".", about) if text)
    if not parameter.is_choice:
        return ParameterView(
            kind="canwright_ratio_t", member=member(parameter.name), doc=doc, title=title, unknown="", enumerators=()
        )
    numbers = enumerator_numbers(parameter)
    return ParameterView(
        kind=names.lower(parameter.name, "t"),
        member=member(parameter.name),
        doc=doc,
        title=title,
        unknown=names.upper(parameter.name, "unknown"),
        enumerators=tuple(
            EnumeratorView(names.upper(parameter.name, v.name), numbers[v.name]) for v in parameter.values
        ),
    )
