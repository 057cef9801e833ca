"""Resolver of layouts: fields with their bits."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from fractions import Fraction

from ..diagnostics.diagnostic import DocumentPath
from ..language import edition as schema
from ..language.notation import At, RawFormat, frame_bits, run_bits
from ..model.checksum import ALGORITHMS, Algorithm, Arithmetic, IdBytes
from ..model.joined import JoinedDigits
from ..model.layout import (
    ChecksumRole,
    ConstantRole,
    CounterRole,
    Element,
    Field,
    Layout,
    NodeRole,
    ParameterRole,
    ReservedRole,
    Role,
    Segment,
    Space,
    ValueRole,
    Variant,
)
from ..model.types import Bound, ByParameter, Encoding, Order, Parameter, Range, Text, Type
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
        self._spec = spec
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
        resolved = without_shared_bits(tuple(self._field((*fields_at, n), n, f, manual) for n, f in fields.items()))
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
        if written.entry is not None:
            written = self._of_entry(path, written, written.entry)
        type_ = self._type(path, written)
        indices = written.array
        if type_.joined is not None:
            self._check_joined(path, written)
            indices = range(1, type_.joined.count + 1)
        count = len(indices) if indices else 1
        space = Space.DATA if isinstance(written.at, list) else written.at.space
        if path not in self._counted:
            self._counted.add(path)
            self._report.count(Limited.FIELDS, count, path)
        bits = self._bits(path, written, type_, count)
        elements = []
        for i in range(count):
            offset = i * type_.width if type_.order is Order.LITTLE or space is Space.ID else None
            first = offset if offset is not None else type_.width * (count - 1 - i)
            if isinstance(type_.joined, JoinedDigits) and offset is not None:
                first = type_.width * (count - 1 - i)  # the most significant digit comes first
            elements.append(
                Element(
                    indices[i] if indices else None,
                    segments_of(bits[first : first + type_.width], space),
                )
            )
        of_type = type_.title if type_.title != implied_title(type_.name, self._languages) else dict[str, str]()
        title = titled(written.title if any(written.title.values()) or not any(of_type.values()) else of_type, name)
        return Field(
            name=name,
            renamed_from=written.renamed_from,
            deprecated=deprecation(written.deprecated),
            type=type_,
            space=space,
            elements=tuple(elements),
            is_array=indices is not None,
            only=tuple(v for values in self.only(path, written.only).values() for v in values),
            role=_role(written, type_),
            variable=written.variable,
            title=title,
            about=written.about,
            manual=written.manual or manual,
            manual_name=written.manual_name or "",
            path=path,
        )

    def _bits(self, path: DocumentPath, written: schema.FieldSpec, type_: Type, count: int) -> tuple[int, ...]:
        """Frame bits of a field from the least significant raw bit up."""
        if not isinstance(written.at, list):
            return frame_bits(written.at, type_.width * count, type_.order)
        order = type_.order
        runs = [run_bits(run, order) for run in written.at]
        bits = tuple(bit for run in (runs if order is Order.LITTLE else reversed(runs)) for bit in run)
        text = hint = ""
        if count > 1:
            text, hint = "an array has one run of bits", "write its start, or one field for each element"
        elif not all(runs):
            text = f"run {runs.index(()) + 1} is written against the byte order, which is {order.value}-endian"
            hint = "write it from the lower bit up" if order is Order.LITTLE else "write it from the higher bit down"
        elif len(set(bits)) < len(bits):
            text, hint = "the runs have bits in common", "write each bit once"
        elif len(bits) != type_.width:
            text = f"the runs have {len(bits)} bits, but the field has {type_.width}"
            hint = "write each run with both ends, as 2..3 for bytes 2 and 3 and 4.5..4.7 for three bits of byte 4"
        if text:
            self._report.finding((*path, "at"), "bit-runs", text, hint)
            return frame_bits(written.at[0].first, type_.width * count, order)
        return bits

    def _of_entry(self, path: DocumentPath, written: schema.FieldSpec, name: str) -> schema.FieldSpec:
        """The field with all that it takes from the value of a table entry."""
        entries = [(table, table.entries[name]) for table in self._spec.tables.values() if name in table.entries]
        table, entry = entries[0]
        layout = entry.layout if not isinstance(entry.layout, str) else self._spec.layouts[entry.layout].fields
        values = [f for f in layout.values() if (f.constant, f.reserved, f.entry) == (None,) * 3]
        if len(values) != 1 or len(entries) > 1:
            text = f"{len(entries)} tables have an entry `{name}`" if len(entries) > 1 else ""
            text = (
                text or f"the entry `{name}` has {len(values)} values of its own, so it cannot be the type of a field"
            )
            hint = "write `type` or `raw`, or give the entries different names"
            self._report.finding((*path, "entry"), "field-type", text, hint)
            return dataclasses.replace(written, entry=None, raw=RawFormat(Encoding.UNSIGNED, 8))
        value = values[0]
        titles = (written.title, value.title, entry.title)
        return dataclasses.replace(
            written,
            entry=None,
            type=value.type,
            raw=value.raw,
            byte_order=value.byte_order,
            array=written.array or value.array,
            title=next((title for title in titles if any(title.values())), written.title),
            about=written.about if any(written.about.values()) else value.about,
            manual=written.manual or value.manual or entry.manual or table.manual,
            manual_name=written.manual_name or value.manual_name,
        )

    def _check_joined(self, path: DocumentPath, written: schema.FieldSpec) -> None:
        """Reports keys that a text or a number of decimal digits cannot have."""
        for key in ("array", "constant", "reserved", "holds"):
            if getattr(written, key) is not None:
                text = f"a text or a number of decimal digits has no `{key}`"
                self._report.finding((*path, key), "no-effect", text, "remove it", key=True)

    def _type(self, path: DocumentPath, written: schema.FieldSpec) -> Type:
        if written.raw is None:
            return self._types[written.type or ""]
        bare = bare_type(written.raw, written.byte_order or self._order, self._languages, path)
        if bare.order is not self._order:
            bare = dataclasses.replace(bare, name=f"{bare.name}_{bare.order.value}")
        values = written.counter
        if values and (values[0], values[-1]) != bare.raw_limits:
            limits = Range(Bound(Fraction(values[0])), Bound(Fraction(values[-1])))
            name = f"{bare.name}_{values[0]}_{values[-1]}"
            bare = dataclasses.replace(bare, name=name, raw_range=ByParameter.always(limits))
        return self.bare_types.setdefault(bare.name, bare)


def without_shared_bits(fields: tuple[Field, ...]) -> tuple[Field, ...]:
    """The fields, flags without the bits that they do not name and that are those of another field.

    Bits that both name are reported as an overlap.
    """
    return tuple(_alone(field, fields) if field.type.flags else field for field in fields)


def _alone(flags: Field, fields: Sequence[Field]) -> Field:
    """Flags without the bits of other fields that can exist at the same time."""
    beside = (f for f in fields if f is not flags and (not f.only or not flags.only or {*f.only} & {*flags.only}))
    taken = {bit for f in beside if f.space is flags.space for e in f.elements for bit in e.bits}
    named = {flag.value for flag in flags.type.flags}
    if flags.space is Space.ID or not taken & {bit for e in flags.elements for bit in e.bits}:
        return flags
    elements = []
    for element in flags.elements:
        own = [(raw, bit) for raw, bit in enumerate(element.bits) if raw in named or bit not in taken]
        elements.append(Element(element.index, _joined(own)))
    return dataclasses.replace(flags, elements=tuple(elements))


def segments_at(start: At, width: int, order: Order) -> tuple[Segment, ...]:
    return segments_of(frame_bits(start, width, order), start.space)


@functools.lru_cache(maxsize=1 << 12)
def segments_of(bits: tuple[int, ...], space: Space) -> tuple[Segment, ...]:
    """Frame bits, from the least significant raw bit up, as segments within one byte each.

    Cached, because many messages have fields with the same bits.
    """
    if space is Space.ID:
        return (Segment(0, bits[0], len(bits), 0),)
    return _joined(tuple(enumerate(bits)))


def _joined(bits: Sequence[tuple[int, int]]) -> tuple[Segment, ...]:
    """Segments of raw bits in ascending order, each with its bit in the data."""
    segments: list[Segment] = []
    for raw, bit in bits:
        last = segments[-1] if segments else None
        if last and (last.byte, last.low + last.width, last.raw_low + last.width) == (bit // 8, bit % 8, raw):
            segments[-1] = Segment(last.byte, last.low, last.width + 1, last.raw_low)
        else:
            segments.append(Segment(bit // 8, bit % 8, 1, raw))
    return tuple(segments)


def _role(written: schema.FieldSpec, type_: Type) -> Role:
    if written.holds is not None:
        return NodeRole()
    if written.counter is not None:
        return CounterRole(written.counter[0], written.counter[-1])
    if written.checksum is not None:
        return _checksum(written.checksum, type_)
    if written.constant is not None:
        return ConstantRole(written.constant) if isinstance(written.constant, int) else ParameterRole(written.constant)
    return ValueRole() if written.reserved is None else ReservedRole(written.reserved)


def _checksum(written: schema.ChecksumSpec, type_: Type) -> ChecksumRole:
    """The checksum of a field; a named CRC keeps its width, which a rule compares with that of the field."""
    if written.algorithm is None:
        own = (written.poly or 0, written.init, written.reflected, written.xor_out)
        algorithm = Algorithm(Arithmetic.CRC, type_.width, *own)
    else:
        named = ALGORITHMS[written.algorithm]
        algorithm = named.of_width(named.width or type_.width)
    inputs = written.over if isinstance(written.over, list) else [written.over]
    return ChecksumRole(
        name=written.algorithm or "",
        algorithm=algorithm,
        inputs=tuple(IdBytes(type_.order, part == "id_low") if isinstance(part, str) else part for part in inputs),
    )
