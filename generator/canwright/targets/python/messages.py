"""Messages as the classes of a generated module."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ...model.edition import (
    Command,
    Direction,
    Edition,
    Field,
    Layout,
    Message,
    Order,
    Parameter,
    Space,
    Variant,
)
from . import bits, facts, text, types
from .imports import Imports
from .types import TypeView


@dataclass(frozen=True)
class FieldView:
    """A field as a property, a keyword and a slot."""

    name: str
    attribute: str
    optional: bool
    count: int
    python: str
    given: str
    value: str
    """Expression of the value, of `self`."""
    to_raw: str
    """Expression of the raw integer, of the keyword."""
    check: str
    """Expression of the function that checks the raw integer."""
    doc: tuple[str, ...]

    @property
    def raw_python(self) -> str:
        return "tuple[int, ...]" if self.count else "int"


class ConstantView(NamedTuple):
    """A field that always has the same value: the expression that reads it, and the value."""

    read: str
    value: str
    name: str


class ReadView(NamedTuple):
    """The expression that reads the raw integer, or integers, of a field."""

    attribute: str
    expression: str


class CaseView(NamedTuple):
    """How fields are read under some values of the layout's parameter: all by one `struct`, or each on its own."""

    values: tuple[str, ...]
    names: tuple[str, ...]
    struct: str
    targets: tuple[str, ...]
    """What the `struct` is assigned to."""
    reads: tuple[ReadView, ...]
    constants: tuple[ConstantView, ...]


class EncodeCaseView(NamedTuple):
    """The expression of the data bytes under some values of the layout's parameter."""

    values: tuple[str, ...]
    expression: str


class EncodeView(NamedTuple):
    """How data bytes are written; `parameter` decides among several cases."""

    parameter: str
    cases: tuple[EncodeCaseView, ...]


class BodyView(NamedTuple):
    """The body of a class with fields; `has_node` and `depends` decide its keywords.

    `constants` are those of every case; they are checked before the case is chosen.
    """

    fields: tuple[FieldView, ...]
    constants: tuple[ConstantView, ...]
    cases: tuple[CaseView, ...]
    parameter: str
    has_node: bool
    depends: bool


class MessageView(NamedTuple):
    """The class of a message; `body` is None when a base class has its fields."""

    name: str
    bases: tuple[str, ...]
    doc: tuple[str, ...]
    command: str
    direction: str
    dlc: int
    extended: bool
    remote: bool
    nodes: tuple[int, int] | None
    body: BodyView | None
    id: str
    step: int
    code: str
    data: str
    """Expression of the bytes of a frame without fields; empty for one with fields."""
    can_id: str
    """Expression of the id, where it has fields."""
    encode: EncodeView | None
    metadata: tuple[tuple[str, str], ...]
    """Names and expressions of class attributes."""


class LayoutView(NamedTuple):
    """A base class for the messages that share a layout."""

    name: str
    doc: tuple[str, ...]
    body: BodyView
    encode: EncodeView | None
    """How all of them write their bytes; None when they differ in more than their code."""


Group = tuple[str, int, bool]


def group(message: Message) -> Group:
    """Messages of one group have one base class."""
    return message.layout.name, message.dlc, message.id.nodes is not None


def _bases(groups: Iterable[Group]) -> dict[Group, str]:
    """The base class of each group: the layout's name, with a number where several groups have that layout."""
    of_layout: dict[str, list[Group]] = {}
    for one in groups:
        of_layout.setdefault(one[0], []).append(one)
    return {
        one: text.class_name(name) + (str(number) if len(same) > 1 else "")
        for name, same in of_layout.items()
        for number, one in enumerate(same, 1)
    }


def _is_alike(messages: Sequence[Message]) -> bool:
    """Whether messages have one selector each, in one place of the data."""
    places = {tuple((k.space, k.segments) for k in m.keys) for m in messages}
    return len(places) == 1 and all(len(m.keys) == 1 and m.keys[0].space is Space.DATA for m in messages)


