"""Values of parameters from programs, golden frames and the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction

from ..diagnostics.diagnostic import nearest
from ..language import notation
from ..model import formatting
from ..model.edition import Edition
from ..model.types import Assignment, Parameter


def assignment(editions: Sequence[Edition], values: Mapping[str, str | int | float | Decimal | Fraction]) -> Assignment:
    """The values as an assignment. Raises ValueError with a sentence for one that is invalid in all editions."""
    result: dict[str, str | Fraction] = {}
    for name, value in values.items():
        owners = [
            (edition, parameter) for edition in editions for parameter in edition.parameters if parameter.name == name
        ]
        if not owners:
            hint = nearest(name, [parameter.name for edition in editions for parameter in edition.parameters])
            raise ValueError(f"`{name}` is not a parameter; {hint or 'the spec has no parameters'}")
        text = notation.text_of(Decimal(repr(value)) if isinstance(value, float) else value)
        names = [choice.name for _, parameter in owners for choice in parameter.values]
        if names and text not in names:
            raise ValueError(f"`{name}` is not `{text}`; use one of: {', '.join(dict.fromkeys(names))}")
        numbers = [number(edition, parameter, text) for edition, parameter in owners if not parameter.is_choice]
        result[name] = numbers[0] if numbers else text
    return result


def number(edition: Edition, parameter: Parameter, text: str) -> Fraction:
    """The number in a text. Raises ValueError with a sentence if it is invalid for the parameter."""
    given = notation.rational(text)
    low, high = parameter.minimum, parameter.maximum
    if parameter.whole and given.denominator != 1:
        raise ValueError(f"`{parameter.name}` must be a whole number")
    if edition.is_factor(parameter) and given <= 0:
        raise ValueError(f"`{parameter.name}` must be above 0, because a scale is a multiple of it")
    if low is not None and given < low:
        raise ValueError(f"`{parameter.name}` must be at least {formatting.exact(low)}")
    if high is not None and given > high:
        raise ValueError(f"`{parameter.name}` must be at most {formatting.exact(high)}")
    return given
