"""Parameters as the fields of `Parameters`, and as enums where they are choices among names."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ...model.types import Parameter
from . import code, docstrings, text, types
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class ParameterView:
    """A field of `Parameters`."""

    name: str
    declaration: code.Code
    check: code.Code
    """The statement that checks its value."""
    doc: docstrings.Docstring


@dataclass(frozen=True, kw_only=True)
class ChoiceView:
    """The enum of a choice among names."""

    name: str
    doc: docstrings.Docstring
    members: tuple[types.MemberView, ...]


def parameter_view(parameter: Parameter, imports: Imports) -> ParameterView:
    """The field of a parameter."""
    name, use = text.attribute(parameter.name), imports.use
    values = [types.parameter_key(parameter, value.name) for value in parameter.values]
    given = [f"self.{name}", text.literal(name)]
    if parameter.is_choice:
        declaration: code.Code = f"{name}: {text.class_name(parameter.name)} | None = None"
        if parameter.is_numeric:
            declaration = code.Items(f"{name}: {use('Literal')}[", tuple(values), "] | None = None")
        check = code.call(use("check_choice"), (*given, *values))
    else:
        declaration = f"{name}: {use('Real')} | None = None"
        limits = (_limit(parameter.minimum, imports), _limit(parameter.maximum, imports))
        check = code.call(use("check_number"), (*given, *limits))
    return ParameterView(name=name, declaration=declaration, check=check, doc=docstrings.of_parameter(parameter))


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
