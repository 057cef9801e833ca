"""Fields as properties, keywords and raw integers of a class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ...model.layout import Field
from . import bits, code, docstrings, text, types
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class FieldView:
    """A field that a user sets and reads."""

    attribute: str
    index: int
    """Its position among the raw integers of the message."""
    optional: bool
    """Whether it exists under some values of a parameter only."""
    python: str
    """The type of its value."""
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
    return [field for field in fields if field.fixed is None]


def field_view(
    field: Field, index: int, type_: types.TypeView, manual_of_layout: str, nodes: Sequence[int], imports: Imports
) -> FieldView:
    """A field whose value is not fixed; `type_` is the view of its type, `nodes` are those of the elements of arrays."""
    attribute, use = text.attribute(field.name), imports.use
    name, optional = text.literal(attribute), bool(field.only)
    raw = "raw" if optional else f"self._raws[{index}]"
    python, raw_python, given = type_.python, "int", f"{type_.enum} | int" if type_.enum else use("Real")
    type_item = f"{name}: {type_.constant}"
    if field.is_array:
        of_one = types.inline_value(field.type, "one") or f"{type_.constant}.value(one, self._parameters, {name})"
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
    if optional:
        to_raw = code.call("self._optional", (of_type, attribute, name))
    else:
        to_raw = code.call(f"{of_type}.raw", (attribute, "self._parameters", name))
    return FieldView(
        attribute=attribute,
        index=index,
        optional=optional,
        python=python,
        raw_python=raw_python,
        given=given,
        value=value,
        to_raw=to_raw,
        type=type_item,
        doc=docstrings.of_field(field, type_.meaning, manual_of_layout, nodes),
    )


def constant_checks(fields: Iterable[Field], dlc: int, imports: Imports) -> Iterator[code.Code]:
    """The statements that check the constants."""
    for field in fields:
        if field.demanded is not None:
            for element in field.elements:
                read = bits.read(bits.place("", field, element), dlc)
                yield code.call(imports.use("constant"), (read, str(field.demanded), text.literal(field.name)))


def places(fields: Iterable[Field], stored: Sequence[Field]) -> list[tuple[Field, bits.RawPosition]]:
    """Where each element of the fields is.

    Its target is its raw integer in `self._raws`, which has one for each of the `stored` fields, or that of a fixed
    field.
    """
    found = []
    for field in fields:
        for i, element in enumerate(field.elements):
            if field.fixed is None:
                target = f"self._raws[{stored.index(field)}]" + (f"[{i}]" if field.is_array else "")
                found.append((field, bits.place(target, field, element)))
            else:
                target = f"0x{field.fixed & (1 << field.type.width) - 1:X}"
                found.append((field, bits.place(target, field, element)._replace(signed=False)))
    return found