class MessageViews:
    """Builds the views of all messages of an edition."""

    def __init__(self, edition: Edition, type_views: Mapping[str, TypeView], imports: Imports) -> None:
        self._types = type_views
        self._imports = imports
        self._parameters: dict[str, Parameter] = {p.name: p for p in edition.parameters}
        messages = edition.all_messages()
        groups: dict[Group, list[Message]] = {}
        for message in messages:
            groups.setdefault(group(message), []).append(message)
        self._shared = {group(m): m for m in messages if m.layout.fields and len(groups[group(m)]) > 1}
        self._bases = _bases(self._shared)
        self._alike = {key for key in self._shared if _is_alike(groups[key])}
        self.layouts = tuple(self._layout(m) for m in self._shared.values())
        self.messages = tuple(self._message(edition.command(m.command), m) for m in messages)

    def _layout(self, message: Message) -> LayoutView:
        layout = message.layout
        manual = f"Manual {text.plain(layout.manual)}." if layout.manual else ""
        doc = (text.sentence(text.english(layout.title)), text.english(layout.about), manual)
        body = self._body(layout, message.dlc, message.id.nodes is not None)
        base = group(message)
        encode = self._encode(message, "self.CODE") if base in self._alike else None
        return LayoutView(self._bases[base], doc, body, encode)

    def _message(self, command: Command, message: Message) -> MessageView:
        base_group = group(message)
        shared = base_group in self._shared
        bases = []
        if shared:
            bases.append(self._bases[base_group])
        elif not message.layout.fields:
            bases.append(self._imports.use("ToNode" if message.id.nodes is not None else "ToAll"))
        is_request = message.direction is Direction.REQUEST
        if is_request:
            answer = text.class_name(command.reply.name) if command.reply else "Message"
            bases.append(f'Request["{answer}"]')
        else:
            bases.append("Reply")
        nodes = message.id.nodes
        own = message.layout.fields and not shared
        return MessageView(
            text.class_name(message.name),
            tuple(bases),
            _message_doc(command, message),
            command.name,
            message.direction.value,
            message.dlc,
            message.id.extended,
            message.remote,
            (nodes[0], nodes[-1]) if nodes is not None else None,
            self._body(message.layout, message.dlc, nodes is not None) if own else None,
            f"0x{self._fixed_id(message):X}",
            message.id.node_step,
            f"0x{message.keys[0].value:02X}" if message.keys else "",
            "" if message.layout.fields else self._constant_data(message),
            self._can_id(message),
            self._encode(message) if message.layout.fields and base_group not in self._alike else None,
            facts.of_class(command, self._parameters) if is_request or command.request is None else (),
        )

    def _body(self, layout: Layout, dlc: int, has_node: bool) -> BodyView:
        fields = tuple(self._field(f, layout.manual) for f in layout.fields if f.fixed is None)
        cases = tuple(self._case(layout, v, dlc) for v in layout.variants)
        constants = tuple(_constants((f for f in layout.fields if not f.only), dlc))
        return BodyView(fields, constants, cases, text.attribute(layout.parameter or ""), has_node, depends(layout))

    def _values(self, layout: Layout, variant: Variant) -> tuple[str, ...]:
        """The parameter values of a variant; none where the layout has one variant only."""
        if layout.parameter is None or len(layout.variants) == 1:
            return ()
        parameter = self._parameters[layout.parameter]
        return tuple(types.parameter_key(parameter, v) for v in variant.values)

    def _case(self, layout: Layout, variant: Variant, dlc: int) -> CaseView:
        places = self._places(variant.fields)
        names = tuple(text.attribute(f.name) for f in variant.fields if f.fixed is None)
        constants = tuple(_constants((f for f in variant.fields if f.only), dlc))
        scalar = [p for f, p in places if not f.is_array and f.fixed is None]
        only_scalars = all(not f.is_array and f.fixed is None for f, _ in places)
        ordered = sorted(scalar, key=lambda p: p.first_byte) if only_scalars else []
        pattern = bits.struct_format(ordered, dlc) if len(ordered) > 1 else None
        targets = tuple(p.target for p in ordered) if pattern else ()
        reads = () if pattern else tuple(_reads(variant.fields, dlc))
        return CaseView(self._values(layout, variant), names, pattern or "", targets, reads, constants)

    def _places(self, fields: Sequence[Field]) -> list[tuple[Field, bits.Place]]:
        found = []
        for field in fields:
            for i, element in enumerate(field.elements):
                slot = f"self.{text.attribute(field.name)}_raw" + (f"[{i}]" if field.is_array else "")
                target = slot if field.fixed is None else hex(field.fixed & (1 << field.type.width) - 1)
                place = bits.place(target, field, element)
                found.append((field, place if field.fixed is None else place._replace(signed=False)))
        return found

    def _encode(self, message: Message, code: str = "") -> EncodeView:
        """How a message writes its bytes; `code` is the expression of the selector's value, if it is not constant."""
        layout = message.layout
        cases = (EncodeCaseView(self._values(layout, v), self._data(message, v, code)) for v in layout.variants)
        return EncodeView(text.attribute(layout.parameter or ""), tuple(cases))

    def _data(self, message: Message, variant: Variant, code: str) -> str:
        """The expression of the data bytes."""
        keys = [bits.key_place(k)._replace(target=code or f"0x{k.value:02X}") for k in message.keys]
        places = [p for p in (*keys, *(p for _, p in self._places(variant.fields))) if p.space is Space.DATA]
        ordered = sorted(places, key=lambda p: p.first_byte)
        pattern = bits.struct_format(ordered, message.dlc)
        if pattern is not None:
            return f'{self._imports.use("pack")}("{pattern}", {", ".join(p.target for p in ordered)})'
        wide = {p.order for p in places if len(p.segments) > 1}
        order = Order.BIG if wide == {Order.BIG} else Order.LITTLE
        places = [p if len(p.segments) > 1 else p._replace(order=order) for p in places]
        sides = [
            " | ".join(f"({bits.write(p, message.dlc)})" for p in places if p.order is o) or "0"
            for o in (Order.LITTLE, Order.BIG)
        ]
        if len(wide) > 1:
            return f"{self._imports.use('merge')}({sides[0]}, {sides[1]}, {message.dlc})"
        if not places:
            return f"bytes({message.dlc})"
        side = sides[0] if order is Order.LITTLE else sides[1]
        return f'({side}).to_bytes({message.dlc}, "{order.value}")'

    def _fixed_id(self, message: Message) -> int:
        keys = (k for k in message.keys if k.space is Space.ID)
        return message.id.base + sum(k.value << k.segments[0].low for k in keys)

    def _can_id(self, message: Message) -> str:
        in_id = self._places([f for f in message.layout.fields if f.space is Space.ID])
        parts = (f" + ({bits.write(p, message.dlc)})" for _, p in in_id)
        return f"super().can_id{''.join(parts)}" if in_id else ""

    def _constant_data(self, message: Message) -> str:
        data = bytearray(message.dlc)
        for key in message.keys:
            for s in key.segments if key.space is Space.DATA else ():
                data[s.byte] |= (key.value >> s.raw_low & (1 << s.width) - 1) << s.low
        return repr(bytes(data))

    def _field(self, field: Field, manual_of_layout: str) -> FieldView:
        view, attribute = self._types[field.type.name], text.attribute(field.name)
        raw, name = f"self.{attribute}_raw", text.literal(field.name)
        element = "one" if field.is_array else raw
        value = types.inline_value(field.type, element)
        use = self._imports.use
        if view.is_flags:
            value, check = f"{view.enum}({element})", f"{use('flags')}({view.mask})"
        elif view.enum:
            value, check = f"{use('named')}({view.enum}, {element})", f"{use('member')}({view.enum})"
        else:
            value = value or f"{view.constant}.value({element}, self.parameters, {name})"
            check, convert = f"{view.constant}.check", f"{view.constant}.raw"
        given = f"{view.enum} | int" if view.enum else use("Real")
        count = len(field.elements) if field.is_array else 0
        if count:
            value, given = f"tuple({value} for one in {raw})", f"{use('Iterable')}[{given}]"
            check = f"{use('each')}({check}, {count})"
            convert = f"each({convert}, {count})"
        if view.enum:
            convert = f"self.TYPES[{text.literal(attribute)}]"
        to_raw = f"{convert}({attribute}, self.parameters, {name})"
        manual = f"Manual {text.plain(field.manual)}." if field.manual != manual_of_layout else ""
        facts = (
            view.meaning,
            text.english(field.about) or text.english(field.type.about),
            f"There under {', '.join(field.only)} only" if field.only else "",
            manual,
        )
        doc = (text.sentence(text.english(field.title)), " ".join(text.sentence(fact) for fact in facts if fact))
        return FieldView(
            field.name,
            attribute,
            bool(field.only),
            count,
            f"tuple[{view.python}, ...]" if count else view.python,
            given,
            value,
            to_raw,
            check,
            doc,
        )


