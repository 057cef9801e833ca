"""Frames in the language: fields, layouts, messages, tables and commands."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.layout import MAX_DATA_BYTES
from ..model.types import Encoding, Order
from .concept import Choose, Concept, Doc, JsonSchema, Limits, keys
from .scalar_types import Byte, CodeFormat, Indices, Name, Nodes, Only, Rational, Raw, Section, Start, Text
from .types import Deprecated, Description, RenamedFrom


@dataclass(frozen=True, kw_only=True)
class FieldSpec(Description):
    """A run of bits with a type."""

    called = "a field"
    example = {"at": 4, "raw": "u16"}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": ["type"]}, {"required": ["raw"]}]}

    at: Annotated[
        Start,
        Doc(
            "The start of the field: byte 4, bit 3 of byte 4 (4.3), or bit 5 of the id (id.5). In the data, a "
            "little-endian field starts at its least significant bit, which is bit 0 of a byte without a bit number. A "
            "big-endian field starts at its most significant bit, which is bit 7. In the id, every field starts at its "
            "least significant bit."
        ),
    ]
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None
    type: Annotated[Name | None, Doc("A type of this edition.")] = None
    raw: Annotated[Raw | None, Doc("Format of a plain number, instead of a type.")] = None
    byte_order: Annotated[Order | None, Doc("Byte order of a plain number, if not that of the edition.")] = None
    array: Annotated[Indices | None, Doc("Indices of an array of adjacent elements.", examples=("1..4",))] = None
    only: Only = None
    constant: Annotated[int | None, Doc("The only valid raw value.")] = None
    reserved: Annotated[
        int | None,
        Doc(
            "The raw value to send; a receiver ignores it. For padding, or a priority in the id. Bits without a "
            "field are sent as 0 and ignored."
        ),
    ] = None
    holds: Annotated[
        Literal["node"] | None,
        Doc("`node` if the field contains the node, or its low bits. A reply then comes from the node of the request."),
    ] = None
    manual: Annotated[Section | None, Doc("Section of the manual, if not that of the command.")] = None


EMPTY_RAW: tuple[Encoding, int] = (Encoding.UNSIGNED, 1)
"""The format for a field without one, so that its other keys can be checked."""


Fields = Annotated[dict[Name, FieldSpec], Limits(max_length=1000)]


LayoutOrName = Name | Fields
"""A shared layout's name, or fields."""


@dataclass(frozen=True, kw_only=True)
class LayoutSpec(Description):
    """Fields with their bits, shared by several messages. Bits without a field are reserved."""

    called = "a layout"
    example = {"fields": {"level": {"at": 4, "raw": "u16"}}}

    fields: Annotated[Fields, Doc("The fields, by name.")]
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None


Code = Byte | Annotated[dict[Name, Byte], Limits(min_length=1)]
"""A code, or one code for each kind of table entry."""


@dataclass(frozen=True, kw_only=True)
class MessageSpec(Concept):
    """A request or reply with more keys than its fields."""

    called = "a request or a reply"
    schema_extra: ClassVar[JsonSchema] = {"dependentSchemas": {"of": {"propertyNames": {"enum": ["of", "from_each"]}}}}

    layout: Annotated[
        LayoutOrName | None,
        Doc("Fields, the name of a shared layout, or `entry` for the fields of the table entry."),
    ] = None
    fields: Annotated[Fields | None, Doc("Further fields, in addition to those of `layout`.")] = None
    of: Annotated[Name | None, Doc("The command with this reply.")] = None
    from_each: Annotated[
        Nodes | None, Doc("The nodes that reply, one frame each, in this order.", examples=("1..4",))
    ] = None
    code: Annotated[
        Code | None,
        Doc(
            "Code, if not that of the command; or one code for each `kind` of table entry.",
            examples=(
                0x60,
                {"byte": 0x4F, "word": 0x4B},
            ),
        ),
    ] = None
    accept: Annotated[list[Byte] | None, Limits(max_length=256), Doc("Further codes that a receiver accepts.")] = None
    address: Annotated[Name | None, Doc("Address, if not that of the command.")] = None
    dlc: Annotated[
        int | None, Limits(ge=0, le=MAX_DATA_BYTES), Doc("Number of data bytes, if not that of the bus.")
    ] = None
    remote: Annotated[bool | None, Doc("True for a remote frame, which has no data.")] = None


def _message_kind(value: Mapping[str, object]) -> int:
    """0 for fields, 1 for a message with further keys."""
    names_fields = all(isinstance(inner, dict) and "at" in inner for inner in value.values())
    return int(bool(set(value) & set(keys(MessageSpec))) and not names_fields)


MessageOrName = Annotated[Name | Fields | MessageSpec, Choose(_message_kind)]


