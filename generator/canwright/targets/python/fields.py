"""Fields as properties, keywords and slots of a class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ...model.layout import Field
from . import bits, docstrings, text, types
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class FieldView:
    """A field that a user sets and reads."""

    attribute: str
    optional: bool
    """Whether it exists under some values of a parameter only."""
    python: str
    """The type of its value."""
    raw_python: str
    """The type of its raw integer, or integers."""
    given: str
    """The type of its keyword."""
    value: str
    """Expression of the value, of `self`."""
    to_raw: str
    """Expression of the raw integer, of the keyword."""
    check: str
    """Expression of the function that checks the raw integer."""
    doc: docstrings.Docstring


@dataclass(frozen=True, kw_only=True)
class ConstantView:
    """A field that always has the same value: the expression that reads it, and the value."""

    read: str
    value: int
    name: str


@dataclass(frozen=True, kw_only=True)
class ReadView:
    """The expression that reads the raw integer, or integers, of a field."""

    attribute: str
    expression: str


def field_view(field: Field, type_: types.TypeView, manual_of_layout: str, imports: Imports) -> FieldView:
    """A field whose value is not fixed; `type_` is the view of its type."""
    attribute, name, use = text.attribute(field.name), text.literal(field.name), imports.use
    element = "one" if field.is_array else f"self.{attribute}_raw"
    if type_.is_flags:
        value, check = f"{type_.enum}({element})", f"{use('flags')}({type_.mask})"
    elif type_.enum:
        value, check = f"{use('named')}({type_.enum}, {element})", f"{use('member')}({type_.enum})"
    else:
        value = types.inline_value(field.type, element) or f"{type_.constant}.value({element}, self.parameters, {name})"
        check = f"{type_.constant}.check"
    python, raw_python, given = type_.python, "int", f"{type_.enum} | int" if type_.enum else use("Real")
    convert = f"self.TYPES[{text.literal(attribute)}]" if type_.enum else f"{type_.constant}.raw"
    if field.is_array:
        count = len(field.elements)
        value = f"tuple({value} for one in self.{attribute}_raw)"
        check = f"{use('each')}({check}, {count})"
        convert = convert if type_.enum else f"{use('each')}({convert}, {count})"
        python, raw_python, given = f"tuple[{python}, ...]", "tuple[int, ...]", f"{use('Iterable')}[{given}]"
    return FieldView(
        attribute=attribute,
        optional=bool(field.only),
        python=python,
        raw_python=raw_python,
        given=given,
        value=value,
        to_raw=f"{convert}({attribute}, self.parameters, {name})",
        check=check,
        doc=docstrings.of_field(field, type_.meaning, manual_of_layout),
    )


def constant_views(fields: Iterable[Field], dlc: int) -> Iterator[ConstantView]:
    """The constants that are checked."""
    for field in fields:
        if field.demanded is not None:
            for element in field.elements:
                read = bits.read(bits.place("", field, element), dlc)
                yield ConstantView(read=read, value=field.demanded, name=field.name)


def read_views(fields: Iterable[Field], dlc: int) -> Iterator[ReadView]:
    """How the fields that are not fixed are read, each on its own."""
    for field in fields:
        if field.fixed is None:
            reads = [bits.read(bits.place("", field, e), dlc) for e in field.elements]
            expression = text.tuple_of(reads) if field.is_array else reads[0]
            yield ReadView(attribute=text.attribute(field.name), expression=expression)


def places(fields: Iterable[Field]) -> list[tuple[Field, bits.RawPosition]]:
    """Where each element of the fields is; its target is the slot, or the raw integer of a fixed field."""
    found = []
    for field in fields:
        for i, element in enumerate(field.elements):
            slot = f"self.{text.attribute(field.name)}_raw" + (f"[{i}]" if field.is_array else "")
            target = slot if field.fixed is None else hex(field.fixed & (1 << field.type.width) - 1)
            place = bits.place(target, field, element)
            found.append((field, place if field.fixed is None else place._replace(signed=False)))
    return found
