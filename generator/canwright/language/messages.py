"""The part of the language that lays out frames: fields, layouts, messages, tables and commands."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.layout import MAX_DATA_BYTES
from ..model.types import Encoding, Order
from .concept import Choose, Concept, JsonSchema, Key, Limits, keys
from .scalar_types import Byte, CodeFormat, Indices, Name, Nodes, Only, Raw, Section, Start, Text
from .types import Titled


@dataclass(frozen=True, kw_only=True)
class FieldSpec(Titled):
    """A run of bits with a type."""

    called = "a field"
    example = {"at": 4, "raw": "u16"}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": ["type"]}, {"required": ["raw"]}]}

    at: Annotated[
        Start,
        Key(
            "Where it starts: byte 4, bit 3 of byte 4 (4.3), or bit 5 of the id (id.5). In the data, "
            "little-endian fields start at their least significant bit and big-endian ones at their most significant: with a "
            "byte alone, at its bit 0 or its bit 7. In the id, all start at their least significant bit."
        ),
    ]
    type: Annotated[Name | None, Key("A type of this edition.")] = None
    raw: Annotated[Raw | None, Key("A bare number of this format, in place of a type.")] = None
    byte_order: Annotated[Order | None, Key("Of a bare number: overrides the edition's byte order.")] = None
    array: Annotated[
        Indices | None, Key("Indices of an array whose elements follow one another.", examples=("1..4",))
    ] = None
    only: Only = None
    constant: Annotated[int | None, Key("The raw value that it always holds, in the data or in the id.")] = None
    reserved: Annotated[
        int | None,
        Key(
            "The raw value that is sent here, while a reader ignores what it finds: padding, or a priority "
            "in the id. Bits that no field covers are sent as 0 and ignored."
        ),
    ] = None
    holds: Annotated[
        Literal["node"] | None,
        Key(
            "`node` when it says which node the frame is to or from, or the low bits of that: an answer "
            "then comes from the node that was asked."
        ),
    ] = None
    manual: Annotated[Section | None, Key("Section of the manual, when not the command's.")] = None


EMPTY_RAW: tuple[Encoding, int] = (Encoding.UNSIGNED, 1)
"""Stands in for the format of a field that has none, so that its other findings come out too."""


Fields = Annotated[dict[Name, FieldSpec], Limits(max_length=1000)]


LayoutOrName = Name | Fields
"""A shared layout's name, or fields."""


@dataclass(frozen=True, kw_only=True)
class LayoutSpec(Titled):
    """Fields with their bits, shared by several messages. Bits that no field covers are reserved."""

    called = "a layout"
    example = {"fields": {"level": {"at": 4, "raw": "u16"}}}

    fields: Annotated[Fields, Key("The fields, by name.")]
    manual: Annotated[Section | None, Key("Section of the manual.")] = None


Code = Byte | Annotated[dict[Name, Byte], Limits(min_length=1)]
"""A code, or one for each kind of the table's entries."""


@dataclass(frozen=True, kw_only=True)
class MessageSpec(Concept):
    """A request or reply that needs more said than its fields."""

    called = "a request or a reply"
    schema_extra: ClassVar[JsonSchema] = {"dependentSchemas": {"of": {"propertyNames": {"enum": ["of", "from_each"]}}}}

    layout: Annotated[
        LayoutOrName | None,
        Key("A shared layout's name, fields, or `entry`, those of the table's entry."),
    ] = None
    fields: Annotated[Fields | None, Key("Further fields, besides those of `layout`.")] = None
    of: Annotated[Name | None, Key("The command whose reply this one is.")] = None
    from_each: Annotated[
        Nodes | None, Key("The nodes that reply, one frame each, in this order.", examples=("1..4",))
    ] = None
    code: Annotated[
        Code | None,
        Key(
            "Code, when not the command's; or one for each `kind` of the table's entries.",
            examples=(
                0x60,
                {"byte": 0x4F, "word": 0x4B},
            ),
        ),
    ] = None
    accept: Annotated[list[Byte] | None, Limits(max_length=256), Key("Further codes that a receiver takes.")] = None
    address: Annotated[Name | None, Key("Address, when not the command's.")] = None
    dlc: Annotated[int | None, Limits(ge=0, le=MAX_DATA_BYTES), Key("Data bytes, when not the bus's.")] = None
    remote: Annotated[bool | None, Key("True for a remote frame, which has no data.")] = None


def _message_kind(value: Mapping[str, object]) -> int:
    """0 for fields, 1 for a message with further keys."""
    names_fields = all(isinstance(inner, dict) and "at" in inner for inner in value.values())
    return int(bool(set(value) & set(keys(MessageSpec))) and not names_fields)


