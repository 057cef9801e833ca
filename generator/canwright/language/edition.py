"""The language: one class a concept, every key with its description. The JSON Schema is made from it."""

from __future__ import annotations

import json
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag

from ..model.layout import MAX_DATA_BYTES
from ..model.metadata import Level
from ..model.types import Order
from .messages import (
    EMPTY_RAW as EMPTY_RAW,
    NO_INDEX as NO_INDEX,
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
    is_map,
)
from .suggestions import DATE
from .types import (
    Concept as Concept,
    Flag as Flag,
    Member as Member,
    OffsetBy as OffsetBy,
    RangeBy as RangeBy,
    Scale as Scale,
    ScaleBy as ScaleBy,
    Titled as Titled,
    Type as Type,
)


class Address(Titled):
    """A rule from node to CAN id, and back."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": ["id"]}, {"required": ["request", "reply"]}]})

    id: Annotated[
        IdText | None,
        Field(description="Id of both directions: `0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed one."),
    ] = None
    request: Annotated[IdText | None, Field(description="Id of requests, when replies have another.")] = None
    reply: Annotated[IdText | None, Field(description="Id of replies, when requests have another.")] = None
    nodes: Annotated[Nodes | None, Field(description="The nodes there can be.", examples=["1..32"])] = None
    selector: Annotated[Selector | None, Field(description="What tells commands here, when not the edition's.")] = None
    reply_selector: Annotated[
        Selector | None, Field(description="What tells replies, when it stands elsewhere than in requests.")
    ] = None
    extended: Annotated[bool, Field(description="True for 29-bit ids.")] = False
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class Mode(Titled):
    """A way to run the bus; commands of different modes exclude each other."""

    bit_rates_kbps: Annotated[
        list[Annotated[int, Field(ge=1, le=1000)]], Field(description="Bit rates, in kbit/s, up to 1000.")
    ]
    default_kbps: Annotated[int | None, Field(description="The bit rate of a new node, in kbit/s.")] = None


class Bus(Concept):
    """What host and nodes must agree on before the first frame."""

    host: Annotated[
        str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=48, description="Name of the host in DBC files.")
    ] = "Host"
    dlc: Annotated[
        int, Field(ge=0, le=MAX_DATA_BYTES, description="Data bytes of every frame, unless a message says otherwise.")
    ] = 8
    max_nodes: Annotated[int | None, Field(ge=1, description="How many nodes one bus can have.")] = None
    reply_within_ms: Annotated[Rational | None, Field(description="Time from request to reply.")] = None
    modes: Annotated[dict[Name, Mode], Field(description="Modes of the bus; the first is the usual one.")] = {}
    manual: Annotated[Section | None, Field(description="Section of the manual.")] = None


class NumberRange(Concept):
    """A number parameter's limits."""

    min: Annotated[Rational | None, Field(description="Smallest value.")] = None
    max: Annotated[Rational | None, Field(description="Largest value.")] = None


Choice = Annotated[
    Annotated[int, Tag("number")] | Annotated[ValueName, Tag("name")],
    Discriminator(lambda value: "number" if isinstance(value, int) else "name"),
]


