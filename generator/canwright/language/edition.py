"""The language: one class a concept, every key with its description. The JSON Schema is made from it."""

import json
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.layout import MAX_DATA_BYTES
from ..model.metadata import Level
from ..model.types import Order
from .concept import Concept as Concept, JsonSchema, Key, Limits, keys as keys
from .forms import Mapped
from .messages import (
    EMPTY_RAW as EMPTY_RAW,
    Code as Code,
    Command as Command,
    Entry as Entry,
    Fields as Fields,
    FieldSpec as FieldSpec,
    LayoutSpec as LayoutSpec,
    MessageSpec as MessageSpec,
    Selector as Selector,
    Table as Table,
)
from .scalar_types import (
    IdText,
    Language as Language,
    Name as Name,
    Nodes,
    Only,
    Rational,
    Section,
    Text as Text,
    ValueName,
)
from .suggestions import DATE
from .types import (
    Flag as Flag,
    Member as Member,
    OffsetBy as OffsetBy,
    RangeBy as RangeBy,
    Scale as Scale,
    ScaleBy as ScaleBy,
    Titled as Titled,
    Type as Type,
)


@dataclass(frozen=True, kw_only=True)
class Address(Titled):
    """A rule from node to CAN id, and back."""

    called = "an address"
    example = {"id": "0x100 + node", "nodes": "1..32"}
    schema_extra: ClassVar[JsonSchema] = {"anyOf": [{"required": ["id"]}, {"required": ["request", "reply"]}]}

    id: Annotated[
        IdText | None,
        Key("Id of both directions: `0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed one."),
    ] = None
    request: Annotated[IdText | None, Key("Id of requests, when replies have another.")] = None
    reply: Annotated[IdText | None, Key("Id of replies, when requests have another.")] = None
    nodes: Annotated[Nodes | None, Key("The nodes there can be.", examples=("1..32",))] = None
    selector: Annotated[Selector | None, Key("What tells commands here, when not the edition's.")] = None
    reply_selector: Annotated[
        Selector | None, Key("What tells replies, when it stands elsewhere than in requests.")
    ] = None
    extended: Annotated[bool, Key("True for 29-bit ids.")] = False
    manual: Annotated[Section | None, Key("Section of the manual.")] = None


@dataclass(frozen=True, kw_only=True)
class Mode(Titled):
    """A way to run the bus; commands of different modes exclude each other."""

    called = "a mode of `bus`"
    example = {"bit_rates_kbps": [500, 1000]}

    bit_rates_kbps: Annotated[list[Annotated[int, Limits(ge=1, le=1000)]], Key("Bit rates, in kbit/s, up to 1000.")]
    default_kbps: Annotated[int | None, Key("The bit rate of a new node, in kbit/s.")] = None


@dataclass(frozen=True, kw_only=True)
class Bus(Concept):
    """What host and nodes must agree on before the first frame."""

    called = "`bus`"
    example = {"host": "Host", "dlc": 8}

    host: Annotated[
        str, Limits(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=48), Key("Name of the host in DBC files.")
    ] = "Host"
    dlc: Annotated[
        int, Limits(ge=0, le=MAX_DATA_BYTES), Key("Data bytes of every frame, unless a message says otherwise.")
    ] = 8
    max_nodes: Annotated[int | None, Limits(ge=1), Key("How many nodes one bus can have.")] = None
    reply_within_ms: Annotated[Rational | None, Key("Time from request to reply.")] = None
    modes: Annotated[dict[Name, Mode], Key("Modes of the bus; the first is the usual one.")] = field(
        default_factory=dict
    )
    manual: Annotated[Section | None, Key("Section of the manual.")] = None


@dataclass(frozen=True, kw_only=True)
class NumberRange(Concept):
    """A number parameter's limits."""

    called = "`number`"
    example = {"min": 1, "max": 10}

    min: Annotated[Rational | None, Key("Smallest value.")] = None
    max: Annotated[Rational | None, Key("Largest value.")] = None


Choice = int | ValueName


@dataclass(frozen=True, kw_only=True)
class ParameterSpec(Titled):
    """What the integrator knows of a node and no frame says: a choice among values, or a number."""

    called = "a parameter"
    example = {"values": ["A", "B"]}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": ["values"]}, {"required": ["number"]}]}

    values: Annotated[
        list[Choice] | dict[ValueName, Titled] | None,
        Limits(min_length=1, max_length=256),
        Key(
            "The values of a choice: a list of numbers or names, or names with a title.",
            examples=([14, 15, 18], ["A", "B"]),
        ),
    ] = None
    number: Annotated[NumberRange | None, Key("A number, with its limits.")] = None