def _constants(fields: Iterable[Field], dlc: int) -> Iterator[ConstantView]:
    """The constants that are checked."""
    for field in fields:
        if field.demanded is not None:
            read = bits.read(bits.place("", field, field.elements[0]), dlc)
            yield ConstantView(read, str(field.demanded), field.name)


def _reads(fields: Iterable[Field], dlc: int) -> Iterator[ReadView]:
    for field in fields:
        if field.fixed is None:
            reads = [bits.read(bits.place("", field, e), dlc) for e in field.elements]
            yield ReadView(text.attribute(field.name), text.tuple_of(reads) if field.is_array else reads[0])


def depends(layout: Layout) -> bool:
    """Whether values or ranges of a layout need parameters."""
    return bool(layout.parameters) or any(field.type.numbers for field in layout.fields)


def _message_doc(command: Command, message: Message) -> tuple[str, ...]:
    code = f" (0x{command.code:02X})" if command.code is not None else ""
    title = f"{text.english(command.title)}{code}, {message.direction.value}."
    manual = f"Manual {text.plain(command.manual)}." if command.manual else ""
    if message.direction is Direction.REPLY:
        echo = "The request, sent back." if command.is_echoed else ""
        return (title, f"{echo} {manual}".strip())
    effects = " ".join(text.sentence(text.english(e.title)) for e in command.effects)
    missing = "" if command.implemented else "Not implemented, says the manual."
    notes = " ".join(text.english(n) for n in command.notes)
    only = " ".join(f"Only {name} {', '.join(values)}." for name, values in command.only.items())
    about = f"{text.english(command.about)} {only} {manual}"
    return (title, " ".join(about.split()), missing, f"Effects: {effects}" if effects else "", notes)
