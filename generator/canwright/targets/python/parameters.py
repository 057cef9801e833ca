"""Parameters as the fields of `Parameters`, and as enums where they are choices among names."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ...model.types import Parameter
from . import docstrings, text, types
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class ParameterView:
    """A field of `Parameters`."""

    name: str
    python: str
    doc: docstrings.Docstring
    values: tuple[str, ...]
    """Expressions of the values of a choice; empty for a number."""
    minimum: str
    maximum: str


@dataclass(frozen=True, kw_only=True)
class ChoiceView:
    """The enum of a choice among names."""

    name: str
    doc: docstrings.Docstring
    members: tuple[types.MemberView, ...]


def parameter_view(parameter: Parameter, imports: Imports) -> ParameterView:
    """The field of a parameter."""
    if parameter.is_choice:
        python = "int" if parameter.is_numeric else text.class_name(parameter.name)
    else:
        python = imports.use("Real")
    return ParameterView(
        name=text.attribute(parameter.name),
        python=python,
        doc=docstrings.of_parameter(parameter),
        values=tuple(types.parameter_key(parameter, v.name) for v in parameter.values),
        minimum=_limit(parameter.minimum, imports),
        maximum=_limit(parameter.maximum, imports),
    )


def _limit(limit: Fraction | None, imports: Imports) -> str:
    return "None" if limit is None else types.exact(limit, imports)


def choice_view(parameter: Parameter) -> ChoiceView:
    """The enum of a parameter."""
    members = (
        types.MemberView(name=text.member_name(v.name), value=text.literal(v.name), doc=(text.english(v.title),))
        for v in parameter.values
    )
    return ChoiceView(
        name=text.class_name(parameter.name), doc=(text.english(parameter.title),), members=tuple(members)
    )
