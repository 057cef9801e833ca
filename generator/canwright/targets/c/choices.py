"""What depends on a parameter, as a `switch`; and the parameters themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.types import Dependent, Parameter
from .names import Names, member
from .text import english

T = TypeVar("T")
ENUM_MAX = 0x7FFF


class Branch(NamedTuple):
    """Statements under some cases."""

    labels: tuple[str, ...]
    lines: tuple[str, ...]


class Choice(NamedTuple):
    """Statements, or a `switch` over `subject` between several and those of `otherwise`."""

    subject: str | None
    branches: tuple[Branch, ...]
    otherwise: tuple[str, ...]

    @property
    def is_constant(self) -> bool:
        return self.subject is None

    @property
    def uses_parameters(self) -> bool:
        lines = [line for branch in self.branches for line in branch.lines] + list(self.otherwise)
        return self.subject is not None or any("parameters->" in line for line in lines)


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


def always(lines: Sequence[str]) -> Choice:
    return Choice(None, (), tuple(lines))


def choose(
    names: Names, found: Dependent[T], lines: Callable[[T | None], Sequence[str]], unknown: Sequence[str]
) -> Choice:
    """The statements of what is found: by the value of its parameter, and `unknown` when that is not given."""
    if found.parameter is None:
        return always(lines(found.constant))
    grouped: dict[tuple[str, ...], list[str]] = {}
    for values, value in found.distinct():
        grouped.setdefault(tuple(lines(value)), []).extend(values)
    grouped.pop(tuple(unknown), None)
    if not grouped:
        return always(unknown)
    branches = (
        Branch(tuple(names.upper(found.parameter, v) for v in values), body) for body, values in grouped.items()
    )
    return Choice(f"parameters->{member(found.parameter)}", tuple(branches), tuple(unknown))


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
        return ParameterView("canwright_ratio_t", member(parameter.name), doc, title, "", ())
    numbers = enumerator_numbers(parameter)
    return ParameterView(
        names.lower(parameter.name, "t"),
        member(parameter.name),
        doc,
        title,
        names.upper(parameter.name, "unknown"),
        tuple(EnumeratorView(names.upper(parameter.name, v.name), numbers[v.name]) for v in parameter.values),
    )
