"""Types of TypeScript for fields, parameters and messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Direction, Message
from ...model.types import Encoding, Parameter, Type
from . import text


@dataclass(frozen=True, kw_only=True)
class Property:
    """A property of an interface, with its comment."""

    name: str
    type: str
    doc: str


@dataclass(frozen=True, kw_only=True)
class MessageDeclaration:
    """A request or a reply: its command, and the layout of its fields."""

    command: str
    layout: str
    doc: str


@dataclass(frozen=True, kw_only=True)
class Declarations:
    """The declarations of the module of an edition."""

    parameters: tuple[Property, ...]
    layouts: tuple[tuple[str, tuple[Property, ...]], ...]
    requests: tuple[MessageDeclaration, ...]
    replies: tuple[MessageDeclaration, ...]
    answers: tuple[tuple[str, str], ...]
    """Commands with a request, each with the command whose reply answers it."""


def declarations(edition: Edition) -> Declarations:
    """The declarations of an edition."""
    layouts = dict.fromkeys(message.layout for message in edition.all_messages())
    names = _distinct(layouts)
    return Declarations(
        parameters=tuple(map(_parameter, edition.parameters)),
        layouts=tuple((names[layout], tuple(_fields(layout))) for layout in layouts),
        requests=tuple(_messages(edition, Direction.REQUEST, names)),
        replies=tuple(_messages(edition, Direction.REPLY, names)),
        answers=tuple(
            (text.key(c.name), text.quoted(c.reply.command)) for c in edition.commands if c.request and c.reply
        ),
    )


def _distinct(layouts: Iterable[Layout]) -> Mapping[Layout, str]:
    """The name of each layout; with its position where two have one name."""
    names: dict[str, Layout] = {}
    for number, layout in enumerate(layouts):
        names[f"{layout.name}.{number}" if layout.name in names else layout.name] = layout
    return {layout: text.key(name) for name, layout in names.items()}


def _messages(edition: Edition, direction: Direction, names: Mapping[Layout, str]) -> Iterator[MessageDeclaration]:
    for message in edition.messages(direction):
        yield MessageDeclaration(
            command=text.key(message.command), layout=names[message.layout], doc=_title(edition, message)
        )


def _title(edition: Edition, message: Message) -> str:
    command = edition.command(message.command)
    code = "" if command.code is None else f"0x{command.code:02X} "
    manual = f" (section {command.manual})" if command.manual else ""
    return text.comment(f"{code}{text.english(command.title)}{manual}")


def _parameter(parameter: Parameter) -> Property:
    allowed = f" ({formatting.allowed(parameter)})" if not parameter.is_choice and formatting.allowed(parameter) else ""
    return Property(
        name=text.key(parameter.name),
        type=_choice(parameter) if parameter.is_choice else "number | string",
        doc=text.comment(text.english(parameter.title) or formatting.spoken(parameter.name)) + allowed,
    )


def _choice(parameter: Parameter) -> str:
    names = [text.quoted(value.name) for value in parameter.values]
    return " | ".join([*names, *(value.name for value in parameter.values if value.number is not None)])


def _fields(layout: Layout) -> Iterator[Property]:
    for field in layout.fields:
        if field.role.is_value:
            yield Property(
                name=text.key(field.name) + ("?" if field.only else ""), type=_field_type(field), doc=_meaning(field)
            )


def _meaning(field: Field) -> str:
    """Title, unit, resolution and range of a field, and the parameter values under which it exists."""
    type_ = field.type
    title = text.english(field.title) or text.english(type_.title) or formatting.spoken(field.name)
    parts = [title]
    if type_.is_number and not type_.is_plain:
        parts += [f"resolution {_by(formatting.scale(type_))}"]
    elif type_.unit:
        parts += [type_.unit.symbol]
    limits = formatting.ranges(type_)
    parts += [f"raw {_by(limits)}"] if limits and type_.encoding is not Encoding.FLOAT else []
    parts += [f"only {', '.join(field.only)}"] if field.only else []
    return text.comment("; ".join(parts))


def _by(cases: Iterable[tuple[str, str]]) -> str:
    return ", ".join(f"{shown} ({names})" if names else shown for names, shown in cases)


def _field_type(field: Field) -> str:
    raw, value, given = _types(field.type)
    if field.is_array:
        raw, value, given = (f"readonly ({type_})[]" for type_ in (raw, value, given))
    return f"FieldOf<{raw}, {value}, {given}>"


def _types(type_: Type) -> Sequence[str]:
    """The types of raw integers, values and accepted values."""
    raw = "bigint" if type_.width > 53 else "number"
    number = "number | bigint"
    if type_.enum:
        names = " | ".join(text.quoted(member.name) for member in type_.enum)
        return raw, f"{names} | null", f"{names} | {number}"
    if type_.flags:
        names = " | ".join(text.quoted(flag.name) for flag in type_.flags)
        rest = f" | {raw}" if len(type_.flags) < type_.width else ""
        return raw, f"readonly ({names}{rest})[]", f"readonly ({names} | {number})[] | {number}"
    if type_.is_plain:
        return raw, raw, number
    linear = type_.linear.constant
    always = type_.encoding is not Encoding.FLOAT and linear is not None and linear.times is None
    return raw, "number" if always else "number | null", number
