"""Values of number parameters from golden frames and the command line."""

from __future__ import annotations

from fractions import Fraction

from ..language import notation
from ..model import formatting
from ..model.edition import Edition
from ..model.types import Parameter


def number(edition: Edition, parameter: Parameter, text: str) -> Fraction:
    """The number in a text. Raises ValueError with a sentence if it is invalid for the parameter."""
    given = notation.rational(text)
    low, high = parameter.minimum, parameter.maximum
    if edition.is_factor(parameter) and given <= 0:
        raise ValueError(f"`{parameter.name}` must be above 0, because a scale is a multiple of it")
    if low is not None and given < low:
        raise ValueError(f"`{parameter.name}` must be at least {formatting.exact(low)}")
    if high is not None and given > high:
        raise ValueError(f"`{parameter.name}` must be at most {formatting.exact(high)}")
    return given
