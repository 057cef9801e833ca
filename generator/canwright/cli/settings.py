"""`--set`: the values of parameters that are fixed in the output."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..model.edition import Edition
from ..model.types import Assignment
from ..resolve import number_parameters
from ..targets.base import EditionInput
from .common import stop


def assignment(specifications: Sequence[EditionInput], settings: Sequence[str]) -> Assignment:
    """`--set` as an assignment; each name and value must be valid in some edition."""
    result: dict[str, str] = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        check_value([item.edition for item in specifications], setting, name, value, "")
        if result.setdefault(name, value) != value:
            stop(f"--set {setting}: `{name}` is already set to {result[name]}; remove one")
    return result


def check_value(editions: Sequence[Edition], setting: str, name: str, value: str, further: str) -> None:
    """Stops unless a parameter has this value in some edition; `further` are other settings that are possible."""
    owners = [(edition, p) for edition in editions for p in edition.parameters if p.name == name]
    numbers = [(edition, p) for edition, p in owners if not p.is_choice]
    for edition, parameter in numbers:
        try:
            number_parameters.number(edition, parameter, value)
        except ValueError as error:
            stop(f"--set {setting}: {error}")
    if not numbers and not any(v.name == value for _, p in owners for v in p.values):
        wanted = "; ".join(filter(None, (further, known_values(editions))))
        remedy = f"use one of: {wanted}" if wanted else "the spec has no parameters"
        stop(f"--set {setting} is not a parameter and its value; {remedy}")


def known_values(editions: Iterable[Edition], only: str = "") -> str:
    """Every parameter, or one, with its possible values."""
    known: dict[str, set[str]] = {}
    for edition in editions:
        for parameter in edition.parameters:
            if only in ("", parameter.name):
                values = {v.name for v in parameter.values} if parameter.is_choice else {"NUMBER"}
                known.setdefault(parameter.name, set()).update(values)
    return "; ".join(f"{name}={'|'.join(sorted(values))}" for name, values in sorted(known.items()))
