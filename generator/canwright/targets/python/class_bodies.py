"""The body of a class with fields: its slots, constructor, `unpack` and properties."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...model.layout import Layout, Variant
from ...model.types import Parameter
from . import bits, text, types
from .fields import ConstantView, FieldView, ReadView, constant_views, field_view, places, read_views
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class VariantView:
    """A variant of a layout: how its fields are read, all by one `struct` or each separately."""

    values: tuple[str, ...]
    names: tuple[str, ...]
    struct: str
    targets: tuple[str, ...]
    """The names that the result of the `struct` is assigned to."""
    reads: tuple[ReadView, ...]
    constants: tuple[ConstantView, ...]


@dataclass(frozen=True, kw_only=True)
class BodyView:
    """The body of a class; `has_node` and `depends` decide its keywords.

    `constants` are those of every case; they are checked before the case is chosen.
    """

    fields: tuple[FieldView, ...]
    constants: tuple[ConstantView, ...]
    cases: tuple[VariantView, ...]
    parameter: str
    has_node: bool
    depends: bool


@dataclass(frozen=True, kw_only=True)
class ClassBodies:
    """Makes the bodies of the classes of one edition."""

    types: Mapping[str, types.TypeView]
    parameters: Mapping[str, Parameter]
    imports: Imports

    def body(self, layout: Layout, dlc: int, has_node: bool) -> BodyView:
        """The body for the fields of a layout, in frames of that length."""
        return BodyView(
            fields=tuple(
                field_view(field, self.types[field.type.name], layout.manual, self.imports)
                for field in layout.fields
                if field.fixed is None
            ),
            constants=tuple(constant_views((f for f in layout.fields if not f.only), dlc)),
            cases=tuple(self._case(layout, variant, dlc) for variant in layout.variants),
            parameter=text.attribute(layout.parameter or ""),
            has_node=has_node,
            depends=depends_on_parameters(layout),
        )

    def _case(self, layout: Layout, variant: Variant, dlc: int) -> VariantView:
        varying = [f for f in variant.fields if f.fixed is None]
        pattern, ordered = None, []
        if len(varying) == len(variant.fields) > 1 and not any(f.is_array for f in varying):
            ordered = sorted((place for _, place in places(varying)), key=lambda place: place.first_byte)
            pattern = bits.struct_format(ordered, dlc)
        return VariantView(
            values=variant_values(layout, variant, self.parameters),
            names=tuple(text.attribute(f.name) for f in varying),
            struct=pattern or "",
            targets=tuple(place.target for place in ordered) if pattern else (),
            reads=() if pattern else tuple(read_views(varying, dlc)),
            constants=tuple(constant_views((f for f in variant.fields if f.only), dlc)),
        )


def variant_values(layout: Layout, variant: Variant, parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """The parameter values of a variant; none where the layout has one variant only."""
    if layout.parameter is None or len(layout.variants) == 1:
        return ()
    return tuple(types.parameter_key(parameters[layout.parameter], value) for value in variant.values)


def depends_on_parameters(layout: Layout) -> bool:
    """Whether fields, values or ranges of a layout depend on parameters."""
    return bool(layout.parameters) or any(field.type.numbers for field in layout.fields)
