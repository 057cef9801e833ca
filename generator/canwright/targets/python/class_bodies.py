"""The body of a class with fields: its types, constructor, `unpack` and properties."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeGuard

from ...model.exhaustive import assert_never
from ...model.joined import JoinedText
from ...model.layout import (
    ChecksumRole,
    Field,
    FixedRole,
    GivenRole,
    Layout,
    ParameterRole,
    Variant,
)
from ...model.message import Message
from ...model.types import Parameter
from ...semantics.plan import (
    CheckChecksum,
    CheckConstant,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    ReadField,
    message_plan,
)
from . import bits, code, docstrings, text, types
from .checksums import Checksums
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
    value: tuple[code.Code, ...]
    """The statements that return the value; of `raw` for an optional field."""
    to_raw: code.Code
    """Expression of the raw integer, of the keyword."""
    type: code.Code
    """The item of `TYPES`."""
    doc: docstrings.Docstring


def varying(fields: Iterable[Field]) -> list[Field]:
    """The fields that a message stores: those whose value is not fixed."""
    return [field for field in fields if field.is_given]


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
    given += " | str" if field.type.is_number and field.type.members else ""
    given += " | None" if field.type.no_values else ""
    type_item = f"{name}: {type_.constant}"
    value: tuple[code.Code, ...]
    if field.type.joined is not None:
        joined = field.type.joined
        of_all = code.call(f"value: {python} = self.TYPES[{name}].value", (raw, "self._parameters", name))
        value = of_all, "return value"
        is_text = isinstance(joined, JoinedText)
        arguments = [type_.constant, str(joined.count)]
        if isinstance(joined, JoinedText):
            arguments += [text.literal(joined.codec), str(joined.padding)]
        type_item = f"{name}: {use('TextType' if is_text else 'DigitsType')}({', '.join(arguments)})"
        raw_python, given = "tuple[int, ...]", "str" if is_text else given
    elif field.is_array:
        inline = types.inline_value(field.type, "one") if not type_.enum else None
        of_one = inline or code.call(f"{type_.constant}.value", ("one", "self._parameters", name))
        value = (code.Parts("return tuple", (of_one, f"for one in {raw}")),)
        type_item = f"{name}: {use('ArrayType')}({type_.constant}, {len(field.elements)})"
        python, raw_python, given = f"tuple[{python}, ...]", "tuple[int, ...]", f"{use('Iterable')}[{given}]"
    else:
        inline = types.inline_value(field.type, raw) if not type_.enum else None
        of_raw = code.call(f"return {type_.constant}.value", (raw, "self._parameters", name))
        value = (f"return {inline}" if inline else of_raw,)
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


def whole(field: Field, parameter: str, parameters: str, imports: Imports) -> str:
    """The expression of the raw integer of a constant that is a parameter."""
    name = text.literal(text.attribute(parameter))
    return f"{imports.use('whole')}({parameters}, {name}, {text.literal(field.name)})"


def storage(layout: Layout) -> dict[Field, int]:
    """The place of each field among the raw integers of a message; fields that never exist together share places."""
    places: dict[Field, int] = {}
    for field in varying(layout.fields):
        beside = (neighbour for variant in layout.variants if field in variant.fields for neighbour in variant.fields)
        places[field] = 1 + max((places[neighbour] for neighbour in beside if neighbour in places), default=-1)
    return places


def positions(
    fields: Iterable[Field], stored: Mapping[Field, int], imports: Imports
) -> list[tuple[Field, bits.RawPosition]]:
    """Where each element of the fields except the checksum is on the wire.

    Its target is its raw integer, at the place where it is `stored`, or that of a fixed field.
    """
    listed = []
    for field in fields:
        role = field.role
        for i, element in enumerate(field.elements):
            match role:
                case FixedRole():
                    target = f"0x{role.raw & (1 << field.type.width) - 1:X}"
                    listed.append((field, bits.place(target, field, element)._replace(signed=False)))
                case ParameterRole():
                    target = whole(field, role.parameter, "self._parameters", imports)
                    listed.append((field, bits.place(target, field, element)._replace(signed=False)))
                case GivenRole():
                    target = f"self._raws[{stored[field]}]" + (f"[{i}]" if field.is_array else "")
                    listed.append((field, bits.place(target, field, element)))
                case ChecksumRole():
                    pass
                case _:
                    assert_never(role)
    return listed


def _is_of_variant(step: DecodingStep) -> TypeGuard[CheckConstant | CheckParameter]:
    """Whether a step is a check after the parameters are known: of a field of some variants, or of one that is a parameter."""
    return isinstance(step, CheckParameter) or (isinstance(step, CheckConstant) and bool(step.field.only))


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
    counters: code.Code
    """The counter of each field that is one, by name."""
    parameter: str
    """The parameter that decides on the variant; empty where there is one variant only."""
    variants: tuple[code.Code, ...]
    """The names of the fields of each variant."""
    variant_of: tuple[tuple[str, int], ...]
    """Each value of that parameter, with the index of its variant."""
    checks: tuple[code.Code, ...]
    """The checks of the constants of all variants, and of the checksum."""
    reads: tuple[tuple[code.Code, ...], ...]
    """The statements that read each variant; one item where all are read in the same way."""
    to_raws: code.Code
    """The statement of the constructor that stores the raw integers."""
    has_node: bool
    needs_id: bool
    """Whether the constructor rejects a message whose id contains an unknown parameter."""
    depends: code.Code | None
    """The names of the parameters on which the fields depend; None without any."""
    has_only: bool
    """Whether only some nodes have the command of one of the messages."""
    is_confusable: bool
    """Whether some values of one of the messages are refused, because its frame would be another message."""
    code: str
    """The code that is sent unless another is given; empty if there is one at most."""
    code_read: str
    """The expression of the code of received data."""
    checked_when_decoded: str
    """The expression that is true if every decoded message can be encoded again."""

    @property
    def takes_parameters(self) -> bool:
        return self.has_only or self.depends is not None


@dataclass(frozen=True, kw_only=True)
class ClassBodies:
    """Makes the bodies of the classes of one edition."""

    types: Mapping[str, types.TypeView]
    parameters: Mapping[str, Parameter]
    imports: Imports
    checksums: Checksums
    sets: dict[tuple[str, ...], str] = dataclasses.field(default_factory=dict)
    """The sets of parameter values that the bodies use, each with its name."""
    unpacked: dict[str, str] = dataclasses.field(default_factory=dict)
    """The formats of `struct` that read data, each with the name of its function."""
    packed: dict[str, str] = dataclasses.field(default_factory=dict)
    """Those that write data."""

    def body(self, messages: Sequence[Message], nodes: Sequence[int]) -> BodyView:
        """The body for the fields of messages with the same layout; `nodes` are those of elements of arrays."""
        message, has_only = messages[0], any(message.only for message in messages)
        is_confusable = any(message.confusions for message in messages)
        layout, dlc = message.layout, message.dlc
        is_always_valid = not is_confusable and all(field_.type.accepts_every_raw for field_ in storage(layout))
        stored, codes = storage(layout), message_plan(message).codes if len(messages) == 1 else ()
        varies, depends = len(layout.variants) > 1, [text.literal(text.attribute(n)) for n in parameters_of(message)]
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
        steps = message_plan(message).decoding
        reads = tuple(tuple(self._read(variant, steps, stored, dlc)) for variant in layout.variants)
        return BodyView(
            fields=fields,
            raws_python=code.Items("_raws: tuple[", tuple(raws[place] for place in sorted(raws)) or ("()",), "]"),
            match_args=code.tuple_of(
                (text.literal(view.attribute) for view in fields if not view.only), "__match_args__ = "
            ),
            types=code.dict_of((view.type for view in fields), "TYPES = "),
            counters=code.dict_of(self._counters(stored), "COUNTERS = "),
            parameter=text.attribute(layout.parameter or "") if varies else "",
            variants=tuple(_names(variant, stored) for variant in layout.variants),
            variant_of=tuple(
                (key, i)
                for i, variant in enumerate(layout.variants)
                for key in variant_values(layout, variant, self.parameters)
            ),
            checks=tuple(check for step in steps if not _is_of_variant(step) for check in self._check(step, dlc)),
            reads=reads[:1] if len(set(reads)) == 1 else reads,
            to_raws=to_raws,
            has_node=message.id.nodes is not None,
            needs_id=message.id.parameter is not None,
            depends=code.tuple_of(depends, "DEPENDS = ") if depends else None,
            has_only=has_only,
            is_confusable=is_confusable,
            code=f"0x{codes[0]:02X}" if codes else "",
            code_read=bits.read_key(message.keys[0], dlc) if codes else "",
            checked_when_decoded="not cls.ONLY" if has_only and is_always_valid else str(is_always_valid),
        )

    def _counters(self, fields: Iterable[Field]) -> Iterator[code.Code]:
        """The items of `COUNTERS`."""
        for field_ in fields:
            if field_.counter:
                made = f"{self.imports.use('Counter')}({field_.counter.first}, {field_.counter.last})"
                yield f"{text.literal(text.attribute(field_.name))}: {made}"

    def _set(self, layout: Layout, field_: Field) -> str:
        """The name of the set of parameter values under which a field exists."""
        parameter = self.parameters[layout.parameter or ""]
        values = tuple(types.parameter_key(parameter, value) for value in field_.only)
        return self.sets.setdefault(values, f"_ONLY_{len(self.sets) + 1}")

    def _check(self, step: DecodingStep, dlc: int) -> Iterator[code.Code]:
        """The statements of a check; none for a step that is none."""
        match step:
            case CheckConstant():
                yield from self._constant(step.field, str(step.raw), dlc)
            case CheckParameter():
                yield from self._constant(
                    step.field, whole(step.field, step.parameter, "parameters", self.imports), dlc
                )
            case CheckChecksum():
                yield self.checksums.check(step, dlc)
            case ChooseFields() | ReadField():
                pass  # the variants of the body, and what they read
            case _:
                assert_never(step)

    def _constant(self, field_: Field, required: str, dlc: int) -> Iterator[code.Code]:
        for element in field_.elements:
            read = bits.read(bits.place("", field_, element), dlc)
            yield code.call(self.imports.use("constant"), (read, required, text.literal(field_.name)))

    def _read(
        self, variant: Variant, steps: Iterable[DecodingStep], stored: Mapping[Field, int], dlc: int
    ) -> Iterator[code.Code]:
        """The statements that check the constants of a variant alone, and store the raw integers."""
        for step in steps:
            if _is_of_variant(step) and step.field in variant.fields:
                yield from self._check(step, dlc)
        own = positions(varying(variant.fields), stored, self.imports)
        ordered = sorted((position for _, position in own), key=lambda position: position.first_byte)
        pattern = bits.struct_format(ordered, dlc)
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
        if pattern:
            unpack = self.unpacked.setdefault(pattern, f"_UNPACK_{len(self.unpacked) + 1}")
            yield f"{'self._raws' if is_whole else 'found'} = {unpack}(data)"
        if not is_whole:
            yield code.tuple_of(raws, "self._raws = ")


def _names(variant: Variant, stored: Mapping[Field, int]) -> code.Code:
    """The name of the field at each place; None where a variant has no field."""
    names = {stored[field]: text.literal(text.attribute(field.name)) for field in varying(variant.fields)}
    return code.tuple_of(names.get(place, "None") for place in range(max(stored.values(), default=-1) + 1))


def variant_values(layout: Layout, variant: Variant, parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """The parameter values of a variant; none where the layout has one variant only."""
    if layout.parameter is None or len(layout.variants) == 1:
        return ()
    return tuple(types.parameter_key(parameters[layout.parameter], value) for value in variant.values)


def parameters_of(message: Message) -> tuple[str, ...]:
    """The parameters on which id, fields, values or ranges of a message depend."""
    numbers = (name for f in message.layout.fields for name in f.type.numbers)
    return tuple(dict.fromkeys((*message.layout.parameters, *numbers, *message.parameters)))


def depends_on_parameters(message: Message) -> bool:
    """Whether id, fields, values or ranges of a message depend on parameters."""
    return bool(parameters_of(message))
