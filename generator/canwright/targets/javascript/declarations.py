"""Types of TypeScript for fields, parameters and messages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...model import formatting
from ...model.edition import Edition
from ...model.joined import JoinedText
from ...model.layout import Field, Layout
from ...model.message import Command
from ...model.types import Encoding, Parameter, Type
from . import text


def layout_names(edition: Edition) -> Mapping[Layout, str]:
    """The name of each layout; with its position where two have one name."""
    names: dict[str, Layout] = {}
    for number, layout in enumerate(dict.fromkeys(message.layout for message in edition.all_messages())):
        names[f"{layout.name}.{number}" if layout.name in names else layout.name] = layout
    return {layout: text.key(name) for name, layout in names.items()}


def title(command: Command) -> str:
    """The comment of the messages of a command."""
    code = "" if command.code is None else f"0x{command.code:02X} "
    section = command.manual and f"section {command.manual}"
    cited = formatting.cited(section, command.manual_name)
    manual = f" ({cited})" if cited else ""
    return text.comment(f"{code}{formatting.english(command.title)}{manual}")


def parameter_title(parameter: Parameter) -> str:
    """The comment of a parameter."""
    allowed = f" ({formatting.allowed(parameter)})" if not parameter.is_choice and formatting.allowed(parameter) else ""
    return text.comment(formatting.english(parameter.title) or formatting.spoken(parameter.name)) + allowed


def parameter_type(parameter: Parameter) -> str:
    """The type of a parameter."""
    names = [text.quoted(value.name) for value in parameter.values]
    numbers = [value.name for value in parameter.values if value.number is not None]
    return " | ".join([*names, *numbers]) if parameter.is_choice else "number | string"


def meaning(field: Field) -> str:
    """Title, unit, resolution and range of a field, and the parameter values under which it exists."""
    type_ = field.type
    title = formatting.english(field.title) or formatting.english(type_.title) or formatting.spoken(field.name)
    parts = [title]
    if type_.is_number and not type_.is_plain and not type_.is_bare_float:
        parts += [f"resolution {formatting.with_cases(formatting.scale(type_))}"]
    elif type_.unit:
        parts += [type_.unit.symbol]
    limits = formatting.ranges(type_)
    parts += [f"raw {formatting.with_cases(limits)}"] if limits and type_.encoding is not Encoding.FLOAT else []
    parts += [f"raw {formatting.no_value(no_value)} is {no_value.name}" for no_value in type_.no_values]
    parts += [f"raw {member.value} is named {member.name}" for member in type_.names]
    parts += [f"only {', '.join(field.only)}"] if field.only else []
    parts += [f"in the manual: {field.manual_name}"] if field.manual_name else []
    return text.comment("; ".join(parts))


def field_type(field: Field) -> str:
    """The type of a field."""
    raw, value, given = _types(field.type)
    if isinstance(field.type.joined, JoinedText):
        return f"FieldOf<readonly ({raw})[], string, string>"
    if field.type.joined is not None:
        return f"FieldOf<readonly ({raw})[], number | null, number | bigint>"
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
    given = number + "".join(f" | {text.quoted(member.name)}" for member in type_.members)
    if type_.no_values:
        return raw, f"{raw if type_.is_plain else 'number'} | null", f"{given} | null"
    if type_.is_plain:
        return raw, raw, given
    linear = type_.linear.constant
    always = type_.encoding is not Encoding.FLOAT and linear is not None and linear.times is None
    return raw, "number" if always else "number | null", given
