"""Frames as text: the value of each type in decimals, by integers only."""

from __future__ import annotations

from typing import NamedTuple

from ...model.types import Encoding, Linear, Type
from .choices import Choice, choose
from .conversions import Formula, ratio
from .floating import initializer, raw_kind
from .names import Names
from .text import literal

FEWEST, MOST = 3, 9
"""The limits of the number of decimals of a scale that is no decimal fraction."""
UNKNOWN_SCALE = 6
"""The number of decimals of a scale that depends on a number parameter, and of a float."""


class ShowView(NamedTuple):
    """How a number is printed: `formulas` by parameter value; one with a status prints the raw integer.

    `unit` is the string literal that follows a value; empty if no alternative has a value, or if there is no unit.
    """

    formulas: Choice[Formula]
    raw: str
    unit: str


def show(names: Names, type_: Type) -> ShowView:
    kind = raw_kind(type_)
    plain = f"canwright_print_{kind if kind == 'signed' else 'unsigned'}(printer, raw);"

    def formula(linear: Linear | None) -> Formula:
        if linear is None:
            return RAW
        if linear.is_identity and type_.encoding is not Encoding.FLOAT:
            return Formula(number=plain)
        numbers = initializer(linear, type_)
        if not numbers:
            return RAW
        call = f"canwright_print_value_{kind}(printer, raw, &linear, {decimals(type_, linear)}u);"
        return Formula(number=call, linear=numbers, ratio=ratio(linear))

    formulas = choose(names, type_.linear, formula, RAW)
    has_value = any(not one.status for one in formulas.alternatives)
    return ShowView(formulas, plain, literal(f" {type_.unit.dbc}") if type_.unit and has_value else "")


RAW = Formula(status="NO_SCALE")


def decimals(type_: Type, linear: Linear) -> int:
    """The number of decimals that are exact if there are at most six, and distinguish all raw integers otherwise."""
    if linear.times is not None or type_.encoding is Encoding.FLOAT:
        return UNKNOWN_SCALE
    divisor = linear.as_quotient[2]
    exact = next((digits for digits in range(UNKNOWN_SCALE + 1) if 10**digits % divisor == 0), None)
    if exact is not None:
        return exact
    enough = next((digits for digits in range(MOST) if abs(linear.scale) * 10**digits >= 1), MOST)
    return min(max(enough + 1, FEWEST), MOST)
