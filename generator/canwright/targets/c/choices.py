"""Parameters, and values that depend on one, as a `switch`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, Protocol, TypeVar

from ...model.edition import Edition
from ...model.message import Command
from ...model.types import ByParameter, Parameter
from .names import Names, member

ENUM_MAX = 0x7FFF


class Alternative(Protocol):
    """An alternative of a choice."""

    @property
    def uses_parameters(self) -> bool: ...


T = TypeVar("T")
A = TypeVar("A", bound=Alternative)


@dataclass(frozen=True)
class Branch(Generic[T]):
    """The value under some labels of a `switch`."""

    labels: tuple[str, ...]
    value: T


@dataclass(frozen=True, kw_only=True)
class Choice(Generic[A]):
    """A value for each case of a `switch` over `subject`, and one for `otherwise`; without a subject only that."""

    subject: str | None
    cases: tuple[Branch[A], ...]
    otherwise: A

    @property
    def alternatives(self) -> list[A]:
        return [*(case.value for case in self.cases), self.otherwise]

    @property
    def uses_parameters(self) -> bool:
        return self.subject is not None or self.otherwise.uses_parameters


def choose(names: Names, dependent: ByParameter[T], view: Callable[[T | None], A], unknown: A) -> Choice[A]:
    """The views of a dependent value by parameter value; `unknown` if the parameter is not given."""
    if dependent.parameter is None:
        return Choice(subject=None, cases=(), otherwise=view(dependent.constant))
    grouped: dict[A, list[str]] = {}
    for values, value in dependent.distinct():
        grouped.setdefault(view(value), []).extend(values)
    grouped.pop(unknown, None)
    if not grouped:
        return Choice(subject=None, cases=(), otherwise=unknown)
    cases = (
        Branch(tuple(names.upper(dependent.parameter, v) for v in values), value) for value, values in grouped.items()
    )
    return Choice(subject=parameter_access(dependent.parameter), cases=tuple(cases), otherwise=unknown)


def parameter_access(parameter: str) -> str:
    """The C expression of a parameter."""
    return f"parameters->{member(parameter)}"


class Whole:
    """A parameter in an id or a constant: the call that checks it, its value, and the condition that it is unknown."""

    def __init__(self, edition: Edition, name: str) -> None:
        parameter, access = edition.parameter(name), parameter_access(name)
        self.check = f"canwright_check_whole(&{access}, {parameter.minimum or 0}, {parameter.maximum or 0})"
        self.value = f"canwright_whole(&{access})"
        self.unknown = f"{access}.denominator == 0u"


def parameter_literal(names: Names, parameter: Parameter, value: str | Fraction | int | None) -> str:
    """The initializer of a parameter with this value; None means unknown."""
    if parameter.is_choice:
        return names.upper(parameter.name, "unknown" if value is None else str(value))
    number = Fraction(0 if value is None else value)
    return f"{{{number.numerator}, {0 if value is None else number.denominator}u}}"


def lacks(names: Names, edition: Edition, command: Command, comparison: str = "==") -> list[str]:
    """The comparisons of a parameter with each value under which a node does not have a command."""
    return [
        f"{parameter_access(name)} {comparison} {names.upper(name, value.name)}"
        for name, values in command.only.items()
        for value in edition.parameter(name).values
        if value.name not in values
    ]


def enumerator_numbers(parameter: Parameter) -> Mapping[str, int]:
    """The number of each value: its own if all fit, else its position from 1; 0 means unknown."""
    own = {v.name: v.number for v in parameter.values if v.number is not None and 0 < v.number <= ENUM_MAX}
    if len(own) == len(parameter.values):
        return own
    return {v.name: place for place, v in enumerate(parameter.values, 1)}
