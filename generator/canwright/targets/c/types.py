"""Types: limits, names of raw values, checks, conversions, and values as text, in decimals by integers only."""

from __future__ import annotations

from collections.abc import Iterator

from ...model.edition import Edition
from ...model.formatting import english
from ...model.joined import JoinedText
from ...model.types import Encoding, Linear, NoValue, Type
from .conversions import NO_SCALE, ConversionView, Formula, by_scale, milli
from .expressions import INT64, Integer, integer, raw_of, stored
from .floating import DOUBLE, SINGLE, floating, has_floating, initializer, is_wide, raw_kind
from .names import FIRST, SCALE_MACROS, Names
from .text import MacroView, errata, literal, type_facts, with_deprecation
from .validity import has_value, is_nan, valid, within_run

FEWEST, MOST = 3, 9
"""The limits of the number of decimals of a scale that is no decimal fraction."""
UNKNOWN_SCALE = 6
"""The number of decimals of a scale that depends on a number parameter, and of a float."""


class ShowView:
    """How a number is printed: `formulas` by parameter value; one with a status prints the raw integer by `raw`."""

    def __init__(self, names: Names, type_: Type) -> None:
        kind, item = raw_kind(type_), raw_of(type_, "raw")
        plain = f"canwright_print_{kind if kind == 'signed' else 'unsigned'}(printer, {item});"

        def formula(linear: Linear) -> Formula:
            if linear.is_identity and type_.encoding is not Encoding.FLOAT:
                return Formula(number=plain)
            numbers = initializer(linear, type_)
            call = f"canwright_print_value_{kind}(printer, {item}, &linear, {decimals(type_, linear)}u);"
            return Formula(number=call, linear=numbers) if numbers else NO_SCALE

        self.raw, self.formulas = plain, by_scale(names, type_, formula, NO_SCALE)
        has_value = any(not formula_.status for formula_ in self.formulas.alternatives)
        self.unit = literal(f" {type_.unit.dbc}") if type_.unit and has_value else ""
        """The string literal that follows a value; empty if no alternative has a value, or if there is no unit."""


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


class TypeView:
    """A type with its macros, names, check and conversions."""

    def __init__(self, names: Names, edition: Edition, type_: Type) -> None:
        stem, kind = names.type_stem(type_), integer(type_)
        unit = type_.unit.dbc if type_.unit else ""
        self.name = names.lower(stem)
        self.kind = stored(type_)
        """The C type of a member, and of a raw integer in functions."""
        self.is_float = type_.encoding is Encoding.FLOAT
        self.is_flags, self.is_enum = bool(type_.flags), bool(type_.enum)
        self.unit = unit
        self.heading = f"{stem}: {english(type_.title) or type_.name}" + (f", {unit}" if unit else "")
        self.valid = valid(names, type_)
        self.milli = milli(names, type_, self.valid)
        self.milli_unit = f"thousandths of {unit}" if unit else "thousandths"
        self.single, self.double = (floating(names, type_, self.valid, format_) for format_ in (SINGLE, DOUBLE))
        pairs = {"milli": self.milli, "double": self.double, "float": self.single}
        self.conversions = {unit: conversion for unit, conversion in pairs.items() if conversion is not None}
        """Conversions by the ending of their names."""
        self.joined, self.is_text = type_.joined, isinstance(type_.joined, JoinedText)
        """How elements are joined, and whether that is as a text."""
        self.show = ShowView(names, type_)
        self.use = f"Raw {'bits' if self.is_float else 'integer'}, type {stem}{_functions(type_, stem, self.milli or self.double)}."
        """A sentence with the type and its functions, for comments of fields."""
        lacking = list(_lacking(type_, self.milli))
        self.facts = type_facts(type_)
        about = " ".join(text for text in (english(type_.about), *self.facts, *lacking) if text)
        self.doc = [text for text in (about, *errata(edition, type_.path)) if text]
        self.macros = [*_limits(names, type_, kind), *_scale(names, type_), *_members(names, type_, kind)]
        self.names = [(names.upper(stem, m.name), m.name) for m in (*type_.enum, *type_.flags)]
        """The macros and names of an enum or of flags."""
        self.no_values = [(n.name, _has_name(names, type_, n)) for n in type_.no_values]
        """The names for raw integers without a value, each with the condition for them."""
        self.has_value = has_value(type_)
        """The condition for a number; empty if all raw integers are numbers."""
        self.is_empty = not (self.macros or self.valid or self.milli or lacking or self.joined)


