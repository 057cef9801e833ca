"""The part of the language that lays out frames: fields, layouts, messages, tables and commands."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag

from ..model.layout import MAX_DATA_BYTES
from ..model.types import Encoding, Order
from .scalar_types import Byte, CodeFormat, Indices, Name, Nodes, Only, Raw, Section, Start, Text, is_map
from .types import Concept, Titled


class FieldSpec(Titled):
    """A run of bits with a type."""

    stand_ins: ClassVar[dict[str, object]] = {"at": 0}
    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["type"]}, {"required": ["raw"]}]})

    at: Annotated[
        Start,
        Field(
            description="Where it starts: byte 4, bit 3 of byte 4 (4.3), or bit 5 of the id (id.5). In the data, "
            "little-endian fields start at their least significant bit and big-endian ones at their most significant: with a "
            "byte alone, at its bit 0 or its bit 7. In the id, all start at their least significant bit."
        ),
    ]
    type: Annotated[Name | None, Field(description="A type of this edition.")] = None
    raw: Annotated[Raw | None, Field(description="A bare number of this format, in place of a type.")] = None
    byte_order: Annotated[
        Order | None, Field(description="Of a bare number: overrides the edition's byte order.", strict=False)
    ] = None
    array: Annotated[
        Indices | None, Field(description="Indices of an array whose elements follow one another.", examples=["1..4"])
    ] = None
    only: Only = None
    constant: Annotated[
        int | None, Field(description="The raw value that it always holds, in the data or in the id.")
    ] = None
    reserved: Annotated[
        int | None,
        Field(
            description="The raw value that is sent here, while a reader ignores what it finds: padding, or a priority "
            "in the id. Bits that no field covers are sent as 0 and ignored."
        ),
    ] = None
    holds: Annotated[
        Literal["node"] | None,
        Field(
            description="`node` when it says which node the frame is to or from, or the low bits of that: an answer "
            "then comes from the node that was asked."
        ),
    ] = None
    manual: Annotated[Section | None, Field(description="Section of the manual, when not the command's.")] = None


EMPTY_RAW: tuple[Encoding, int] = (Encoding.UNSIGNED, 1)
"""Stands in for the format of a field that has none, so that its other findings come out too."""


Fields = Annotated[dict[Name, FieldSpec], Field(max_length=1000)]


LayoutOrName = Annotated[
    Annotated[Name, Tag("name")] | Annotated[Fields, Tag("fields")],
    Discriminator(lambda value: "fields" if isinstance(value, dict) else "name"),
]
"""A shared layout's name, or fields."""


class LayoutSpec(Titled):
    """Fields with their bits, shared by several messages. Bits that no field covers are reserved."""

    fields: Annotated[Fields, Field(description="The fields, by name.")]
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


Code = Annotated[
    Annotated[Byte, Tag("plain")] | Annotated[dict[Name, Byte], Field(min_length=1), Tag("map")], Discriminator(is_map)
]
"""A code, or one for each kind of the table's entries."""


class MessageSpec(Concept):
    """A request or reply that needs more said than its fields."""

    model_config = ConfigDict(
        json_schema_extra={"dependentSchemas": {"of": {"propertyNames": {"enum": ["of", "from_each"]}}}}
    )

    layout: Annotated[
        LayoutOrName | None,
        Field(description="A shared layout's name, fields, or `entry`, those of the table's entry."),
    ] = None
    fields: Annotated[Fields | None, Field(description="Further fields, besides those of `layout`.")] = None
    of: Annotated[Name | None, Field(description="The command whose reply this one is.")] = None
    from_each: Annotated[
        Nodes | None, Field(description="The nodes that reply, one frame each, in this order.", examples=["1..4"])
    ] = None
    code: Annotated[
        Code | None,
        Field(
            description="Code, when not the command's; or one for each `kind` of the table's entries.",
            examples=[0x60, {"byte": 0x4F, "word": 0x4B}],
        ),
    ] = None
    accept: Annotated[list[Byte] | None, Field(max_length=256, description="Further codes that a receiver takes.")] = (
        None
    )
    address: Annotated[Name | None, Field(description="Address, when not the command's.")] = None
    dlc: Annotated[int | None, Field(ge=0, le=MAX_DATA_BYTES, description="Data bytes, when not the bus's.")] = None
    remote: Annotated[bool | None, Field(description="True for a remote frame, which has no data.")] = None


