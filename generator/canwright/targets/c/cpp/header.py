"""The C++17 header of an edition: enumerations, messages as distinct types, and overloads for the functions of C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ....model.edition import Edition
from ....model.formatting import english, further_replies
from ....model.layout import Layout
from ....model.message import Direction, Message
from ....model.types import Parameter, Type
from .. import messages as c
from ..conversions import ConversionView
from ..examples import ExchangeView
from ..layouts import MemberView
from ..names import RESERVED, Names, layouts, member
from ..types import TypeView
from ..view import EditionView

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


class Conversion(NamedTuple):
    """A pair of functions of a type: to the unit, to it in single precision, or to thousandths."""

    name: str
    to: str
    from_: str
    view: ConversionView


class TypeTraits:
    """A type; `named` is the enumeration of its values, `flags` that of its flags, empty without any."""

    def __init__(self, type_: Type, name: str, view: TypeView, enum: str) -> None:
        self.name, self.view = name, view
        self.named, self.flags = (enum, "") if type_.enum else ("", enum)
        self.integer = f"::{'' if view.is_float else 'std::'}{view.kind}"
        """The raw integer; for a float, the struct of C with its bits."""
        self.member = self.integer if view.is_float else f"::canwright::raw<{self.integer}>"
        """A member, which takes no number in floating point."""
        names = {} if enum else {"float": "single", "double": "value", "milli": "milli"}
        self.conversions = [
            Conversion(name, f"{view.name}_to_{unit}", f"{view.name}_from_{unit}", view.conversions[unit])
            for unit, name in names.items()
            if unit in view.conversions
        ]
        there = {"value"} if self.named else {conversion.name for conversion in self.conversions}
        self.lacking = [name for name in ("value", "single", "milli") if name not in there]
        """The conversions that it does not have."""


class Presence:
    """The nodes that have a field: those with some values of a parameter."""

    def __init__(self, names: Names, name: str, parameter: str, *values: str) -> None:
        self.name, self.parameter, self.unknown = name, member(parameter), names.upper(parameter, "unknown")
        self.values = [names.upper(parameter, value) for value in values]


class FieldView(NamedTuple):
    """A field of a layout; `length` is that of an array, else 0. `presence` is empty for a field of all nodes."""

    tag: Enumerator
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
    code: MemberView | None


class MessageView:
    """A message as a type of its own; `layout` is empty without fields, `reply` without a reply, `code` without one."""

    def __init__(self, x: CxxView, edition: Edition, message: Message, view: c.MessageView) -> None:
        command = edition.command(message.command)
        reply = command.reply if message.direction is Direction.REQUEST else None
        self.name, self.message = x.message_names[message.name], view
        self.title = f"{message.direction.value} of {message.command}"
        self.layout = x.layout_names.get(message.layout, "")
        self.code = "" if command.code is None else x.names.upper(command.name, "code")
        self.reply = x.message_names[reply.name] if reply else ""
        self.replies = " ".join(f"{text[:1].upper()}{text[1:]}." for text in further_replies(command))
        """The further replies, in sentences."""


class CxxView:
    """The content of the header."""

    def __init__(self, edition: Edition, view: EditionView) -> None:
        self._edition, self._view, self.names = edition, view, view.names
        messages = edition.all_messages()
        choices = [p for p in edition.parameters if p.is_choice]
        enums = [t for t in edition.types if (t.enum or t.flags) and t in view.of_type]
        stems = (*(p.name for p in choices), *map(self._stem, enums))
        free = _distinct((*(self.names.short(m.name) for m in messages), *stems), OWN_NAMES)
        self.message_names = {m.name: next(free) for m in messages}
        items: list[Parameter | Type] = [*choices, *enums]
        self._enums = dict(zip(items, free, strict=True))
        self.tags = _enumerators(view.fields)
        self._tags = dict(zip((name for _, name in view.fields), self.tags, strict=True))
        self._fields = {layout: layout.given for layout in layouts(edition) if layout.given or self._code(layout)}
        self.layout_names = dict(zip(self._fields, _distinct(layout.name for layout in self._fields), strict=True))
        types = {f.type.name: f.type for own in self._fields.values() for f in own}.values()
        names = _distinct(map(self._stem, types), TYPE_NAMES)
        self._types = {
            type_.name: TypeTraits(type_, name, view.of_type[type_], self._enums.get(type_, ""))
            for type_, name in zip(types, names, strict=True)
        }
        self.types = list(self._types.values())
        presences = dict.fromkeys(
            (layout.parameter or "", *field.only) for layout, own in self._fields.items() for field in own if field.only
        )
        self._presences = {key: Presence(self.names, f"only_{place}", *key) for place, key in enumerate(presences, 1)}
        self.presences = list(self._presences.values())

        self.namespace = f"{member(edition.family)}::{edition.identifier}"
        self.enums = list(self._enumerations())
        self.choices = {p: self._enums[p] for p in choices}
        """The enumeration of each parameter that is a choice."""
        self.layouts = [
            LayoutView(name, self.names.lower(layout.name, "t"), tuple(self._layout(layout)), self._code(layout))
            for layout, name in self.layout_names.items()
        ]
        self.messages = [MessageView(self, edition, m, view.message(m)) for m in messages]
        self.any = [
            (d, [m for m in self.messages if m.message.direction == d.word]) for d in view.directions if d.decode
        ]
        """Each direction with the messages that a frame can be."""

    def _stem(self, type_: Type) -> str:
        return self.names.type_stem(type_)

    def _enumerations(self) -> Iterator[EnumView]:
        """The commands, the values of parameters, and the names of raw integers."""
        names, view = self.names, self._view
        commands = [(names.command(c.name), names.short(c.name)) for c in self._edition.commands]
        members = _enumerators([(names.upper("command", "none"), "none"), *commands])
        function, c_type = names.lower("command_name"), names.lower("command_t")
        yield EnumView("command", "int", "The commands.", members, function, c_type, "an empty text")
        for item, name in self._enums.items():
            if isinstance(item, Parameter):
                values = ["unknown", *(value.name for value in item.values)]
                members = _enumerators([(names.upper(item.name, value), value) for value in values])
                yield EnumView(name, "int", f"{english(item.title)}.", members)
            else:
                type_ = view.of_type[item]
                members, function = _enumerators(type_.names), f"{type_.name}_name"
                yield EnumView(name, type_.kind, f"{type_.heading}.", members, function, type_.kind)

    def _code(self, layout: Layout) -> MemberView | None:
        """The member with the code; None if there is none."""
        code = self._view.message(self._edition.of_layout(layout)[0]).layout.code
        return code.member if code else None

    def _layout(self, layout: Layout) -> Iterator[FieldView]:
        views = self._view.message(self._edition.of_layout(layout)[0]).layout.members
        for field, view in zip(self._fields[layout], views, strict=False):  # the code may follow
            name, key = member(field.name), (layout.parameter or "", *field.only)
            yield FieldView(
                self._tags[field.name],
                view.doc,
                f"{name}_" if name in MESSAGE_NAMES else name,
                name,
                len(field.elements) if field.is_array else 0,
                self._types[field.type.name],
                self._presences[key].name if field.only else "",
            )


class CxxExample:
    """The messages of an exchange, and a field of the reply with its conversion to a value.

    The latter are None if no field of the reply is a number with a scale.
    """

    def __init__(self, x: CxxView, exchange: ExchangeView) -> None:
        messages = {m.message: m for m in x.messages}
        self.request, self.reply = messages[exchange.request.message], messages[exchange.reply.message]
        fields = next((layout.fields for layout in x.layouts if layout.name == self.reply.layout), ())
        values = ((f, c) for f in fields for c in f.type.conversions if c.name == "value" and not f.length)
        self.field: FieldView | None
        self.conversion: Conversion | None
        self.field, self.conversion = next(values, (None, None))
        has_presence = self.field is not None and bool(self.field.presence)
        self.needs_parameters = has_presence or (self.conversion is not None and self.conversion.view.to_parameters)
        """Whether reading the field depends on parameters."""
        self.is_result = has_presence or (self.conversion is not None and self.conversion.view.to_fails)
        """Whether reading the field can fail."""


def _enumerators(values: Iterable[tuple[str, str]]) -> tuple[Enumerator, ...]:
    """Enumerators for names of C, each with its name in the spec."""
    pairs = list(values)
    names = _distinct(name for _, name in pairs)
    return tuple(Enumerator(name, value) for name, (value, _) in zip(names, pairs, strict=True))


def _distinct(names: Iterable[str], taken: Iterable[str] = ()) -> Iterator[str]:
    """The names in lower case; one that C++ or an earlier name has taken, or that starts with a digit, gets a `_`."""
    seen = {*taken}
    for name in names:
        free = f"_{name.lower()}" if name[0].isdigit() else name.lower()
        while free in seen or free in RESERVED:
            free += "_"
        seen.add(free)
        yield free