@dataclass(frozen=True, kw_only=True)
class SettingSpec(Titled):
    """A limit that is set on the node by other means than this protocol."""

    example = {"title": "Limit of the current"}

    only: Only = None


@dataclass(frozen=True, kw_only=True)
class EffectSpec(Titled):
    """What sending a command can do besides its reply."""

    called = "an effect"
    example = {"title": "Moves", "level": "warning"}

    level: Annotated[Level, Key("note, warning, or danger.")] = Level.NOTE


@dataclass(frozen=True, kw_only=True)
class ErratumSpec(Concept):
    """Where the manual is wrong or silent, and what this spec does about it."""

    called = "an erratum"
    example = {"id": "unit_of_power", "where": ["types.power"], "manual": "3", "printed": "…", "used": "…", "why": "…"}

    id: Annotated[Name, Key("A name for it, unique in the edition.")]
    where: Annotated[list[str], Limits(min_length=1), Key("What it is about, as dotted paths into this file.")]
    manual: Annotated[Section, Key("Section of the manual.")]
    printed: Annotated[Text, Key("What the manual says.")]
    used: Annotated[Text, Key("What this spec says.")]
    why: Annotated[Text, Key("Why the one and not the other.")]


@dataclass(frozen=True, kw_only=True)
class EditionSpec(Titled):
    """One exact protocol: a label and a date, and all there is to know of it."""

    called = "the edition"
    example = {
        "canwright": 1,
        "family": "lamp",
        "edition": "v1",
        "addresses": {"lamp": {"id": "0x100 + node", "nodes": "1..4"}},
        "commands": {},
    }
    advice = dict.fromkeys(
        ("frames", "refused", "exchanges", "sources"),
        "golden frames stand in a file of their own, EDITION.frames.yaml beside EDITION.yaml",
    )
    other = (
        "frames",
        "these are golden frames, not a spec",
        "name the spec that they stand beside; it is read together with them",
    )

    canwright: Annotated[Literal[1], Key("Version of this language.")]
    family: Annotated[Name, Key("The protocols that grew from one another; prefix of generated names.")]
    edition: Annotated[
        str,
        Limits(pattern=r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$", max_length=40),
        Key("Label, and date where needed."),
    ]
    date: Annotated[
        str | None,
        Limits(pattern=DATE),
        Key("Date of the manual: 2023-03 or 2023-03-21."),
    ] = None
    languages: Annotated[list[Language], Limits(min_length=1), Key("Languages that every text is given in.")] = field(
        default_factory=lambda: ["en"]
    )
    manual: Annotated[Text | None, Key("Title of the manual that this spec follows.")] = None
    byte_order: Annotated[Order, Key("Which byte comes first; a type may say otherwise.")] = Order.LITTLE
    bus: Annotated[Bus, Key("What host and nodes must agree on.")] = Bus()
    addresses: Annotated[
        dict[Name, Address], Limits(min_length=1, max_length=256), Key("Addresses; the first is the usual one.")
    ]
    selector: Annotated[Selector | None, Key("What tells one command from another.")] = None
    parameters: Annotated[dict[Name, ParameterSpec], Limits(max_length=256), Key("Parameters, by name.")] = field(
        default_factory=dict
    )
    settings: Annotated[dict[Name, SettingSpec], Key("Settings, by name.")] = field(default_factory=dict)
    effects: Annotated[dict[Name, EffectSpec], Key("Effects, by name.")] = field(default_factory=dict)
    types: Annotated[dict[Name, Type], Key("Types, by name.")] = field(default_factory=dict)
    layouts: Annotated[dict[Name, LayoutSpec], Key("Layouts that several messages share, by name.")] = field(
        default_factory=dict
    )
    tables: Annotated[dict[Name, Table], Key("Tables, by name.")] = field(default_factory=dict)
    commands: Annotated[dict[Name, Command], Limits(min_length=1), Key("Commands, by name.")]
    errata: Annotated[list[ErratumSpec], Key("Errata, in the order of the manual.")] = field(default_factory=list)


JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(concept: type[Concept]) -> JsonSchema:
    """The JSON Schema of a file that contains `concept`."""
    definitions: dict[str, JsonSchema] = {}
    body = Mapped(concept).body(definitions)
    return {"$schema": JSON_SCHEMA_DIALECT, "$defs": dict(sorted(definitions.items())), **body}


def schema_text(concept: type[Concept]) -> str:
    """The JSON Schema as text, for editors and other tools."""
    return json.dumps(json_schema(concept), indent=2, ensure_ascii=False) + "\n"