@dataclass(frozen=True, kw_only=True)
class Selector(Concept):
    """The bits that identify a command or a table entry."""

    example = {"at": 0, "raw": "u8"}

    at: Annotated[Start, Doc("Start of the bits, in the data or in the id.")]
    raw: Annotated[CodeFormat, Doc("Format, usually u8.")]
    byte_order: Annotated[Order | None, Doc("Overrides the edition's byte order.")] = None


@dataclass(frozen=True, kw_only=True)
class EntrySpec(Description):
    """One entry of a table: an index and a layout."""

    called = "an entry of a table"
    example = {"index": 1, "layout": {"gain": {"at": 4, "raw": "u16"}}}
    advice = {
        **dict.fromkeys(("subindex", "sub_index", "sub"), "write both numbers as a list: index: [0x6060, 1]"),
        **dict.fromkeys(
            ("read_only", "readonly", "ro"),
            "list the commands that have it: commands: [READ], with the name of the read command",
        ),
    }

    index: Annotated[
        Annotated[list[Byte], Limits(min_length=1)] | Byte,
        Doc("Value of the index; a list, possibly shorter, if the index is a list."),
    ]
    layout: Annotated[LayoutOrName, Doc("Fields, or the name of a shared layout.")]
    renamed_from: RenamedFrom = None
    kind: Annotated[
        Name | None, Doc("Kind of entry, a name that you choose, if the codes of a command depend on it.")
    ] = None
    commands: Annotated[
        list[Name] | None,
        Limits(min_length=1),
        Doc(
            "The commands with this entry, if not all commands of the table; for example, of a read-only entry.",
            examples=(["read"],),
        ),
    ] = None
    dlc: Annotated[
        int | None,
        Limits(ge=0, le=MAX_DATA_BYTES),
        Doc("Number of data bytes of messages with this layout, if not that of other entries."),
    ] = None
    only: Only = None
    effects: Annotated[list[Name], Doc("Effects of writing this entry, in addition to those of the command.")] = field(
        default_factory=list
    )
    manual: Annotated[Section | None, Doc("Section of the manual, if not that of the command.")] = None


@dataclass(frozen=True, kw_only=True)
class TableSpec(Description):
    """Entries that several commands read and write by index: a second selector, and a layout for each value."""

    called = "a table"
    example = {
        "index": {"at": 1, "raw": "u8"},
        "entries": {"gain": {"index": 1, "layout": {"gain": {"at": 4, "raw": "u16"}}}},
    }

    index: Annotated[
        Annotated[list[Selector], Limits(min_length=1)] | Selector,
        Doc("The bits with the index; a list if there is a second index."),
    ]
    entries: Annotated[dict[Name, EntrySpec], Limits(min_length=1), Doc("The entries, by name.")]
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None


@dataclass(frozen=True, kw_only=True)
class CommandSpec(Description):
    """A code with its request and its reply."""

    called = "a command"
    example = {"code": "0x10", "reply": "none"}
    schema_extra: ClassVar[JsonSchema] = {"required": ["reply"]}

    code: Annotated[
        Code | None,
        Doc(
            "Value of the selector, or one value for each `kind` of table entry; omitted without a selector.",
            examples=(
                0x10,
                {"byte": 0x2F, "word": 0x2B},
            ),
        ),
    ] = None
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None
    short_name: Annotated[
        Name | None,
        Doc(
            "Stands for the name of the command in the identifiers of C, where names that start with the same 63 characters "
            "may be the same.",
            examples=("read_param",),
        ),
    ] = None
    address: Annotated[Name | None, Doc("Address, if not the first.")] = None
    mode: Annotated[Name | None, Doc("Bus mode, if not the first.")] = None
    table: Annotated[Name | None, Doc("Table; the command then has one form for each entry, `COMMAND_ENTRY`.")] = None
    manual: Annotated[Section | None, Doc("Section of the manual, in quotes.", examples=("2.10",))] = None
    only: Only = None
    reply_within_ms: Annotated[
        Rational | None, Doc("Maximum time from request to reply, if it is longer than that of the bus.")
    ] = None
    implemented: Annotated[bool, Doc("False if the manual states that it is not implemented.")] = True
    request: Annotated[
        MessageOrName | None,
        Doc(
            "Fields, the name of a shared layout, `entry` (the fields of the table entry), or `none` for a frame that "
            "nodes send without a request. Without this key, the request has no fields."
        ),
    ] = None
    reply: Annotated[
        MessageOrName | None,
        Doc(
            "Fields, the name of a shared layout, `echo` (the reply repeats the request), `entry` (the fields of the "
            "table entry) or `none`."
        ),
    ] = None
    effects: Annotated[list[Name], Doc("Side effects; names of `effects`.")] = field(default_factory=list)
    limited_by: Annotated[list[Name], Doc("Settings that limit it.")] = field(default_factory=list)
    not_limited_by: Annotated[list[Name], Doc("Settings that do not limit it, contrary to expectation.")] = field(
        default_factory=list
    )
    notes: Annotated[list[Text], Doc("Further information for users.")] = field(default_factory=list)
