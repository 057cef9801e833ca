"""The body of a class with fields: its types, constructor, `unpack` and properties."""

from __future__ import annotations

import dataclasses
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeGuard

from ...model.exhaustive import assert_never
from ...model.joined import JoinedText
from ...model.layout import Field, Layout, Variant
from ...model.message import Message
from ...model.types import Parameter
from ...semantics.plan import (
    CheckAvailable,
    CheckChecksum,
    CheckCode,
    CheckConstant,
    CheckField,
    CheckMeaning,
    CheckNode,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    NeedParameter,
    ReadField,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
    message_plan,
)
from . import bits, code, docstrings, text, types
from .checksums import Checksums
from .imports import Imports


class FieldView:
    """A field that a user sets and reads.

    `place` is its position among the raw integers of the message; `only` is the set of parameter values under which it
    exists, empty for a field that always exists.
    """

    def __init__(
        self, bodies: ClassBodies, layout: Layout, field: Field, place: int, only: str, nodes: Sequence[int]
    ) -> None:
        attribute, use, type_ = text.attribute(field.name), bodies.imports.use, bodies.types[field.type.name]
        name = text.literal(attribute)
        raw = "raw" if only else f"self._raws[{place}]"
        python, given = type_.python, f"{type_.enum} | int" if type_.enum else use("Real")
        given += " | str" if field.type.is_number and field.type.members else ""
        given += " | None" if field.type.no_values else ""
        self.attribute, self.place, self.only = attribute, place, only
        self.raw_python = "tuple[int, ...]" if field.is_array or field.type.joined is not None else "int"
        """The type of its raw integer, or integers."""
        self.type: code.Code = f"{name}: {type_.constant}"
        """The item of `TYPES`."""
        self.value: Sequence[code.Code]
        """The statements that return the value; of `raw` for an optional field."""
        if field.type.joined is not None:
            joined = field.type.joined
            of_all = code.call(f"value: {python} = self.TYPES[{name}].value", (raw, "self._parameters", name))
            self.value = of_all, "return value"
            kind, arguments = "DigitsType", [type_.constant, str(joined.count)]
            if isinstance(joined, JoinedText):
                kind, given = "TextType", "str"
                arguments += [text.literal(joined.codec), str(joined.padding)]
            self.type = f"{name}: {use(kind)}({', '.join(arguments)})"
        elif field.is_array:
            inline = types.inline_value(field.type, "one") if not type_.enum else None
            of_one = inline or code.call(f"{type_.constant}.value", ("one", "self._parameters", name))
            self.value = [code.Parts("return tuple", (of_one, f"for one in {raw}"))]
            self.type = f"{name}: {use('ArrayType')}({type_.constant}, {len(field.elements)})"
            python, given = f"tuple[{python}, ...]", f"{use('Iterable')}[{given}]"
        else:
            inline = types.inline_value(field.type, raw) if not type_.enum else None
            of_raw = code.call(f"return {type_.constant}.value", (raw, "self._parameters", name))
            self.value = [f"return {inline}" if inline else of_raw]
        of_type = f"self.TYPES[{name}]" if field.is_array else type_.constant
        self.given = given
        """The type of its keyword."""
        self.header = code.Items(f"def {attribute}(", ("self",), f") -> {python}:")
        """The first line of the property of its value."""
        self.to_raw = code.call(f"{of_type}.raw", (attribute, "self._parameters", name))
        """Expression of the raw integer, of the keyword."""
        self.doc = docstrings.of_field(field, type_.meaning, layout.manual, nodes)


def whole(field: Field, parameter: str, parameters: str, imports: Imports) -> str:
    """The expression of the raw integer of a constant that is a parameter."""
    name = text.literal(text.attribute(parameter))
    return f"{imports.use('whole')}({parameters}, {name}, {text.literal(field.name)})"


def storage(layout: Layout) -> dict[Field, int]:
    """The place of each field among the raw integers of a message; fields that never exist together share places."""
    places: dict[Field, int] = {}
    for field in layout.given:
        beside = (neighbour for variant in layout.variants if field in variant.fields for neighbour in variant.fields)
        places[field] = 1 + max((places[neighbour] for neighbour in beside if neighbour in places), default=-1)
    return places


def positions(
    message: Message, fields: Container[Field], stored: Mapping[Field, int], imports: Imports
) -> list[tuple[Field, bits.RawPosition]]:
    """Where each element of the fields except the checksum is on the wire.

    Its target is its raw integer, at the place where it is `stored`, or that of a fixed field.
    """
    listed: list[tuple[Field, bits.RawPosition]] = []
    for step in message_plan(message).encoding:
        match step:
            case WriteFixed(space=space, segments=segments, raw=raw, field=field):
                if field is not None and field in fields:
                    order, width = field.type.order, field.type.width
                    target = f"0x{raw & (1 << width) - 1:X}"
                    listed.append((field, bits.RawPosition(target, space, order, False, width, segments)))
            case WriteParameter(field=field, parameter=parameter):
                if field in fields:
                    target = whole(field, parameter, "self._parameters", imports)
                    listed.append((field, bits.place(target, field, field.elements[0])._replace(signed=False)))
            case WriteField(field=field):
                for i, element in enumerate(field.elements if field in fields else ()):
                    target = f"self._raws[{stored[field]}]" + (f"[{i}]" if field.is_array else "")
                    listed.append((field, bits.place(target, field, element)))
            case CheckAvailable() | CheckCode() | CheckNode() | NeedParameter() | ChooseFields() | CheckField():
                pass  # the constructor, and the types of its arguments
            case WriteCode() | WriteChecksum() | CheckMeaning():
                pass  # of the whole message, in `encoding`
            case _:
                assert_never(step)
    return sorted(listed, key=lambda item: message.layout.fields.index(item[0]))


