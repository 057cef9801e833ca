"""The C++17 header of an edition: enumerations, messages as distinct types, and overloads for the functions of C."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Direction, Message
from ...model.types import Type
from .conversions import ConversionView
from .examples import ExchangeView
from .names import RESERVED, layouts, member
from .text import english
from .types import TypeView
from .view import DirectionView, EditionView, FrameView

OWN_NAMES = (
    *("frame", "status", "parameters", "command", "field", "type", "layout", "any_request", "any_reply", "result"),
    *("encode", "decode", "decode_request", "decode_reply", "check_reply", "name", "visit", "canwright_access"),
    *("get", "set", "get_float", "set_float", "get_milli", "set_milli", "has"),
)
"""The names that the header of every edition has in its namespace."""
TYPE_NAMES = ("integer", "parameters", "flags", "value", "single", "milli")
"""The names in the description of each type."""
MESSAGE_NAMES = ("reply", "which", "code", "text", "rules")
"""The names that messages have besides their fields."""


class Enumerator(NamedTuple):
    name: str
    value: str


class EnumView(NamedTuple):
    """An `enum class`; `name_function` is that of C with its argument of type `c_type`, empty without one.

    `without_name` is what that function returns for a value without a name.
    """

    name: str
    kind: str
    doc: str
    members: tuple[Enumerator, ...]
    name_function: str = ""
    c_type: str = ""
    without_name: str = "a null pointer"


class ParameterSetter(NamedTuple):
    """A member of the parameters; `choice` is its enumeration, empty for a number."""

    member: str
    kind: str
    choice: str


@dataclass(frozen=True, kw_only=True)
class Conversion:
    """A pair of functions of a type: to the unit, to it in single precision, or to thousandths."""

    name: str
    number: str
    to: str
    from_: str
    to_fails: bool
    to_parameters: bool
    from_parameters: bool


@dataclass(frozen=True, kw_only=True)
class TypeTraits:
    """A type; `named` is the enumeration of its values, `flags` that of its flags, empty without any."""

    name: str
    heading: str
    kind: str
    named: str
    flags: str
    conversions: tuple[Conversion, ...]

    @property
    def lacking(self) -> list[str]:
        """The conversions that it does not have."""
        there = {conversion.name for conversion in self.conversions} | ({"value"} if self.named else set())
        return [name for name in ("value", "single", "milli") if name not in there]


class Presence(NamedTuple):
    """The nodes that have a field: those with some values of a parameter."""

    name: str
    parameter: str
    unknown: str
    values: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class FieldView:
    """A field of a layout; `length` is that of an array, else 0. `presence` is empty for a field of all nodes."""

    tag: str
    doc: str
    member: str
    c_member: str
    length: int
    type: TypeTraits
    presence: str


class LayoutView(NamedTuple):
    """The fields of messages with the struct `struct` of C."""

    name: str
    struct: str
    fields: tuple[FieldView, ...]


class MessageView(NamedTuple):
    """A message as a type of its own; `layout` is empty without fields, `reply` without a reply, `code` without one."""

    name: str
    title: str
    layout: str
    which: str
    code: str
    reply: str
    frame: FrameView


class AnyView(NamedTuple):
    """Any message of one direction; `messages` are those that a frame can be, each with its member of the union."""

    name: str
    direction: DirectionView
    messages: tuple[tuple[MessageView, str], ...]


class CxxView(NamedTuple):
    """The content of the header."""

    namespace: str
    enums: tuple[EnumView, ...]
    parameters: tuple[ParameterSetter, ...]
    tags: tuple[Enumerator, ...]
    types: tuple[TypeTraits, ...]
    presences: tuple[Presence, ...]
    layouts: tuple[LayoutView, ...]
    messages: tuple[MessageView, ...]
    any: tuple[AnyView, ...]


class CxxExample(NamedTuple):
    """The first exchange of the examples: its messages, and a field of the reply with its conversion to a value.

    `tag` and `conversion` are empty if no field of the reply is a number with a scale. `needs_parameters` is true if
    reading it depends on parameters.
    """

    request: MessageView
    assignments: tuple[str, ...]
    node: int
    reply: MessageView
    tag: str
    conversion: Conversion | None
    needs_parameters: bool
    is_result: bool


def cxx_example(x: CxxView, exchange: ExchangeView) -> CxxExample:
    """The example for the documents."""
    frames = {m.frame.name: m for m in x.messages}
    request, reply = frames[exchange.request.frame.name], frames[exchange.reply.frame.name]
    tags = {tag.value: tag.name for tag in x.tags}
    fields = next((layout.fields for layout in x.layouts if layout.name == reply.layout), ())
    values = ((f, c) for f in fields for c in f.type.conversions if c.name == "value" and not f.length)
    number, conversion = next(values, (None, None))
    presence = bool(number and number.presence)
    return CxxExample(
        request=request,
        assignments=exchange.request.assignments,
        node=exchange.node,
        reply=reply,
        tag=tags[number.tag] if number else "",
        conversion=conversion,
        needs_parameters=presence or (conversion is not None and conversion.to_parameters),
        is_result=presence or (conversion is not None and conversion.to_fails),
    )


def cxx_view(edition: Edition, view: EditionView) -> CxxView:
    return _Cxx(edition, view).view()


class _Cxx:
    def __init__(self, edition: Edition, view: EditionView) -> None:
        self._edition, self._view = edition, view
        self._names = view.names
        used = [t for t in edition.types if (t.enum or t.flags) and view.has(t)]
        choices = [p for p in edition.parameters if p.is_choice]
        free = _distinct(
            (
                *(self._names.short(m.name) for m in edition.all_messages()),
                *(p.name for p in choices),
                *map(self._stem, used),
            ),
            OWN_NAMES,
        )
        self._message_names = {m.name: next(free) for m in edition.all_messages()}
        self._choices = {p.name: next(free) for p in choices}
        self._enums = {t.name: next(free) for t in used}
        with_fields = [layout for layout in layouts(edition) if _members(layout)]
        self._layouts = dict(zip(with_fields, _distinct((layout.name for layout in with_fields), ()), strict=True))
        self._members = {layout: view.frame(edition.of_layout(layout)[0]).layout.members for layout in with_fields}
        types = {f.type.name: f.type for layout in with_fields for f in _members(layout)}
        names = _distinct(map(self._stem, types.values()), TYPE_NAMES)
        self._traits = dict(self._type_traits(zip(types.values(), names, strict=True)))
        presences = dict.fromkeys(itertools.chain.from_iterable(map(_presences, with_fields)))
        self._presences = {key: self._presence(f"only_{place}", key) for place, key in enumerate(presences, 1)}

    def view(self) -> CxxView:
        tags = [name for _, name in self._view.fields]
        messages = {m.name: self._message(m) for m in self._edition.all_messages()}
        return CxxView(
            namespace=f"{member(self._edition.family)}::{self._edition.identifier}",
            enums=(self._commands(), *self._parameter_enums(), *self._type_enums()),
            parameters=tuple(
                ParameterSetter(member(p.name), self._names.lower(p.name, "t"), self._choices.get(p.name, ""))
                for p in self._edition.parameters
            ),
            tags=tuple(map(Enumerator, _distinct(tags, ()), (tag for tag, _ in self._view.fields))),
            types=tuple(self._traits.values()),
            presences=tuple(self._presences.values()),
            layouts=tuple(
                LayoutView(name, self._names.lower(layout.name, "t"), tuple(map(self._field, _members(layout))))
                for layout, name in self._layouts.items()
            ),
            messages=tuple(messages.values()),
            any=tuple(self._any(d, messages) for d in self._view.directions if d.decode),
        )

    def _any(self, direction: DirectionView, messages: Mapping[str, MessageView]) -> AnyView:
        """The messages that the decoder of any frame returns."""
        decoded = [messages[message.name] for message in self._edition.messages(Direction(direction.word))]
        by_command = direction.by_command
        members = tuple((view, by_command[view.which].member if view.layout else "") for view in decoded)
        return AnyView(f"any_{direction.word}", direction, members)

    def _stem(self, type_: Type) -> str:
        return self._names.type_stem(type_)

    def _commands(self) -> EnumView:
        names = [command.name for command in self._edition.commands]
        values = [self._names.upper("command", "none"), *map(self._names.command, names)]
        members = tuple(map(Enumerator, _distinct(("none", *map(self._names.short, names)), ()), values))
        function, c_type = self._names.lower("command_name"), self._names.lower("command_t")
        return EnumView("command", "int", "The commands.", members, function, c_type, "an empty text")

    def _parameter_enums(self) -> Iterator[EnumView]:
        for parameter in self._edition.parameters:
            if parameter.is_choice:
                names = ["unknown", *(value.name for value in parameter.values)]
                members = map(Enumerator, _distinct(names, ()), (self._names.upper(parameter.name, n) for n in names))
                doc = f"{english(parameter.title)}."
                yield EnumView(self._choices[parameter.name], "int", doc, tuple(members))

    def _type_enums(self) -> Iterator[EnumView]:
        for type_ in self._edition.types:
            if type_.name in self._enums:
                view = self._view.type(type_)
                names = [m.name for m in (*type_.enum, *type_.flags)]
                values = (self._names.upper(self._stem(type_), name) for name in names)
                yield EnumView(
                    name=self._enums[type_.name],
                    kind=view.kind,
                    doc=f"{view.heading}.",
                    members=tuple(map(Enumerator, _distinct(names, ()), values)),
                    name_function=f"{view.name}_name" if view.names else "",
                    c_type=view.kind,
                )

    def _type_traits(self, names: Iterable[tuple[Type, str]]) -> Iterator[tuple[str, TypeTraits]]:
        for type_, name in names:
            view = self._view.type(type_)
            enum = self._enums.get(type_.name, "")
            pairs = (
                ("single", "float", view.single),
                ("value", "double", view.double),
                ("milli", view.milli.kind if view.milli else "", view.milli),
            )
            conversions = (_conversion(view, *pair) for pair in pairs if not enum and pair[2] is not None)
            yield (
                type_.name,
                TypeTraits(
                    name=name,
                    heading=view.heading,
                    kind=view.kind,
                    named=enum if type_.enum else "",
                    flags=enum if type_.flags else "",
                    conversions=tuple(conversions),
                ),
            )

    def _presence(self, name: str, key: tuple[str, ...]) -> Presence:
        parameter, *values = key
        names = tuple(self._names.upper(parameter, value) for value in values)
        return Presence(name, member(parameter), self._names.upper(parameter, "unknown"), names)

    def _field(self, field: Field) -> FieldView:
        layout = next(layout for layout in self._layouts if field in layout.fields)
        view = next(m for m in self._members[layout] if m.name.partition("[")[0] == member(field.name))
        key = (layout.parameter or "", *field.only)
        name = member(field.name)
        return FieldView(
            tag=self._names.upper("field", field.name),
            doc=view.doc,
            member=f"{name}_" if name in MESSAGE_NAMES else name,
            c_member=name,
            length=len(field.elements) if field.is_array else 0,
            type=self._traits[field.type.name],
            presence=self._presences[key].name if field.only else "",
        )

    def _message(self, message: Message) -> MessageView:
        frame = self._view.frame(message)
        command = self._edition.command(message.command)
        reply = command.reply if message.direction is Direction.REQUEST else None
        return MessageView(
            name=self._message_names[message.name],
            title=f"{message.direction.value} of {message.command}",
            layout=self._layouts.get(message.layout, ""),
            which=self._names.command(command.name),
            code="" if command.code is None else self._names.upper(command.name, "code"),
            reply=self._message_names[reply.name] if reply else "",
            frame=frame,
        )


def _conversion(type_: TypeView, name: str, number: str, view: ConversionView | None) -> Conversion:
    assert view is not None
    unit = "milli" if name == "milli" else number
    return Conversion(
        name=name,
        number=number,
        to=f"{type_.name}_to_{unit}",
        from_=f"{type_.name}_from_{unit}",
        to_fails=view.to_fails,
        to_parameters=view.to_parameters,
        from_parameters=view.from_parameters,
    )


def _presences(layout: Layout) -> Iterator[tuple[str, ...]]:
    """The parameter of a layout and its values under which a field exists, for each field that not all nodes have."""
    yield from ((layout.parameter or "", *field.only) for field in _members(layout) if field.only)


def _members(layout: Layout) -> Sequence[Field]:
    return [f for f in layout.fields if f.role.is_value]


def _distinct(names: Iterable[str], taken: Iterable[str]) -> Iterator[str]:
    """The names in lower case; one that C++ or an earlier name has taken, or that starts with a digit, gets a `_`."""
    seen = {*taken}
    for name in names:
        free = f"_{name.lower()}" if name[0].isdigit() else name.lower()
        while free in seen or free in RESERVED:
            free += "_"
        seen.add(free)
        yield free
