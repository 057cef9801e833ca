"""The body of a class with fields: its types, constructor, `unpack` and properties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...model.layout import Field, Layout, Variant
from ...model.types import Parameter
from . import bits, code, text, types
from .fields import FieldView, constant_checks, field_view, places, varying
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class VariantView:
    """A variant of a layout: the names of its fields, and how they are read."""

    names: code.Code
    constants: tuple[code.Code, ...]
    struct: str
    """The `struct` that reads the data; empty where each field is read separately."""
    raws: code.Code | None
    """The statement that stores the raw integers; None where they are exactly those that the `struct` reads."""


@dataclass(frozen=True, kw_only=True)
class BodyView:
    """The body of a class; `has_node` and `depends` decide its keywords.

    `constants` are those of every case; they are checked before the case is chosen.
    """

    fields: tuple[FieldView, ...]
    raws_python: code.Code
    """The declaration of the raw integers."""
    match_args: code.Code
    constants: tuple[code.Code, ...]
    cases: tuple[VariantView, ...]
    variant_of: tuple[tuple[str, int], ...]
    """Each value of the parameter that decides on the case, with the index of the case."""
    parameter: str
    require: code.Code
    """The statement that checks which optional fields are given."""
    to_raws: code.Code
    """The statement of the constructor that stores the raw integers."""
    has_node: bool
    depends: bool


@dataclass(frozen=True, kw_only=True)
class ClassBodies:
    """Makes the bodies of the classes of one edition."""

    types: Mapping[str, types.TypeView]
    parameters: Mapping[str, Parameter]
    imports: Imports

    def body(self, layout: Layout, dlc: int, has_node: bool, nodes: Sequence[int]) -> BodyView:
        """The body for the fields of a layout, in frames of that length; `nodes` are those of elements of arrays."""
        stored = varying(layout.fields)
        fields = tuple(
            field_view(field, i, self.types[field.type.name], layout.manual, nodes, self.imports)
            for i, field in enumerate(stored)
        )
        optional = [field.attribute for field in fields if field.optional]
        return BodyView(
            fields=fields,
            raws_python=code.Items(
                "_raws: tuple[",
                tuple(self.imports.use("Any") if field.optional else field.raw_python for field in fields) or ("()",),
                "]",
            ),
            match_args=code.tuple_of((text.literal(field.attribute) for field in fields), "__match_args__ = "),
            constants=tuple(constant_checks((f for f in layout.fields if not f.only), dlc, self.imports)),
            cases=tuple(self._case(variant, stored, dlc) for variant in layout.variants),
            variant_of=tuple(
                (key, i)
                for i, one in enumerate(layout.variants)
                for key in variant_values(layout, one, self.parameters)
            ),
            parameter=text.attribute(layout.parameter or ""),
            require=code.call("self._require", (f"{name}={name}" for name in optional)),
            to_raws=code.tuple_of((field.to_raw for field in fields), "self._raws = "),
            has_node=has_node,
            depends=depends_on_parameters(layout),
        )

    def _case(self, variant: Variant, stored: Sequence[Field], dlc: int) -> VariantView:
        own = varying(variant.fields)
        found = places(own, stored)
        ordered = [place.target for _, place in sorted(found, key=lambda item: item[1].first_byte)]
        in_order = sorted((place for _, place in found), key=lambda place: place.first_byte)
        pattern = bits.struct_format(in_order, dlc) or ""
        reads: dict[Field, list[str]] = {}
        for field, place in found:
            read = f"found[{ordered.index(place.target)}]" if pattern else bits.read(place, dlc)
            reads.setdefault(field, []).append(read)
        raws = [
            "None" if field not in reads else code.tuple_of(reads[field]) if field.is_array else reads[field][0]
            for field in stored
        ]
        is_whole = pattern and raws == [f"found[{i}]" for i in range(len(raws))]
        return VariantView(
            names=code.tuple_of(text.literal(text.attribute(field.name)) for field in own),
            constants=tuple(constant_checks((f for f in variant.fields if f.only), dlc, self.imports)),
            struct=pattern,
            raws=None if is_whole else code.tuple_of(raws, "self._raws = "),
        )


def variant_values(layout: Layout, variant: Variant, parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """The parameter values of a variant; none where the layout has one variant only."""
    if layout.parameter is None or len(layout.variants) == 1:
        return ()
    return tuple(types.parameter_key(parameters[layout.parameter], value) for value in variant.values)


def depends_on_parameters(layout: Layout) -> bool:
    """Whether fields, values or ranges of a layout depend on parameters."""
    return bool(layout.parameters) or any(field.type.numbers for field in layout.fields)
