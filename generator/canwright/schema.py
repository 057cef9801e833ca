"""The language: one class a concept, every key with its description. The JSON Schema is made from it."""

from __future__ import annotations

import json
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from .model import Encoding, Level, Order
from .written import (
    Byte as Byte,
    IdText as IdText,
    Language as Language,
    Line as Line,
    Name as Name,
    Nodes as Nodes,
    Only as Only,
    Printed as Printed,
    Rational as Rational,
    Raw as Raw,
    Section as Section,
    Span as Span,
    Start as Start,
    Text as Text,
    ValueName as ValueName,
    is_map as is_map,
)


class Concept(BaseModel):
    """What all concepts share: no unknown keys, nothing changes once it is read."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True, strict=True)


class Titled(Concept):
    """What people read of a concept."""

    title: Annotated[Text | None, Field(description="A few words, as a heading.")] = None
    about: Annotated[Text | None, Field(description="A sentence or two for whoever uses it.")] = None


def _none_or_plain(value: object) -> str:
    return "none" if value == "none" else "plain"


CaseScale = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Printed, Tag("plain")], Discriminator(_none_or_plain)
]
CaseSpan = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Span, Tag("plain")], Discriminator(_none_or_plain)
]


class ScaleBy(Concept):
    """A scale for each value of a choice parameter; `none` where the manual gives none."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, CaseScale]
    by: Annotated[Name, Field(description="The parameter that decides.")]


