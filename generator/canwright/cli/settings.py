"""`--set`: parameters that are fixed in the output."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.types import Assignment
from ..semantics import parameters
from ..targets.base import Specification
from .common import stop


def assignment(specifications: Sequence[Specification], settings: Sequence[str]) -> Assignment:
    """`--set` as an assignment; each name and value must be valid in some edition."""
    result: dict[str, str] = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        owners = [(d.edition, p) for d in specifications for p in d.edition.parameters if p.name == name]
        numbers = [(edition, p) for edition, p in owners if not p.is_choice]
        for edition, parameter in numbers:
            try:
                parameters.number(edition, parameter, value)
            except ValueError as error:
                stop(f"--set {setting}: {error}")
        if not numbers and not any(v.name == value for _, p in owners for v in p.values):
            wanted = _known(specifications)
            remedy = f"use one of: {wanted}" if wanted else "the spec has no parameters"
            stop(f"--set {setting} is not a parameter and its value; {remedy}")
        if result.setdefault(name, value) != value:
            stop(f"--set {setting}: `{name}` is already set to {result[name]}; remove one")
    return result


def _known(specifications: Sequence[Specification]) -> str:
    """Every parameter with its possible values."""
    known: dict[str, set[str]] = {}
    for one in specifications:
        for parameter in one.edition.parameters:
            values = {v.name for v in parameter.values} if parameter.is_choice else {"NUMBER"}
            known.setdefault(parameter.name, set()).update(values)
    return "; ".join(f"{name}={'|'.join(sorted(values))}" for name, values in sorted(known.items()))
