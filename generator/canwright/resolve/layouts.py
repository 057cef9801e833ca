"""Resolver of layouts: fields with their bits."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..language import aliases, edition as schema
from ..language.notation import At, frame_bits
from ..model.layout import (
    ConstantRole,
    Element,
    Field,
    FieldRole,
    Layout,
    NodeRole,
    ReservedRole,
    Segment,
    Space,
    ValueRole,
    Variant,
)
from ..model.types import Order, Parameter, Text, Type
from .context import Context
from .types import bare_type, deprecation


class LayoutResolver:
    """Resolver of layouts; `bare_types` are the types of fields with only a raw format."""

    def __init__(
        self,
        context: Context,
        order: Order,
        parameters: Mapping[str, Parameter],
        types: Mapping[str, Type],
    ) -> None:
        self._context = context
        self._order = order
        self._parameters = parameters
        self._types = types
        self.bare_types: dict[str, Type] = {}

    def only(self, path: DocumentPath, written: Mapping[str, Sequence[str]] | None) -> dict[str, tuple[str, ...]]:
        """A condition on parameters, with findings for invalid names."""
        for name, values in (written or {}).items():
            parameter = self._context.find((*path, "only", name), "parameter", name, self._parameters, key=True)
            if parameter and not parameter.values and not self._context.is_invalid(("parameters", name)):
                text = f"`only` requires a choice, but `{name}` is a number"
                self._context.report(
                    (*path, "only", name), "parameter-kind", text, "use a parameter with `values`", key=True
                )
            known = {value.name: value for value in parameter.values} if parameter else {}
            for i, value in enumerate(values if known else ()):
                self._context.find((*path, "only", name, i), f"value of `{name}`:", value, known)
        return {name: tuple(values) for name, values in (written or {}).items()}

    def shared(self, path: DocumentPath, name: str, written: schema.LayoutSpec, fields_at: DocumentPath) -> Layout:
        """A shared layout; `fields_at` is the path of its fields."""
        title = self._context.title(path, written.title, name)
        about = self._context.text((*path, "about"), written.about)
        return self._layout(path, fields_at, name, written.fields, title, about, written.manual or "", True)

    def own(self, path: DocumentPath, name: str, fields: schema.Fields, title: Text, manual: str) -> Layout:
        """The layout of one message."""
        return self._layout(path, path, name, fields, title, self._context.text(path, None), manual, False)

    def joined(self, path: DocumentPath, name: str, layout: Layout, more: schema.Fields) -> Layout:
        """The layout of one message: the fields of another layout, and `more` fields at `path`."""
        own = self._layout(path, path, name, more, layout.title, layout.about, layout.manual, False)
        if None not in (own.parameter, layout.parameter) and own.parameter != layout.parameter:
            text = f"these fields depend on {own.parameter}, those of `{layout.name}` on {layout.parameter}"
            self._context.report(path, "two-parameters", text, "define a separate layout for the command")
        fields, parameter = (*own.fields, *layout.fields), own.parameter or layout.parameter
        return dataclasses.replace(own, fields=fields, parameter=parameter, variants=self._variants(fields, parameter))

    def _layout(
        self,
        path: DocumentPath,
        fields_at: DocumentPath,
        name: str,
        fields: schema.Fields,
        title: Text,
        about: Text,
        manual: str,
        shared: bool,
    ) -> Layout:
        all_fields = [self._field((*fields_at, n), n, f, manual) for n, f in fields.items()]
        resolved = tuple(
            f for f in all_fields if not any(self._context.is_invalid((*f.path, k)) for k in ("at", "only"))
        )
        conditions = dict.fromkeys(p for f in fields.values() for p in f.only or {} if p in self._parameters)
        if len(conditions) > 1:
            names = ", ".join(conditions)
            self._context.report(
                path,
                "two-parameters",
                f"the fields of this layout depend on {names}; one parameter is allowed",
                "define separate commands for the others",
            )
        parameter = next(iter(conditions), None)
        variants = self._variants(resolved, parameter)
        return Layout(
            name=name,
            fields=resolved,
            parameter=parameter,
            variants=variants,
            shared=shared,
            title=title,
            about=about,
            manual=manual,
            path=path,
        )

    def _variants(self, fields: tuple[Field, ...], parameter: str | None) -> tuple[Variant, ...]:
        if parameter is None or parameter not in self._parameters:
            return (Variant(values=(), fields=fields),)
        groups: dict[tuple[str, ...], tuple[list[str], tuple[Field, ...]]] = {}
        for value in self._parameters[parameter].values:
            present = tuple(f for f in fields if not f.only or value.name in f.only)
            names, _ = groups.setdefault(tuple(f.name for f in present), ([], present))
            names.append(value.name)
        return tuple(Variant(values=tuple(names), fields=present) for names, present in groups.values())

    def _field(self, path: DocumentPath, name: str, written: schema.FieldSpec, manual: str) -> Field:
        type_ = self._type(path, written)
        start, count = written.at, len(written.array) if written.array else 1
        bits = frame_bits(start, type_.width * count, type_.order)
        elements = []
        for i in range(count):
            offset = i * type_.width if type_.order is Order.LITTLE or start.space is Space.ID else None
            first = offset if offset is not None else type_.width * (count - 1 - i)
            elements.append(
                Element(
                    written.array[i] if written.array else None,
                    segments_of(bits[first : first + type_.width], start.space),
                )
            )
        of_type = type_.title if type_.title != self._context.title(path, None, type_.name) else {}
        title = of_type if written.title is None else self._context.text((*path, "title"), written.title)
        if not any(title.values()):
            title = self._context.title(path, None, name)
        return Field(
            name=name,
            renamed_from=written.renamed_from,
            deprecated=deprecation(written.deprecated),
            type=type_,
            space=start.space,
            elements=tuple(elements),
            is_array=written.array is not None,
            only=tuple(v for values in self.only(path, written.only).values() for v in values),
            role=self._role(path, written),
            title=title,
            about=self._context.text((*path, "about"), written.about),
            manual=written.manual or manual,
            path=path,
        )

    def _role(self, path: DocumentPath, written: schema.FieldSpec) -> FieldRole:
        """The role of a field. A field without a valid format is a value, because its constant cannot be checked."""
        roles = [key for key in ("constant", "reserved", "holds") if getattr(written, key) is not None]
        if len(roles) > 1:
            hint = "keep `constant` if receivers check the value, or `reserved` if they ignore it"
            if "holds" in roles:
                hint = f"omit `{roles[0]}` if the value depends on the node; otherwise omit `holds`"
            text = f"`{path[-1]}` has both `{roles[0]}` and `{roles[1]}`"
            self._context.report((*path, roles[1]), "field-type", text, hint, key=True)
        if written.holds is not None:
            return NodeRole()
        if written.raw is None and written.type not in self._types:
            return ValueRole()
        if written.constant is not None:
            return ConstantRole(written.constant)
        return ValueRole() if written.reserved is None else ReservedRole(written.reserved)

    def _type(self, path: DocumentPath, written: schema.FieldSpec) -> Type:
        if (written.type is None) == (written.raw is None):
            both = written.type is not None
            text = f"`{path[-1]}` has both `type` and `raw`" if both else f"`{path[-1]}` has neither `type` nor `raw`"
            hint = (
                "keep `type` for a type, or `raw` for a plain number"
                if both
                else "write, for example, raw: u8 for a plain number"
            )
            self._context.report(path, "field-type", text, hint, key=True)
        if written.type is not None and written.byte_order is not None:
            hint = "move `byte_order` into the type, or write `raw` instead of `type`"
            self._context.report((*path, "byte_order"), "field-type", "the type defines the byte order", hint)
        elif written.byte_order is not None and written.at.space is Space.ID:
            text = "`byte_order` has no effect on a field in the id"
            hint = "remove it; in the id, `at` is the least significant bit"
            self._context.report((*path, "byte_order"), "no-effect", text, hint, key=True)
        if written.raw is not None:
            bare = bare_type(self._context, written.raw, written.byte_order or self._order, path)
            if bare.order is not self._order:
                bare = dataclasses.replace(bare, name=f"{bare.name}_{bare.order.value}")
            return self.bare_types.setdefault(bare.name, bare)
        if written.type is None:
            return bare_type(self._context, schema.EMPTY_RAW, self._order, path)
        raw = aliases.raw_format(written.type)
        hint = f"write `raw: {raw}`" if raw and written.type not in self._types else ""
        type_ = self._context.find((*path, "type"), "type", written.type, self._types, hint)
        return type_ or bare_type(self._context, schema.EMPTY_RAW, self._order, path)


def segments_at(start: At, width: int, order: Order) -> tuple[Segment, ...]:
    return segments_of(frame_bits(start, width, order), start.space)


@functools.lru_cache(maxsize=1 << 12)
def segments_of(bits: tuple[int, ...], space: Space) -> tuple[Segment, ...]:
    """Frame bits, from the least significant raw bit up, as segments within one byte each.

    Cached, because many messages have fields with the same bits.
    """
    if space is Space.ID:
        return (Segment(0, bits[0], len(bits), 0),)
    starts = [raw for raw, bit in enumerate(bits) if raw == 0 or bit != bits[raw - 1] + 1 or bit % 8 == 0]
    ends = [*starts[1:], len(bits)]
    return tuple(Segment(bits[raw] // 8, bits[raw] % 8, end - raw, raw) for raw, end in zip(starts, ends, strict=True))