def _is_of_variant(step: DecodingStep) -> TypeGuard[CheckConstant | CheckParameter]:
    """Whether a step is a check after the parameters are known: of a field of some variants, or of one that is a parameter."""
    return isinstance(step, CheckParameter) or (isinstance(step, CheckConstant) and bool(step.field.only))


class BodyView:
    """The body of a class for the fields of messages with the same layout; `nodes` are those of elements of arrays."""

    def __init__(self, bodies: ClassBodies, messages: Sequence[Message], nodes: Sequence[int]) -> None:
        message, layout, dlc = messages[0], messages[0].layout, messages[0].dlc
        stored, codes = storage(layout), message_plan(message).codes if len(messages) == 1 else ()
        varies, depends = len(layout.variants) > 1, [text.literal(text.attribute(n)) for n in parameters_of(message)]
        steps = message_plan(message).decoding
        self.has_only = any(message.only for message in messages)
        """Whether only some nodes have the command of one of the messages."""
        self.is_confusable = any(message.confusions for message in messages)
        """Whether some values of one of the messages are refused, because its frame would be another message."""
        self.fields = fields = [
            FieldView(
                bodies, layout, field, place, bodies.set_of(layout, field) if varies and field.only else "", nodes
            )
            for field, place in stored.items()
        ]
        raws = {view.place: bodies.imports.use("Any") if view.only else view.raw_python for view in fields}
        self.raws_python = code.Items("_raws: tuple[", tuple(raws[place] for place in sorted(raws)) or ("()",), "]")
        """The declaration of the raw integers."""
        always = (text.literal(view.attribute) for view in fields if not view.only)
        self.match_args = code.tuple_of(always, "__match_args__ = ")
        self.types = code.dict_of((view.type for view in fields), "TYPES = ")
        self.counters = code.dict_of(bodies.counters(stored), "COUNTERS = ")
        """The counter of each field that is one, by name."""
        self.parameter = text.attribute(layout.parameter or "") if varies else ""
        """The parameter that decides on the variant; empty where there is one variant only."""
        self.variants = [_names(variant, stored) for variant in layout.variants]
        """The names of the fields of each variant."""
        self.variant_of = [
            (key, i)
            for i, variant in enumerate(layout.variants)
            for key in variant_values(layout, variant, bodies.parameters)
        ]
        """Each value of that parameter, with the index of its variant."""
        self.checks = [check for step in steps if not _is_of_variant(step) for check in bodies.check(step, dlc)]
        """The checks of the constants of all variants, and of the checksum."""
        reads = [tuple(bodies.read(message, variant, stored)) for variant in layout.variants]
        self.reads = reads[:1] if len(set(reads)) == 1 else reads
        """The statements that read each variant; one item where all are read in the same way."""
        self.to_raws = code.tuple_of((view.to_raw for view in fields), "self._raws = ")
        """The statement of the constructor that stores the raw integers."""
        if varies:
            given = (f"{view.attribute}={view.attribute}" for view in fields)
            self.to_raws = code.call("self._raws = self._raws_of", given)
        self.has_node = message.id.nodes is not None
        self.needs_id = message.id.parameter is not None
        """Whether the constructor rejects a message whose id contains an unknown parameter."""
        self.depends = code.tuple_of(depends, "DEPENDS = ") if depends else None
        """The names of the parameters on which the fields depend; None without any."""
        self.takes_parameters = self.has_only or self.depends is not None
        self.code = f"0x{codes[0]:02X}" if codes else ""
        """The code that is sent unless another is given; empty if there is one at most."""
        self.code_read = bits.read_key(message.keys[0], dlc) if codes else ""
        """The expression of the code of received data."""
        is_always_valid = not self.is_confusable and all(field.type.accepts_every_raw for field in stored)
        self.checked_when_decoded = "not cls.ONLY" if self.has_only and is_always_valid else str(is_always_valid)
        """The expression that is true if every decoded message can be encoded again."""


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

    def counters(self, fields: Iterable[Field]) -> Iterator[code.Code]:
        """The items of `COUNTERS`."""
        for field_ in fields:
            if field_.counter:
                made = f"{self.imports.use('Counter')}({field_.counter.first}, {field_.counter.last})"
                yield f"{text.literal(text.attribute(field_.name))}: {made}"

    def set_of(self, layout: Layout, field_: Field) -> str:
        """The name of the set of parameter values under which a field exists."""
        parameter = self.parameters[layout.parameter or ""]
        values = tuple(types.parameter_key(parameter, value) for value in field_.only)
        return self.sets.setdefault(values, f"_ONLY_{len(self.sets) + 1}")

    def check(self, step: DecodingStep, dlc: int) -> Iterator[code.Code]:
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

    def read(self, message: Message, variant: Variant, stored: Mapping[Field, int]) -> Iterator[code.Code]:
        """The statements that check the constants of a variant alone, and store the raw integers."""
        dlc = message.dlc
        for step in message_plan(message).decoding:
            if _is_of_variant(step) and step.field in variant.fields:
                yield from self.check(step, dlc)
        own = positions(message, variant.given, stored, self.imports)
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
    names = {stored[field]: text.literal(text.attribute(field.name)) for field in variant.given}
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
