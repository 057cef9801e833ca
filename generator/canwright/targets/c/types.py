"""Types: limits, names of raw values, checks and conversions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...model.edition import Edition
from ...model.types import Encoding, Type
from .choices import Choice
from .comments import errata, type_facts
from .conversions import ConversionView, double, milli
from .names import Names, layouts
from .numbers import Integer, integer
from .text import english
from .validity import Condition, valid


class MacroView(NamedTuple):
    name: str
    value: str
    doc: str


class NameView(NamedTuple):
    label: str
    name: str


class TypeView(NamedTuple):
    """A type with its macros, names, check and conversions. `facts` are part of `doc`; `names` are those of an enum.

    `use` is a sentence with the type and its functions, for comments of fields.
    """

    name: str
    use: str
    heading: str
    doc: tuple[str, ...]
    facts: tuple[str, ...]
    kind: str
    macros: tuple[MacroView, ...]
    names: tuple[NameView, ...]
    valid: Choice[Condition] | None
    milli: ConversionView | None
    milli_unit: str
    double: ConversionView | None
    only_double: bool
    unit: str

    @property
    def is_empty(self) -> bool:
        return not (self.macros or self.valid or self.milli or self.only_double)


def types(names: Names, edition: Edition) -> list[TypeView]:
    """The types that fields use, in spec order."""
    used = {field.type.name for layout in layouts(edition) for field in layout.fields}
    return [_type(names, edition, type_) for type_ in edition.types if type_.name in used]


def _type(names: Names, edition: Edition, type_: Type) -> TypeView:
    kind, check = integer(type_), valid(names, type_)
    unit = type_.unit.dbc if type_.unit else ""
    title = english(type_.title) or type_.name
    stem = names.type_stem(type_)
    thousandths = milli(names, type_, check)
    lacking = "" if thousandths else _only_doubles(type_)
    facts = tuple(type_facts(type_))
    about = " ".join(text for text in (english(type_.about), *facts, lacking) if text)
    in_double = double(names, type_, check)
    macros = [*_limits(names, type_, kind), *_members(names, type_, kind)]
    return TypeView(
        name=names.lower(stem),
        use=f"Type {stem}{_functions(type_, stem, thousandths or in_double)}.",
        heading=f"{stem}: {title}" + (f", {unit}" if unit else ""),
        doc=tuple(text for text in (about, *errata(edition, type_.path)) if text),
        facts=facts,
        kind=kind.name,
        macros=tuple(macros),
        names=tuple(NameView(names.upper(names.type_stem(type_), m.name), m.name) for m in type_.enum),
        valid=check,
        milli=thousandths,
        milli_unit=f"thousandths of {unit}" if unit else "thousandths",
        double=in_double,
        only_double=bool(lacking),
        unit=unit,
    )


def _functions(type_: Type, stem: str, conversion: ConversionView | None) -> str:
    """The names by which a field of a type is used, without the prefix of the edition."""
    if not type_.is_number:
        return f": {stem}_*".upper()
    if type_.is_plain and not type_.unit:
        return ", a plain number"
    if conversion is None:
        return ""
    given = ", with the parameters" if conversion.to_parameters or conversion.from_parameters else ""
    return f": {stem}_to_*, {stem}_from_*{given}"


def _only_doubles(type_: Type) -> str:
    """The reason why a type with a number parameter has no thousandths; empty without such a parameter."""
    by = ", ".join(type_.times)
    return f"No thousandths: 64 bits are too few to multiply with {by}; there are conversions to double." if by else ""


def _limits(names: Names, type_: Type, kind: Integer) -> Iterator[MacroView]:
    """The ends of a range, one pair for each value of the parameter that decides it."""
    if type_.encoding is Encoding.FLOAT:
        return
    found = type_.raw_range
    cases = found.cases.items() if found.parameter else [("", found.constant)]
    for case, limits in cases:
        ends = (("RAW_MIN", "Lowest", limits.low), ("RAW_MAX", "Highest", limits.high)) if limits else ()
        under = f" ({found.parameter} {case})" if case else ""
        for ending, word, bound in ends:
            if bound.parameter is None and bound.constant.denominator == 1:
                name = names.upper(names.type_stem(type_), ending, *([case] if case else []))
                yield MacroView(name, _parenthesised(kind.literal(int(bound.constant))), f"{word} raw value{under}.")


def _members(names: Names, type_: Type, kind: Integer) -> Iterator[MacroView]:
    for m in type_.enum:
        yield MacroView(
            names.upper(names.type_stem(type_), m.name), _parenthesised(kind.literal(m.value)), english(m.title)
        )
    for m in type_.flags:
        yield MacroView(names.upper(names.type_stem(type_), m.name), kind.unsigned.bits(1 << m.value), english(m.title))


def _parenthesised(literal: str) -> str:
    return f"({literal})" if literal.startswith("-") else literal
