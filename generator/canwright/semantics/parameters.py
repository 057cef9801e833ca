"""What is said of a number parameter from outside the spec: in golden frames, on the command line."""

from __future__ import annotations

from fractions import Fraction

from ..language import notation
from ..model import formatting
from ..model.edition import Edition
from ..model.types import Parameter


def number(edition: Edition, parameter: Parameter, text: str) -> Fraction:
    """The number that a text is. Raises ValueError with a sentence for what the parameter cannot be."""
    given = notation.rational(text)
    low, high = parameter.minimum, parameter.maximum
    if edition.is_factor(parameter) and given <= 0:
        raise ValueError(f"`{parameter.name}` has to be above 0, since a scale is a multiple of it")
    if low is not None and given < low:
        raise ValueError(f"`{parameter.name}` is at least {formatting.exact(low)}")
    if high is not None and given > high:
        raise ValueError(f"`{parameter.name}` is at most {formatting.exact(high)}")
    return given