class ParameterSpec(Titled):
    """What the integrator knows of a node and no frame says: a choice among values, or a number."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["values"]}, {"required": ["number"]}]})

    values: Annotated[
        Annotated[
            Annotated[list[Choice], Field(min_length=1, max_length=256), Tag("plain")]
            | Annotated[dict[ValueName, Titled], Field(min_length=1, max_length=256), Tag("map")],
            Discriminator(is_map),
        ]
        | None,
        Field(
            description="The values of a choice: a list of numbers or names, or names with a title.",
            examples=[[14, 15, 18], ["A", "B"]],
        ),
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

    stand_ins: ClassVar[dict[str, object]] = dict.fromkeys(("id", "manual", "printed", "used", "why"), "lost") | {
        "where": ["canwright"]
    }

    id: Annotated[Name, Field(description="A name for it, unique in the edition.")]
    where: Annotated[list[str], Field(min_length=1, description="What it is about, as dotted paths into this file.")]
    manual: Annotated[Section, Field(description="Section of the manual.")]
    printed: Annotated[Text, Field(description="What the manual says.")]
    used: Annotated[Text, Field(description="What this spec says.")]
    why: Annotated[Text, Field(description="Why the one and not the other.")]


class EditionSpec(Titled):
    """One exact protocol: a label and a date, and all there is to know of it."""

    stand_ins: ClassVar[dict[str, object]] = {
        "canwright": 1,
        "family": "lost",
        "edition": "lost",
        "addresses": {"lost": {"id": 0}},
        "commands": {"lost": {"reply": "none"}},
    }
    mistaken: ClassVar[tuple[str, str, str]] = (
        "frames",
        "these are golden frames, not a spec",
        "name the spec that they stand beside; it is read together with them",
    )

    canwright: Annotated[Literal[1], Field(description="Version of this language.")]
    family: Annotated[Name, Field(description="The protocols that grew from one another; prefix of generated names.")]
    edition: Annotated[
        str,
        Field(pattern=r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$", max_length=40, description="Label, and date where needed."),
    ]
    date: Annotated[
        str | None,
        Field(pattern=DATE, description="Date of the manual: 2023-03 or 2023-03-21."),
    ] = None
    languages: Annotated[list[Language], Field(min_length=1, description="Languages that every text is given in.")] = [
        "en"
    ]
    manual: Annotated[Text | None, Field(description="Title of the manual that this spec follows.")] = None
    byte_order: Annotated[
        Order, Field(description="Which byte comes first; a type may say otherwise.", strict=False)
    ] = Order.LITTLE
    bus: Annotated[Bus, Field(description="What host and nodes must agree on.")] = Bus()
    addresses: Annotated[
        dict[Name, Address], Field(min_length=1, max_length=256, description="Addresses; the first is the usual one.")
    ]
    selector: Annotated[Selector | None, Field(description="What tells one command from another.")] = None
    parameters: Annotated[dict[Name, ParameterSpec], Field(max_length=256, description="Parameters, by name.")] = {}
    settings: Annotated[dict[Name, SettingSpec], Field(description="Settings, by name.")] = {}
    effects: Annotated[dict[Name, EffectSpec], Field(description="Effects, by name.")] = {}
    types: Annotated[dict[Name, Type], Field(description="Types, by name.")] = {}
    layouts: Annotated[dict[Name, LayoutSpec], Field(description="Layouts that several messages share, by name.")] = {}
    tables: Annotated[dict[Name, Table], Field(description="Tables, by name.")] = {}
    commands: Annotated[dict[Name, Command], Field(min_length=1, description="Commands, by name.")]
    errata: Annotated[list[ErratumSpec], Field(description="Errata, in the order of the manual.")] = []


CONCEPTS: dict[type[Concept], str] = {
    EditionSpec: "the edition",
    Type: "a type",
    FieldSpec: "a field",
    MessageSpec: "a request or a reply",
    Command: "a command",
    Address: "an address",
    Bus: "`bus`",
    Mode: "a mode of `bus`",
    LayoutSpec: "a layout",
    Table: "a table",
    Entry: "an entry of a table",
    ParameterSpec: "a parameter",
    EffectSpec: "an effect",
    ErratumSpec: "an erratum",
}
"""What the concepts are called."""

JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema_text(concept: type[Concept]) -> str:
    """The JSON Schema of a file that holds `concept`, as text, for editors and other tools."""
    schema = {"$schema": JSON_SCHEMA_DIALECT, **_strict(concept.model_json_schema())}
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def _strict(schema: Any) -> Any:
    """A JSON Schema as strict as reading is: a key that is given has a value, and a name fits its pattern."""
    if isinstance(schema, list):
        return [_strict(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: _strict(part) for key, part in schema.items() if (key, part) != ("default", None)}
    if "patternProperties" in found:
        found.setdefault("additionalProperties", False)
    given = [part for part in found.get("anyOf", ()) if part != {"type": "null"}]
    if len(given) == 1 and len(found["anyOf"]) == 2:
        del found["anyOf"]
        return {**given[0], **found}
    return {**found, "anyOf": given} if given else found
