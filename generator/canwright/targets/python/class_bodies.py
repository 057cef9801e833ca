"""The body of a class with fields: its types, constructor, `unpack` and properties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ...model.layout import Field, Layout, Variant
from ...model.types import Parameter
from . import bits, code, text, types
from .fields import FieldView, constant_checks, field_view, positions, storage, varying
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class ReadView:
    """How the fields of a variant are read."""

    constants: tuple[code.Code, ...]
    struct: str
    """The `struct` that reads the data; empty where each field is read separately."""
    raws: code.Code | None
    """The statement that stores the raw integers; None where they are exactly those that the `struct` reads."""


@dataclass(frozen=True, kw_only=True)
class BodyView:
    """The body of a class; `has_node` and `depends` decide on its keywords."""

    fields: tuple[FieldView, ...]
    raws_python: code.Code
    """The declaration of the raw integers."""
    match_args: code.Code
    """The fields that always exist."""
    types: code.Code
    """The type of each field by name."""
    parameter: str
    """The parameter that decides on the variant; empty where there is one variant only."""
    variants: tuple[code.Code, ...]
    """The names of the fields of each variant."""
    variant_of: tuple[tuple[str, int], ...]
    """Each value of that parameter, with the index of its variant."""
    constants: tuple[code.Code, ...]
    """The checks of the constants of all variants."""
    reads: tuple[ReadView, ...]
    """How each variant is read; one item where all are read in the same way."""
    to_raws: code.Code
    """The statement of the constructor that stores the raw integers."""
    has_node: bool
    depends: code.Code | None
    """The names of the parameters on which the fields depend; None without any."""
    is_always_valid: bool
    """Whether every decoded message can be encoded again."""


@dataclass(frozen=True, kw_only=True)
class ClassBodies:
    """Makes the bodies of the classes of one edition."""

    types: Mapping[str, types.TypeView]
    parameters: Mapping[str, Parameter]
    imports: Imports
    sets: dict[tuple[str, ...], str] = field(default_factory=dict)
    """The sets of parameter values that the bodies use, each with its name."""

    def body(self, layout: Layout, dlc: int, has_node: bool, nodes: Sequence[int]) -> BodyView:
        """The body for the fields of a layout, in frames of that length; `nodes` are those of elements of arrays."""
        stored = storage(layout)
        varies, depends = len(layout.variants) > 1, [text.literal(text.attribute(n)) for n in parameters_of(layout)]
        fields = tuple(
            field_view(
                field=field_,
                place=place,
                only=self._set(layout, field_) if varies and field_.only else "",
                type_=self.types[field_.type.name],
                manual_of_layout=layout.manual,
                nodes=nodes,
                imports=self.imports,
            )
            for field_, place in stored.items()
        )
        raws = {view.place: self.imports.use("Any") if view.only else view.raw_python for view in fields}
        to_raws = code.tuple_of((view.to_raw for view in fields), "self._raws = ")
        if varies:
            to_raws = code.call("self._raws = self._raws_of", (f"{view.attribute}={view.attribute}" for view in fields))
        reads = tuple(self._read(variant, stored, dlc) for variant in layout.variants)
        return BodyView(
            fields=fields,
            raws_python=code.Items("_raws: tuple[", tuple(raws[place] for place in sorted(raws)) or ("()",), "]"),
            match_args=code.tuple_of(
                (text.literal(view.attribute) for view in fields if not view.only), "__match_args__ = "
            ),
            types=code.dict_of((view.type for view in fields), "TYPES = "),
            parameter=text.attribute(layout.parameter or "") if varies else "",
            variants=tuple(_names(variant, stored) for variant in layout.variants),
            variant_of=tuple(
                (key, i)
                for i, variant in enumerate(layout.variants)
                for key in variant_values(layout, variant, self.parameters)
            ),
            constants=tuple(constant_checks((f for f in layout.fields if not f.only), dlc, self.imports)),
            reads=reads[:1] if len(set(reads)) == 1 else reads,
            to_raws=to_raws,
            has_node=has_node,
            depends=code.tuple_of(depends, "DEPENDS = ") if depends else None,
            is_always_valid=all(field_.type.accepts_every_raw for field_ in stored),
        )

    def _set(self, layout: Layout, field_: Field) -> str:
        """The name of the set of parameter values under which a field exists."""
        parameter = self.parameters[layout.parameter or ""]
        values = tuple(types.parameter_key(parameter, value) for value in field_.only)
        return self.sets.setdefault(values, f"_ONLY_{len(self.sets) + 1}")

    def _read(self, variant: Variant, stored: Mapping[Field, int], dlc: int) -> ReadView:
        own = positions(varying(variant.fields), stored)
        ordered = sorted((position for _, position in own), key=lambda position: position.first_byte)
        pattern = bits.struct_format(ordered, dlc) or ""
        reads: dict[int, list[str]] = {}
        for field_, position in own:
            read = f"found[{ordered.index(position)}]" if pattern else bits.read(position, dlc)
            reads.setdefault(stored[field_], []).append(read)
        arrays = {stored[field_] for field_, _ in own if field_.is_array}
        raws = [
            code.tuple_of(reads[place]) if place in arrays else reads.get(place, ["None"])[0]
            for place in range(max(stored.values(), default=-1) + 1)
        ]
        is_whole = pattern and raws == [f"found[{i}]" for i in range(len(ordered))]
        return ReadView(
            constants=tuple(constant_checks((f for f in variant.fields if f.only), dlc, self.imports)),
            struct=pattern,
            raws=None if is_whole else code.tuple_of(raws, "self._raws = "),
        )


def _names(variant: Variant, stored: Mapping[Field, int]) -> code.Code:
    """The name of the field at each place; None where a variant has no field."""
    names = {stored[field]: text.literal(text.attribute(field.name)) for field in varying(variant.fields)}
    return code.tuple_of(names.get(place, "None") for place in range(max(stored.values(), default=-1) + 1))


def variant_values(layout: Layout, variant: Variant, parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """The parameter values of a variant; none where the layout has one variant only."""
    if layout.parameter is None or len(layout.variants) == 1:
        return ()
    return tuple(types.parameter_key(parameters[layout.parameter], value) for value in variant.values)


def parameters_of(layout: Layout) -> tuple[str, ...]:
    """The parameters on which fields, values or ranges of a layout depend."""
    return tuple(dict.fromkeys((*layout.parameters, *(name for f in layout.fields for name in f.type.numbers))))


def depends_on_parameters(layout: Layout) -> bool:
    """Whether fields, values or ranges of a layout depend on parameters."""
    return bool(parameters_of(layout))