def _functions(type_: Type, stem: str, conversion: ConversionView | None) -> str:
    """The names by which a field of a type is used, without the prefix of the edition."""
    if not type_.is_number:
        return f": {stem}_*".upper()
    if type_.joined is not None:
        word = "text" if isinstance(type_.joined, JoinedText) else "number"
        return f", an element: {stem}_to_{word}, {stem}_from_{word}"
    if type_.is_plain and not type_.unit:
        return f": {stem}_has_value, {stem}_no_value" if type_.no_values else ", a plain number"
    if conversion is None:
        return ""
    given = ", with the parameters" if conversion.to_parameters or conversion.from_parameters else ""
    return f": {stem}_to_*, {stem}_from_*{given}"


def _lacking(type_: Type, thousandths: ConversionView | None) -> Iterator[str]:
    """The reasons why a type has no thousandths or no floating point; none if it has, or if it has no scale."""
    by = ", ".join(type_.times)
    if by and thousandths is None:
        yield f"No thousandths: 64 bits are too few to multiply with {by}; there are conversions to floating point."
    if not by and is_wide(type_):
        yield "No thousandths: scale or offset needs integers of more than 63 bits; there are conversions to floating point."
    if has_floating(type_, DOUBLE) and not has_floating(type_, SINGLE):
        yield "No conversions to float: values are beyond its range."


def _limits(names: Names, type_: Type, kind: Integer) -> Iterator[MacroView]:
    """The ends of a range, one pair for each value of the parameter that decides it."""
    if type_.encoding is Encoding.FLOAT:
        return
    by = type_.raw_range
    for case, limits in by.named:
        ends = (("RAW_MIN", "Lowest", limits.low), ("RAW_MAX", "Highest", limits.high)) if limits else ()
        under = f" ({by.parameter} {case})" if case else ""
        for ending, word, bound in ends:
            if bound.parameter is None and bound.constant.denominator == 1:
                name = names.upper(names.type_stem(type_), ending, *([case] if case else []))
                yield MacroView(name, _parenthesised(kind.literal(int(bound.constant))), f"{word} raw value{under}.")


def _scale(names: Names, type_: Type) -> Iterator[MacroView]:
    """The unit, and scale and offset if no parameter decides them."""
    stem = names.type_stem(type_)
    if type_.unit:
        yield MacroView(names.upper(stem, "UNIT"), literal(type_.unit.dbc), "Unit.")
    linear = type_.linear.constant
    if linear is None or linear.times or not type_.is_number or (type_.is_plain and not type_.unit):
        return
    if not is_wide(type_):
        scale, offset = linear.scale, linear.offset
        numbers = (scale.numerator, scale.denominator, offset.numerator, offset.denominator)
        parts = ("scale: numerator", "scale: denominator", "offset: numerator", "offset: denominator")
        for ending, number, part in zip(SCALE_MACROS[1:], numbers, parts, strict=True):
            yield MacroView(names.upper(stem, ending), _parenthesised(INT64.literal(number)), f"{part.capitalize()}.")


def _members(names: Names, type_: Type, kind: Integer) -> Iterator[MacroView]:
    for m in (*type_.enum, *type_.names):
        doc = with_deprecation(english(m.title), m.deprecated)
        yield MacroView(names.upper(names.type_stem(type_), m.name), _parenthesised(kind.literal(m.value)), doc)
    for n in type_.no_values:
        several = len(n.raws) > 1 and not n.is_nan
        doc = f"No value: {with_deprecation(english(n.title), n.deprecated)}{'; the last raw value' if several else ''}"
        yield MacroView(names.upper(names.type_stem(type_), n.name), _parenthesised(kind.literal(n.raws[-1])), doc)
        if several:
            name = names.upper(names.type_stem(type_), n.name, FIRST)
            yield MacroView(name, _parenthesised(kind.literal(n.raws[0])), f"No value: the first raw value of {n.name}")
    for m in type_.flags:
        doc = with_deprecation(english(m.title), m.deprecated)
        yield MacroView(names.upper(names.type_stem(type_), m.name), kind.unsigned.bits(1 << m.value), doc)


def _has_name(names: Names, type_: Type, named: NoValue) -> str:
    """The condition for the raw integers without a value that have a name."""
    if len(named.raws) == 1:
        return f"raw == {names.upper(names.type_stem(type_), named.name)}"
    return is_nan(type_, "raw") if named.is_nan else within_run(integer(type_), named.raws)


def _parenthesised(literal: str) -> str:
    return f"({literal})" if literal.startswith("-") else literal
