"""Fields as properties, keywords and raw integers of a class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ...model.layout import Field, FixedRole, Layout
from . import bits, code, docstrings, text, types
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class FieldView:
    """A field that a user sets and reads."""

    attribute: str
    place: int
    """Its position among the raw integers of the message."""
    only: str
    """The set of parameter values under which it exists; empty for a field that always exists."""
    header: code.Code
    """The first line of the property of its value."""
    raw_python: str
    """The type of its raw integer, or integers."""
    given: str
    """The type of its keyword."""
    value: code.Code
    """The statement that returns the value; of `raw` for an optional field."""
    to_raw: code.Code
    """Expression of the raw integer, of the keyword."""
    type: code.Code
    """The item of `TYPES`."""
    doc: docstrings.Docstring


def varying(fields: Iterable[Field]) -> list[Field]:
    """The fields that a message stores: those whose value is not fixed."""
    return [field for field in fields if field.role.is_value]


def field_view(
    field: Field,
    place: int,
    only: str,
    type_: types.TypeView,
    manual_of_layout: str,
    nodes: Sequence[int],
    imports: Imports,
) -> FieldView:
    """A field whose value is not fixed; `type_` is the view of its type, `nodes` are those of the elements of arrays."""
    attribute, use = text.attribute(field.name), imports.use
    name = text.literal(attribute)
    raw = "raw" if only else f"self._raws[{place}]"
    python, raw_python, given = type_.python, "int", f"{type_.enum} | int" if type_.enum else use("Real")
    type_item = f"{name}: {type_.constant}"
    if field.is_array:
        inline = types.inline_value(field.type, "one") if not type_.enum else None
        of_one = inline or code.call(f"{type_.constant}.value", ("one", "self._parameters", name))
        value: code.Code = code.Parts("return tuple", (of_one, f"for one in {raw}"))
        type_item = f"{name}: {use('ArrayType')}({type_.constant}, {len(field.elements)})"
        python, raw_python, given = f"tuple[{python}, ...]", "tuple[int, ...]", f"{use('Iterable')}[{given}]"
    else:
        inline = types.inline_value(field.type, raw) if not type_.enum else None
        value = (
            f"return {inline}"
            if inline
            else code.call(f"return {type_.constant}.value", (raw, "self._parameters", name))
        )
    of_type = f"self.TYPES[{name}]" if field.is_array else type_.constant
    return FieldView(
        attribute=attribute,
        place=place,
        only=only,
        header=code.Items(f"def {attribute}(", ("self",), f") -> {python}:"),
        raw_python=raw_python,
        given=given,
        value=value,
        to_raw=code.call(f"{of_type}.raw", (attribute, "self._parameters", name)),
        type=type_item,
        doc=docstrings.of_field(field, type_.meaning, manual_of_layout, nodes),
    )


def constant_checks(fields: Iterable[Field], dlc: int, imports: Imports) -> Iterator[code.Code]:
    """The statements that check the constants."""
    for field in fields:
        if field.role.is_checked:
            for element in field.elements:
                read = bits.read(bits.place("", field, element), dlc)
                yield code.call(imports.use("constant"), (read, str(field.role.required_raw), text.literal(field.name)))


def storage(layout: Layout) -> dict[Field, int]:
    """The place of each field among the raw integers of a message; fields that never exist together share places."""
    places: dict[Field, int] = {}
    for field in varying(layout.fields):
        beside = (neighbour for variant in layout.variants if field in variant.fields for neighbour in variant.fields)
        places[field] = 1 + max((places[neighbour] for neighbour in beside if neighbour in places), default=-1)
    return places


def positions(fields: Iterable[Field], stored: Mapping[Field, int]) -> list[tuple[Field, bits.RawPosition]]:
    """Where each element of the fields is on the wire.

    Its target is its raw integer, at the place where it is `stored`, or that of a fixed field.
    """
    listed = []
    for field in fields:
        for i, element in enumerate(field.elements):
            if isinstance(field.role, FixedRole):
                target = f"0x{field.role.raw & (1 << field.type.width) - 1:X}"
                listed.append((field, bits.place(target, field, element)._replace(signed=False)))
            else:
                target = f"self._raws[{stored[field]}]" + (f"[{i}]" if field.is_array else "")
                listed.append((field, bits.place(target, field, element)))
    return listed