def _message_kind(value: object) -> str:
    if not isinstance(value, dict):
        return "name"
    keys = set(value) & set(MessageSpec.model_fields)
    named = keys and all(isinstance(field, dict) and "at" in field for field in value.values())
    return "long" if keys and not named else "fields"


Message = Annotated[
    Annotated[Name, Tag("name")] | Annotated[Fields, Tag("fields")] | Annotated[MessageSpec, Tag("long")],
    Discriminator(_message_kind),
]


class Selector(Concept):
    """The bits that tell one command from another, or one entry of a table."""

    at: Annotated[Start, Field(description="Where it is, in the data or in the id.")]
    raw: Annotated[CodeFormat, Field(description="Its format, usually u8.")]
    byte_order: Annotated[Order | None, Field(description="Overrides the edition's byte order.", strict=False)] = None


def is_list(value: object) -> str:
    return "list" if isinstance(value, list) else "plain"


NO_INDEX = 10**31
"""Stands in for an index that could not be read: nobody can write one so large."""


class Entry(Titled):
    """One thing that a table's index can name, with its layout."""

    stand_ins: ClassVar[dict[str, object]] = {"index": NO_INDEX, "layout": {}}

    index: Annotated[
        Annotated[list[Byte], Field(min_length=1), Tag("list")] | Annotated[Byte, Tag("plain")],
        Discriminator(is_list),
        Field(description="Value of the index; a list where the index is one, and then it may be shorter."),
    ]
    layout: Annotated[LayoutOrName, Field(description="Fields, or a shared layout's name.")]
    kind: Annotated[
        Name | None, Field(description="A name of your own for entries alike, where a command's codes differ by it.")
    ] = None
    commands: Annotated[
        list[Name] | None,
        Field(
            min_length=1,
            description="The commands that have it, when not all of the table: for what can only be read.",
            examples=[["read"]],
        ),
    ] = None
    dlc: Annotated[
        int | None,
        Field(
            ge=0,
            le=MAX_DATA_BYTES,
            description="Data bytes of the messages that hold its layout, when not those of the others.",
        ),
    ] = None
    only: Only = None
    effects: Annotated[list[Name], Field(description="What writing it does, besides the command's effects.")] = []
    manual: Annotated[Section | None, Field(description="Section of the manual, when not the command's.")] = None


class Table(Titled):
    """Things that several commands read and write by an index: a second selector, and a layout for each value of it."""

    index: Annotated[
        Annotated[list[Selector], Field(min_length=1), Tag("list")] | Annotated[Selector, Tag("plain")],
        Discriminator(is_list),
        Field(description="The bits that hold the index; a list where a second one follows the first."),
    ]
    entries: Annotated[dict[Name, Entry], Field(min_length=1, description="The entries, by name.")]
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class Command(Titled):
    """A code with its request and its reply."""

    model_config = ConfigDict(json_schema_extra={"required": ["reply"]})

    code: Annotated[
        Code | None,
        Field(
            description="Value of the selector, or one for each `kind` of the table's entries; left out when there is none.",
            examples=[0x10, {"byte": 0x2F, "word": 0x2B}],
        ),
    ] = None
    address: Annotated[Name | None, Field(description="Address, when not the first.")] = None
    mode: Annotated[Name | None, Field(description="Bus mode, when not the first.")] = None
    table: Annotated[
        Name | None, Field(description="A table; the command then has one form for each entry, `COMMAND_ENTRY`.")
    ] = None
    manual: Annotated[Section | None, Field(description="Section of the manual, quoted.", examples=["2.10"])] = None
    only: Only = None
    implemented: Annotated[bool, Field(description="False when the manual says that it does not work yet.")] = True
    request: Annotated[
        Message | None,
        Field(
            description="Fields, the name of a shared layout, `entry` (the fields of the table's entry) or `none`, for "
            "what nodes send unasked; left out, a request without fields."
        ),
    ] = None
    reply: Annotated[
        Message | None,
        Field(
            description="Fields, the name of a shared layout, `echo` (the request comes back), `entry` (the fields of "
            "the table's entry) or `none`."
        ),
    ] = None
    effects: Annotated[list[Name], Field(description="What sending it does; names of `effects`.")] = []
    limited_by: Annotated[list[Name], Field(description="Settings that limit it.")] = []
    not_limited_by: Annotated[list[Name], Field(description="Settings that one would expect to limit it.")] = []
    notes: Annotated[list[Text], Field(description="What else its user should know.")] = []