Message = Annotated[Name | Fields | MessageSpec, Choose(_message_kind)]


@dataclass(frozen=True, kw_only=True)
class Selector(Concept):
    """The bits that tell one command from another, or one entry of a table."""

    example = {"at": 0, "raw": "u8"}

    at: Annotated[Start, Key("Where it is, in the data or in the id.")]
    raw: Annotated[CodeFormat, Key("Its format, usually u8.")]
    byte_order: Annotated[Order | None, Key("Overrides the edition's byte order.")] = None


@dataclass(frozen=True, kw_only=True)
class Entry(Titled):
    """One thing that a table's index can name, with its layout."""

    called = "an entry of a table"
    example = {"index": 1, "layout": {"gain": {"at": 4, "raw": "u16"}}}
    advice = {
        **dict.fromkeys(
            ("subindex", "sub_index", "sub"), "a second number stands behind the first: index: [0x6060, 1]"
        ),
        **dict.fromkeys(
            ("read_only", "readonly", "ro"),
            "say which commands have it: commands: [READ], by the name of the one that reads",
        ),
    }

    index: Annotated[
        Annotated[list[Byte], Limits(min_length=1)] | Byte,
        Key("Value of the index; a list where the index is one, and then it may be shorter."),
    ]
    layout: Annotated[LayoutOrName, Key("Fields, or a shared layout's name.")]
    kind: Annotated[Name | None, Key("A name of your own for entries alike, where a command's codes differ by it.")] = (
        None
    )
    commands: Annotated[
        list[Name] | None,
        Limits(min_length=1),
        Key("The commands that have it, when not all of the table: for what can only be read.", examples=(["read"],)),
    ] = None
    dlc: Annotated[
        int | None,
        Limits(ge=0, le=MAX_DATA_BYTES),
        Key("Data bytes of the messages that hold its layout, when not those of the others."),
    ] = None
    only: Only = None
    effects: Annotated[list[Name], Key("What writing it does, besides the command's effects.")] = field(
        default_factory=list
    )
    manual: Annotated[Section | None, Key("Section of the manual, when not the command's.")] = None


@dataclass(frozen=True, kw_only=True)
class Table(Titled):
    """Things that several commands read and write by an index: a second selector, and a layout for each value of it."""

    called = "a table"
    example = {
        "index": {"at": 1, "raw": "u8"},
        "entries": {"gain": {"index": 1, "layout": {"gain": {"at": 4, "raw": "u16"}}}},
    }

    index: Annotated[
        Annotated[list[Selector], Limits(min_length=1)] | Selector,
        Key("The bits that hold the index; a list where a second one follows the first."),
    ]
    entries: Annotated[dict[Name, Entry], Limits(min_length=1), Key("The entries, by name.")]
    manual: Annotated[Section | None, Key("Section of the manual.")] = None


@dataclass(frozen=True, kw_only=True)
class Command(Titled):
    """A code with its request and its reply."""

    called = "a command"
    example = {"code": "0x10", "reply": "none"}
    schema_extra: ClassVar[JsonSchema] = {"required": ["reply"]}

    code: Annotated[
        Code | None,
        Key(
            "Value of the selector, or one for each `kind` of the table's entries; left out when there is none.",
            examples=(
                0x10,
                {"byte": 0x2F, "word": 0x2B},
            ),
        ),
    ] = None
    address: Annotated[Name | None, Key("Address, when not the first.")] = None
    mode: Annotated[Name | None, Key("Bus mode, when not the first.")] = None
    table: Annotated[Name | None, Key("A table; the command then has one form for each entry, `COMMAND_ENTRY`.")] = None
    manual: Annotated[Section | None, Key("Section of the manual, quoted.", examples=("2.10",))] = None
    only: Only = None
    implemented: Annotated[bool, Key("False when the manual says that it does not work yet.")] = True
    request: Annotated[
        Message | None,
        Key(
            "Fields, the name of a shared layout, `entry` (the fields of the table's entry) or `none`, for "
            "what nodes send unasked; left out, a request without fields."
        ),
    ] = None
    reply: Annotated[
        Message | None,
        Key(
            "Fields, the name of a shared layout, `echo` (the request comes back), `entry` (the fields of "
            "the table's entry) or `none`."
        ),
    ] = None
    effects: Annotated[list[Name], Key("What sending it does; names of `effects`.")] = field(default_factory=list)
    limited_by: Annotated[list[Name], Key("Settings that limit it.")] = field(default_factory=list)
    not_limited_by: Annotated[list[Name], Key("Settings that one would expect to limit it.")] = field(
        default_factory=list
    )
    notes: Annotated[list[Text], Key("What else its user should know.")] = field(default_factory=list)
