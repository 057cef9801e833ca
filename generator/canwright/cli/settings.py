"""`--set`: parameters that are fixed in the output."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.types import Assignment
from ..semantics import parameters
from ..targets.base import Described
from .common import stop


def assignment(described: Sequence[Described], settings: Sequence[str]) -> Assignment:
    """`--set` as an assignment: each name one that some edition knows, with a value that it can have there."""
    result: dict[str, str] = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        having = [(d.edition, p) for d in described for p in d.edition.parameters if p.name == name]
        numbers = [(edition, p) for edition, p in having if not p.is_choice]
        for edition, parameter in numbers:
            try:
                parameters.number(edition, parameter, value)
            except ValueError as error:
                stop(f"--set {setting}: {error}")
        if not numbers and not any(v.name == value for _, p in having for v in p.values):
            wanted = _known(described)
            there = f"there are: {wanted}" if wanted else "the spec has none"
            stop(f"--set {setting} is not a parameter and its value; {there}")
        if result.setdefault(name, value) != value:
            stop(f"--set {setting}: `{name}` is set to {result[name]} already; one of them is too many")
    return result


def _known(described: Sequence[Described]) -> str:
    """Every parameter with what it can be."""
    known: dict[str, set[str]] = {}
    for one in described:
        for parameter in one.edition.parameters:
            values = {v.name for v in parameter.values} if parameter.is_choice else {"NUMBER"}
            known.setdefault(parameter.name, set()).update(values)
    return "; ".join(f"{name}={'|'.join(sorted(values))}" for name, values in sorted(known.items()))
