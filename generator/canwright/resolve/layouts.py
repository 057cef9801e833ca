"""Resolver of layouts: fields with their bits."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..language import edition as schema
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
from .report import Limited, Report
from .titles import implied_title, titled
from .types import bare_type, deprecation


class LayoutResolver:
    """Resolver of layouts; `bare_types` are the types of fields with only a raw format."""

    def __init__(
        self,
        report: Report,
        spec: schema.EditionSpec,
        parameters: Mapping[str, Parameter],
        types: Mapping[str, Type],
    ) -> None:
        self._report = report
        self._order = spec.byte_order
        self._languages: Sequence[str] = spec.languages
        self._parameters = parameters
        self._types = types
        self._counted: set[DocumentPath] = set()
        self.bare_types: dict[str, Type] = {}

    def only(self, path: DocumentPath, written: Mapping[str, Sequence[str]] | None) -> dict[str, tuple[str, ...]]:
        """A condition on parameters, with a finding for one that is not a choice."""
        for name in written or {}:
            if not self._parameters[name].is_choice:
                text = f"`only` requires a choice, but `{name}` is a number"
                hint = "use a parameter with `values`"
                self._report.finding((*path, "only", name), "parameter-kind", text, hint, key=True)
        return {name: tuple(values) for name, values in (written or {}).items()}

    def shared(self, path: DocumentPath, name: str, written: schema.LayoutSpec, fields_at: DocumentPath) -> Layout:
        """A shared layout; `fields_at` is the path of its fields."""
        title = titled(written.title, name)
        return self._layout(path, fields_at, name, written.fields, title, written.about, written.manual or "", True)

    def own(self, path: DocumentPath, name: str, fields: schema.Fields, title: Text, manual: str) -> Layout:
        """The layout of one message."""
        about = dict.fromkeys(self._languages, "")
        return self._layout(path, path, name, fields, title, about, manual, False)

    def joined(self, path: DocumentPath, name: str, layout: Layout, more: schema.Fields) -> Layout:
        """The layout of one message: the fields of another layout, and `more` fields at `path`."""
        own = self._layout(path, path, name, more, layout.title, layout.about, layout.manual, False)
        if None not in (own.parameter, layout.parameter) and own.parameter != layout.parameter:
            text = f"these fields depend on {own.parameter}, those of `{layout.name}` on {layout.parameter}"
            self._report.finding(path, "two-parameters", text, "define a separate layout for the command")
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
        resolved = tuple(self._field((*fields_at, n), n, f, manual) for n, f in fields.items())
        conditions = dict.fromkeys(p for f in fields.values() for p in f.only or {})
        if len(conditions) > 1:
            names = ", ".join(conditions)
            self._report.finding(
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
        if parameter is None:
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
        if path not in self._counted:
            self._counted.add(path)
            self._report.count(Limited.FIELDS, count, path)
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
        of_type = type_.title if type_.title != implied_title(type_.name, self._languages) else dict[str, str]()
        title = titled(written.title if any(written.title.values()) or not any(of_type.values()) else of_type, name)
        return Field(
            name=name,
            renamed_from=written.renamed_from,
            deprecated=deprecation(written.deprecated),
            type=type_,
            space=start.space,
            elements=tuple(elements),
            is_array=written.array is not None,
            only=tuple(v for values in self.only(path, written.only).values() for v in values),
            role=_role(written),
            title=title,
            about=written.about,
            manual=written.manual or manual,
            path=path,
        )

    def _type(self, path: DocumentPath, written: schema.FieldSpec) -> Type:
        if written.raw is None:
            return self._types[written.type or ""]
        bare = bare_type(written.raw, written.byte_order or self._order, self._languages, path)
        if bare.order is not self._order:
            bare = dataclasses.replace(bare, name=f"{bare.name}_{bare.order.value}")
        return self.bare_types.setdefault(bare.name, bare)


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


def _role(written: schema.FieldSpec) -> FieldRole:
    if written.holds is not None:
        return NodeRole()
    if written.constant is not None:
        return ConstantRole(written.constant)
    return ValueRole() if written.reserved is None else ReservedRole(written.reserved)
