"""Comments on types and fields: unit, resolution, range and position, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field, NodeRole, Space
from ...model.types import IDENTITY, ByParameter, Encoding, Linear, Type
from .text import english


def type_facts(type_: Type, among: Sequence[str] = ()) -> list[str]:
    """Resolution and range of a type, only for the parameter values in `among` if there are any."""
    return [sentence for sentence in (_scale(type_, among), _range(type_, among)) if sentence]


def field_facts(field: Field, parameter: str | None, use: str, of_type: Sequence[str], *, low_bits: bool) -> str:
    """A field in one paragraph: title, position, type, resolution, range, condition.

    `use` names the type and its functions, `of_type` are the facts of the type. With `low_bits`, a field for the node
    has only the low bits of it.
    """
    among = field.only if parameter in field.type.parameters else ()
    parts = [f"{english(field.title)}, {_places(field)}. {use}"]
    if field.is_array:
        indices = [e.index for e in field.elements]
        parts.append(f"Element 0 is number {indices[0]}, the last one number {indices[-1]}.")
    if isinstance(field.role, NodeRole):
        parts.append("It contains the low bits of the node." if low_bits else "It contains the node.")
    if english(field.about):
        parts.append(english(field.about))
    parts += type_facts(field.type, among) if among else of_type
    if field.only:
        parts.append(f"Only {parameter} {', '.join(field.only)}; 0 otherwise.")
    return " ".join(parts)


def errata(edition: Edition, path: DocumentPath) -> list[str]:
    """The errata about the item at `path`, one paragraph each."""
    return [
        f"Erratum ({e.manual}): {english(e.printed)} Used here: {english(e.used)} {english(e.why)}"
        for e in edition.errata_at(path)
    ]


def _scale(type_: Type, among: Sequence[str]) -> str:
    unit = type_.unit.dbc if type_.unit else ""
    if not type_.is_number:
        return ""
    if type_.encoding is Encoding.FLOAT and type_.linear == ByParameter.always(IDENTITY):
        return f"In {unit}, as the bits of an IEEE 754 number." if unit else "The bits of an IEEE 754 number."
    known = [(_among(names, among), linear) for names, linear in type_.linear.distinct()]
    given = [
        _worth(linear, unit) + _case(type_.linear.parameter, names)
        for names, linear in known
        if linear and names is not None
    ]
    lacking = [", ".join(names) for names, linear in known if not linear and names is not None]
    if not given:
        return "No scale is known." if lacking else ""
    if given == ["1"]:
        return ""
    sentence = f"Resolution (1 LSB): {' or '.join(given)}."
    return sentence + (f" None is known for {lacking[0]}." if lacking else "")


def _range(type_: Type, among: Sequence[str]) -> str:
    if not type_.is_number:
        return ""
    what = "Range" if type_.encoding is Encoding.FLOAT else "Raw"
    known = [(_among(names, among), limits) for names, limits in type_.raw_range.distinct()]
    given = [
        formatting.span(limits) + _case(type_.raw_range.parameter, names)
        for names, limits in known
        if limits and names is not None
    ]
    return f"{what} {', '.join(given)}." if given else ""


def _worth(linear: Linear, unit: str) -> str:
    offset = f", counted from {formatting.offset(linear)}" if linear.offset else ""
    return f"{formatting.step(linear)} {unit}".rstrip() + offset + (f" {unit}" if linear.offset and unit else "")


def _case(parameter: str | None, names: Sequence[str]) -> str:
    return f" ({parameter} {', '.join(names)})" if names else ""


def _among(names: Sequence[str], among: Sequence[str]) -> Sequence[str] | None:
    """The names that are in `among`; None if all of them are left out."""
    if not names or not among:
        return names
    return [name for name in names if name in among] or None


def _places(field: Field) -> str:
    places = [formatting.place(field.space, e.segments) for e in field.elements]
    if len(places) == 1 or field.space is Space.ID:
        return places[0]
    return f"{places[0]} to {places[-1]}"
