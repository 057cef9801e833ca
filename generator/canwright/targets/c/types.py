"""Types: limits, names of raw values, checks and conversions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...model.edition import Edition
from ...model.types import Encoding, Type
from .choices import Choice
from .comments import errata, type_facts
from .conversions import ConversionView, milli
from .floating import DOUBLE, SINGLE, floating, lacks_floating
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
    """A type with its macros, names, check and conversions. `facts` are part of `doc`; `names` are those of an enum."""

    name: str
    heading: str
    doc: tuple[str, ...]
    facts: tuple[str, ...]
    kind: str
    macros: tuple[MacroView, ...]
    names: tuple[NameView, ...]
    valid: Choice[Condition] | None
    milli: ConversionView | None
    milli_unit: str
    floating: tuple[ConversionView, ...]
    """Conversions to float and to double; empty without a scale."""
    has_notes: bool
    """True if `doc` says which conversions are missing."""
    unit: str

    @property
    def double(self) -> ConversionView | None:
        """The conversions to double."""
        return next((conversion for conversion in self.floating if conversion.kind == DOUBLE.name), None)

    @property
    def is_empty(self) -> bool:
        return not (self.macros or self.valid or self.milli or self.has_notes)


def types(names: Names, edition: Edition) -> list[TypeView]:
    """The types that fields use, in spec order."""
    used = {field.type.name for layout in layouts(edition) for field in layout.fields}
    return [_type(names, edition, type_) for type_ in edition.types if type_.name in used]


def _type(names: Names, edition: Edition, type_: Type) -> TypeView:
    kind, check = integer(type_), valid(names, type_)
    unit = type_.unit.dbc if type_.unit else ""
    title = english(type_.title) or type_.name
    thousandths = milli(names, type_, check)
    lacking = tuple(_lacking(type_, thousandths))
    facts = tuple(type_facts(type_))
    about = " ".join(text for text in (english(type_.about), *facts, *lacking) if text)
    macros = [*_limits(names, type_, kind), *_members(names, type_, kind)]
    return TypeView(
        name=names.lower(type_.name),
        heading=title + (f", {unit}" if unit else ""),
        doc=tuple(text for text in (about, *errata(edition, type_.path)) if text),
        facts=facts,
        kind=kind.name,
        macros=tuple(macros),
        names=tuple(NameView(names.upper(type_.name, m.name), m.name) for m in type_.enum),
        valid=check,
        milli=thousandths,
        milli_unit=f"thousandths of {unit}" if unit else "thousandths",
        floating=tuple(filter(None, (floating(names, type_, check, format_) for format_ in (SINGLE, DOUBLE)))),
        has_notes=bool(lacking),
        unit=unit,
    )


def _lacking(type_: Type, thousandths: ConversionView | None) -> Iterator[str]:
    """The reasons why a type has no thousandths or no floating point; none if it has, or if it has no scale."""
    by = ", ".join(type_.times)
    if by and thousandths is None:
        yield f"No thousandths: 64 bits are too few to multiply with {by}; there are conversions to floating point."
    if lacks_floating(type_):
        yield "No conversions to floating point: scale or offset needs integers of more than 63 bits."


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
                name = names.upper(type_.name, ending, *([case] if case else []))
                yield MacroView(name, _parenthesised(kind.literal(int(bound.constant))), f"{word} raw value{under}.")


def _members(names: Names, type_: Type, kind: Integer) -> Iterator[MacroView]:
    for m in type_.enum:
        yield MacroView(names.upper(type_.name, m.name), _parenthesised(kind.literal(m.value)), english(m.title))
    for m in type_.flags:
        yield MacroView(names.upper(type_.name, m.name), kind.unsigned.bits(1 << m.value), english(m.title))


def _parenthesised(literal: str) -> str:
    return f"({literal})" if literal.startswith("-") else literal