class RangeBy(Concept):
    """A range for each value of a choice parameter; `none` where the manual gives none."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, CaseSpan]
    by: Annotated[Name, Field(description="The parameter that decides.")]


Scale = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Printed, Tag("plain")] | Annotated[ScaleBy, Tag("map")],
    Discriminator(lambda value: "none" if value == "none" else is_map(value)),
]
SpanChoice = Annotated[Annotated[Span, Tag("plain")] | Annotated[RangeBy, Tag("map")], Discriminator(is_map)]


class Member(Titled):
    """A name for one raw value."""

    value: Annotated[int, Field(description="The raw value that has this name.")]


class Flag(Titled):
    """A name for one bit."""

    bit: Annotated[int, Field(ge=0, le=63, description="The bit, 0 is the least significant.")]


class Type(Titled):
    """How raw bits become a value."""

    raw: Annotated[Raw, Field(description="Sign and width: u8, i16, i56 (1 to 64 bits), or f32, f64.")]
    byte_order: Annotated[Order | None, Field(description="Overrides the edition's byte order.", strict=False)] = None
    unit: Annotated[str | None, Field(description="A unit of units.yaml; left out for a bare number.")] = None
    scale: Annotated[
        Scale | None,
        Field(description="value = raw * scale + offset. As printed: 0.01, 1/64, 16.5/2048; `none` if none is known."),
    ] = None
    offset: Annotated[Rational | None, Field(description="Added after scaling, in the unit.")] = None
    raw_range: Annotated[SpanChoice | None, Field(description="Allowed raw integers, when the manual says so.")] = None
    range: Annotated[SpanChoice | None, Field(description="Allowed values in the unit, when the manual says so.")] = (
        None
    )
    enum: Annotated[dict[Name, Member] | None, Field(description="The raw values that have a name.")] = None
    flags: Annotated[dict[Name, Flag] | None, Field(description="The bits that have a name.")] = None
    differs: Annotated[
        Text | None, Field(description="Why this scale or unit is another one than that of its like.")
    ] = None


class FieldSpec(Titled):
    """A run of bits with a type."""

    at: Annotated[
        Start,
        Field(
            description="Where it starts: byte 4, bit 3 of byte 4 (4.3), or bit 5 of the id (id.5). Little-endian "
            "fields start at their least significant bit, big-endian ones at their most significant."
        ),
    ]
    type: Annotated[Name | None, Field(description="A type of this edition.")] = None
    raw: Annotated[Raw | None, Field(description="A bare number of this format, in place of a type.")] = None
    array: Annotated[
        Nodes | None, Field(description="Indices of an array whose elements follow one another.", examples=["1..4"])
    ] = None
    only: Only = None
    constant: Annotated[int | None, Field(description="The raw value that it always holds.")] = None
    manual: Annotated[Section | None, Field(description="Section of the manual, when not the command's.")] = None


EMPTY_RAW: tuple[Encoding, int] = (Encoding.UNSIGNED, 1)
"""Stands in for the format of a field that has none, so that its other findings come out too."""


Fields = dict[Name, FieldSpec]


class LayoutSpec(Titled):
    """Fields with their bits, shared by several messages. Bits that no field covers are reserved."""

    fields: Annotated[Fields, Field(description="The fields, by name.")]
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class MessageSpec(Concept):
    """A request or reply that needs more said than its fields."""

    layout: Annotated[Name | Fields | None, Field(description="A shared layout's name, or fields.")] = None
    of: Annotated[Name | None, Field(description="The command whose reply this one is.")] = None
    from_each: Annotated[
        Nodes | None, Field(description="The nodes that reply, one frame each, in this order.", examples=["1..4"])
    ] = None
    code: Annotated[Byte | None, Field(description="Code, when not the command's.")] = None
    accept: Annotated[list[Byte] | None, Field(description="Further codes that a receiver takes.")] = None
    address: Annotated[Name | None, Field(description="Address, when not the command's.")] = None
    dlc: Annotated[int | None, Field(ge=0, le=8, description="Data bytes, when not the bus's.")] = None
    remote: Annotated[bool | None, Field(description="True for a remote frame, which has no data.")] = None


def _message_kind(value: object) -> str:
    if not isinstance(value, dict):
        return "name"
    return "long" if set(value) & set(MessageSpec.model_fields) else "fields"


Message = Annotated[
    Annotated[Name, Tag("name")] | Annotated[Fields, Tag("fields")] | Annotated[MessageSpec, Tag("long")],
    Discriminator(_message_kind),
]


class Command(Titled):
    """A code with its request and its reply."""

    code: Annotated[Byte | None, Field(description="Value of the selector; left out when there is none.")] = None
    address: Annotated[Name | None, Field(description="Address, when not the first.")] = None
    mode: Annotated[Name | None, Field(description="Bus mode, when not the first.")] = None
    manual: Annotated[Section | None, Field(description="Section of the manual, quoted.", examples=["2.10"])] = None
    only: Only = None
    implemented: Annotated[bool, Field(description="False when the manual says that it does not work yet.")] = True
    request: Annotated[
        Message | None,
        Field(description="Fields, the name of a shared layout, or `none`; left out, a request without fields."),
    ] = None
    reply: Annotated[
        Message | None,
        Field(description="Fields, the name of a shared layout, `echo` (the request comes back) or `none`."),
    ] = None
    effects: Annotated[list[Name], Field(description="What sending it does; names of `effects`.")] = []
    limited_by: Annotated[list[Name], Field(description="Settings that limit it.")] = []
    not_limited_by: Annotated[list[Name], Field(description="Settings that one would expect to limit it.")] = []
    notes: Annotated[list[Text], Field(description="What else its user should know.")] = []


class Address(Titled):
    """A rule from node to CAN id, and back."""

    id: Annotated[
        IdText | None, Field(description="Id of both directions: `0x100 + node`, `node << 5`, or a fixed one.")
    ] = None
    request: Annotated[IdText | None, Field(description="Id of requests, when replies have another.")] = None
    reply: Annotated[IdText | None, Field(description="Id of replies, when requests have another.")] = None
    nodes: Annotated[Nodes | None, Field(description="The nodes there can be.", examples=["1..32"])] = None
    extended: Annotated[bool, Field(description="True for 29-bit ids.")] = False
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class Selector(Concept):
    """The bits that tell one command from another."""

    at: Annotated[Start, Field(description="Where it is, in the data or in the id.")]
    raw: Annotated[Raw, Field(description="Its format, usually u8.")]
    byte_order: Annotated[Order | None, Field(description="Overrides the edition's byte order.", strict=False)] = None


class Mode(Titled):
    """A way to run the bus; commands of different modes exclude each other."""

    bit_rates_kbps: Annotated[list[int], Field(description="Bit rates, in kbit/s.")]
    default_kbps: Annotated[int | None, Field(description="The bit rate of a new node, in kbit/s.")] = None


class Bus(Concept):
    """What host and nodes must agree on before the first frame."""

    host: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", description="Name of the host in DBC files.")] = (
        "Host"
    )
    dlc: Annotated[
        int, Field(ge=0, le=8, description="Data bytes of every frame, unless a message says otherwise.")
    ] = 8
    max_nodes: Annotated[int | None, Field(ge=1, description="How many nodes one bus can have.")] = None
    reply_within_ms: Annotated[Rational | None, Field(description="Time from request to reply.")] = None
    modes: Annotated[dict[Name, Mode], Field(description="Modes of the bus; the first is the usual one.")] = {}
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class NumberRange(Concept):
    """A number parameter's limits."""

    min: Annotated[Rational | None, Field(description="Smallest value.")] = None
    max: Annotated[Rational | None, Field(description="Largest value.")] = None


