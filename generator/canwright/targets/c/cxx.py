"""The C++17 header of an edition: enumerations, messages as distinct types, and overloads for the functions of C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Message
from ...model.types import Type
from .conversions import ConversionView
from .examples import ExchangeView
from .names import RESERVED, Names, layouts, member
from .text import english
from .types import TypeView
from .view import DirectionView, EditionView, FrameView

OWN_NAMES = (
    *("frame", "status", "parameters", "command", "field", "field_tag", "any_request", "any_reply"),
    *("encode", "decode", "decode_request", "decode_reply", "check_reply", "name"),
    *("get", "set", "get_milli", "set_milli", "has"),
)
"""The names that the header of every edition has in its namespace."""


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
    """A pair of functions of a field: `get` and `set`, or those in thousandths."""

    ending: str
    number: str
    to: str
    from_: str
    to_fails: bool
    to_parameters: bool
    from_parameters: bool


@dataclass(frozen=True, kw_only=True)
class FieldView:
    """A field of a struct; `length` is that of an array, else 0. Flags have `flags`, named values have `named`."""

    tag: str
    member: str
    length: int
    kind: str
    named: str
    flags: str
    conversions: tuple[Conversion, ...]

    @property
    def place(self) -> str:
        return f"message.{self.member}" + ("[index]" if self.length else "")


class StructView(NamedTuple):
    name: str
    fields: tuple[FieldView, ...]


class MessageView(NamedTuple):
    """A message as a type of its own; `struct` is that of C, empty without fields."""

    name: str
    title: str
    struct: str
    frame: FrameView


class AnyView(NamedTuple):
    """Any message of one direction."""

    name: str
    direction: DirectionView


class CxxView(NamedTuple):
    """The content of the header."""

    namespace: str
    enums: tuple[EnumView, ...]
    parameters: tuple[ParameterSetter, ...]
    tags: tuple[Enumerator, ...]
    structs: tuple[StructView, ...]
    messages: tuple[MessageView, ...]
    any: tuple[AnyView, ...]


class CxxExample(NamedTuple):
    """The first exchange of the examples: its messages, and a field of the reply with its conversion to a value.

    `tag` and `conversion` are empty if no field of the reply is a number with a scale.
    """

    request: MessageView
    assignments: tuple[str, ...]
    node: int
    reply: MessageView
    tag: str
    conversion: Conversion | None


def cxx_example(x: CxxView, exchange: ExchangeView) -> CxxExample:
    """The example for the documents."""
    frames = {m.frame.name: m for m in x.messages}
    request, reply = frames[exchange.request.frame.name], frames[exchange.reply.frame.name]
    tags = {tag.value: tag.name for tag in x.tags}
    fields = next((s.fields for s in x.structs if s.name == f"{reply.frame.layout.name}_t"), ())
    number = next((f for f in fields if f.conversions and not f.length), None)
    return CxxExample(
        request=request,
        assignments=exchange.request.assignments,
        node=exchange.node,
        reply=reply,
        tag=tags[number.tag] if number else "",
        conversion=number.conversions[0] if number else None,
    )


def cxx_view(edition: Edition, view: EditionView) -> CxxView:
    return _Cxx(edition, view).view()


class _Cxx:
    def __init__(self, edition: Edition, view: EditionView) -> None:
        self._edition, self._view = edition, view
        self._names = Names(edition)
        self._types = {t.name: t for t in view.types}
        self._frames = {f.name: f for command in view.commands for f in command.frames}
        used = [t for t in edition.types if (t.enum or t.flags) and self._names.lower(self._stem(t)) in self._types]
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

    def view(self) -> CxxView:
        tags = [name for _, name in self._view.fields]
        return CxxView(
            namespace=f"{member(self._edition.family)}::{self._edition.identifier}",
            enums=(self._commands(), *self._parameter_enums(), *self._type_enums()),
            parameters=tuple(
                ParameterSetter(member(p.name), self._names.lower(p.name, "t"), self._choices.get(p.name, ""))
                for p in self._edition.parameters
            ),
            tags=tuple(map(Enumerator, _distinct(tags, ()), (tag for tag, _ in self._view.fields))),
            structs=tuple(self._struct(layout) for layout in layouts(self._edition) if _members(layout)),
            messages=tuple(map(self._message, self._edition.all_messages())),
            any=tuple(AnyView(f"any_{d.word}", d) for d in self._view.directions if d.decode),
        )

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
                view = self._types[self._names.lower(self._stem(type_))]
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

    def _struct(self, layout: Layout) -> StructView:
        return StructView(self._names.lower(layout.name, "t"), tuple(map(self._field, _members(layout))))

    def _field(self, field: Field) -> FieldView:
        type_ = field.type
        enum = self._enums.get(type_.name, "")
        view = self._types[self._names.lower(self._stem(type_))]
        pairs = (
            ("", "double", view.double),
            ("_float", "float", view.single),
            ("_milli", view.milli.kind if view.milli else "", view.milli),
        )
        return FieldView(
            tag=self._names.upper("field", field.name),
            member=member(field.name),
            length=len(field.elements) if field.is_array else 0,
            kind=view.kind,
            named=enum if type_.enum else "",
            flags=enum if type_.flags else "",
            conversions=tuple(_conversion(view, *pair) for pair in pairs if not enum and pair[2] is not None),
        )

    def _message(self, message: Message) -> MessageView:
        frame = self._frames[self._names.lower(message.name)]
        return MessageView(
            self._message_names[message.name], f"{message.direction.value} of {message.command}", frame.struct, frame
        )


def _conversion(type_: TypeView, ending: str, number: str, view: ConversionView | None) -> Conversion:
    assert view is not None
    unit = "milli" if ending == "_milli" else number
    return Conversion(
        ending=ending,
        number=number,
        to=f"{type_.name}_to_{unit}",
        from_=f"{type_.name}_from_{unit}",
        to_fails=view.to_fails,
        to_parameters=view.to_parameters,
        from_parameters=view.from_parameters,
    )


def _members(layout: Layout) -> Sequence[Field]:
    return [f for f in layout.fields if f.fixed is None]


def _distinct(names: Iterable[str], taken: Iterable[str]) -> Iterator[str]:
    """The names in lower case; one that C++ or an earlier name has taken, or that starts with a digit, gets a `_`."""
    seen = {*taken}
    for name in names:
        free = f"_{name.lower()}" if name[0].isdigit() else name.lower()
        while free in seen or free in RESERVED:
            free += "_"
        seen.add(free)
        yield free