class ParameterSpec(Titled):
    """What the integrator knows of a node and no frame says: a choice among values, or a number."""

    values: Annotated[
        list[int] | dict[ValueName, Titled] | None,
        Field(description="The values of a choice: numbers, or names with a title.", examples=[[14, 15, 18]]),
    ] = None
    number: Annotated[NumberRange | None, Field(description="A number, with its limits.")] = None


class SettingSpec(Titled):
    """A limit that is set on the node by other means than this protocol."""

    only: Only = None


class EffectSpec(Titled):
    """What sending a command can do besides its reply."""

    level: Annotated[Level, Field(description="note, warning, or danger.", strict=False)] = Level.NOTE


class ErratumSpec(Concept):
    """Where the manual is wrong or silent, and what this spec does about it."""

    id: Annotated[Name, Field(description="A name for it, unique in the edition.")]
    where: Annotated[list[str], Field(min_length=1, description="What it is about, as dotted paths into this file.")]
    manual: Annotated[Section, Field(description="Section of the manual.")]
    printed: Annotated[Text, Field(description="What the manual says.")]
    used: Annotated[Text, Field(description="What this spec says.")]
    why: Annotated[Text, Field(description="Why.")]


class EditionSpec(Titled):
    """One exact protocol: a label and a date, and all there is to know of it."""

    canwright: Annotated[Literal[1], Field(description="Version of this language.")]
    family: Annotated[Name, Field(description="The protocols that grew from one another; prefix of generated names.")]
    edition: Annotated[
        str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9.-]*$", max_length=40, description="Label, and date where needed.")
    ]
    date: Annotated[
        str | None, Field(pattern=r"^\d{4}(-\d{2}){0,2}$", description="Date of the manual: 2023-03 or 2023-03-21.")
    ] = None
    languages: Annotated[list[Language], Field(min_length=1, description="Languages that every text is given in.")] = [
        "en"
    ]
    manual: Annotated[Text | None, Field(description="Title of the manual that this spec follows.")] = None
    byte_order: Annotated[Order, Field(description="little or big; a type may override it.", strict=False)] = (
        Order.LITTLE
    )
    bus: Annotated[Bus, Field(description="What host and nodes must agree on.")] = Bus()
    addresses: Annotated[dict[Name, Address], Field(min_length=1, description="Addresses; the first is the usual one.")]
    selector: Annotated[Selector | None, Field(description="What tells one command from another.")] = None
    parameters: Annotated[dict[Name, ParameterSpec], Field(description="Parameters, by name.")] = {}
    settings: Annotated[dict[Name, SettingSpec], Field(description="Settings, by name.")] = {}
    effects: Annotated[dict[Name, EffectSpec], Field(description="Effects, by name.")] = {}
    types: Annotated[dict[Name, Type], Field(description="Types, by name.")] = {}
    layouts: Annotated[dict[Name, LayoutSpec], Field(description="Layouts that several messages share, by name.")] = {}
    commands: Annotated[dict[Name, Command], Field(min_length=1, description="Commands, by name.")]
    errata: Annotated[list[ErratumSpec], Field(description="Errata, in the order of the manual.")] = []


JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema_text(concept: type[Concept]) -> str:
    """The JSON Schema of a file that holds `concept`, as text, for editors and other tools."""
    schema = {"$schema": JSON_SCHEMA_DIALECT, **concept.model_json_schema()}
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
