"""The concepts of a spec with descriptions of all keys, and the JSON Schema generated from them."""

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.layout import MAX_DATA_BYTES
from ..model.message import Direction
from ..model.metadata import Consent, FrameFormat, Kept, Level, Repeat
from ..model.types import Order
from .checksum import ChecksumSpec as ChecksumSpec
from .concept import Concept as Concept, Defines, Doc, JsonSchema, Limits, Problem, Ref, keys as keys
from .forms import ConceptForm
from .messages import (
    ENTRY as ENTRY,
    FURTHER_REPLIES as FURTHER_REPLIES,
    AlternativeReplies,
    Code as Code,
    CommandName,
    CommandSpec as CommandSpec,
    EntrySpec as EntrySpec,
    Fields as Fields,
    FieldSpec as FieldSpec,
    LayoutSpec as LayoutSpec,
    MessageSpec as MessageSpec,
    Selector as Selector,
    TableSpec as TableSpec,
)
from .notation import IdExpression
from .scalar_types import (
    EditionName,
    EditionText as EditionText,
    Ids,
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
    DeprecatedSpec as DeprecatedSpec,
    Description as Description,
    EffectName,
    FlagSpec as FlagSpec,
    MemberSpec as MemberSpec,
    NameSpec as NameSpec,
    NoValueSpec as NoValueSpec,
    OffsetBy as OffsetBy,
    RangeBy as RangeBy,
    Scale as Scale,
    ScaleBy as ScaleBy,
    TypeSpec as TypeSpec,
)


@dataclass(frozen=True, eq=False, kw_only=True)
class AddressSpec(Description):
    """A rule from node to CAN id, and back."""

    called = "an address"
    example = {"id": "0x100 + node", "nodes": "1..32"}
    schema_extra: ClassVar[JsonSchema] = {"anyOf": [{"required": ["id"]}, {"required": ["request", "reply"]}]}

    id: Annotated[
        IdText | None,
        Doc(
            "Id of both directions: `0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed id. It can contain a number "
            "parameter that is set on the device: `host_id`, `base_id + node`, `(host_id << 8) + node`."
        ),
    ] = None
    request: Annotated[IdText | None, Doc("Id of requests, if replies have a different one.")] = None
    reply: Annotated[IdText | None, Doc("Id of replies, if requests have a different one.")] = None
    nodes: Annotated[Nodes | None, Doc("The possible nodes.", examples=("1..32",))] = None
    selector: Annotated[Selector | None, Doc("The bits that identify a command, if not those of the edition.")] = None
    reply_selector: Annotated[Selector | None, Doc("The bits that identify a reply, if not those of requests.")] = None
    extended: Annotated[bool, Doc("True for 29-bit ids.")] = False
    alternative_replies: AlternativeReplies = field(default_factory=list)
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None

    def id_of(self, direction: Direction) -> IdExpression:
        """The id of one direction."""
        written = (self.request if direction is Direction.REQUEST else self.reply) or self.id
        if written is None:
            raise ValueError("no id")
        return written

    def problems(self, name: str) -> Iterable[Problem]:
        request, reply = self.request or self.id, self.reply or self.id
        if request is None or reply is None:
            missing = "id" if request is reply else "id of requests" if request is None else "id of replies"
            yield Problem((), "missing-key", f"`{name}` has no {missing}", "write `id`, or `request` and `reply`")
            return
        with_node = request.node_step is not None or reply.node_step is not None
        if self.id is not None and (self.request or self.reply):
            text = "`id` is for both directions, but one has its own id"
            yield Problem(("id",), "address-id", text, "keep `id`, or `request` and `reply`")
        elif self.nodes is not None and not with_node:
            hint = f"write the id with `node`, for example 0x{request.base:X} + node, or omit `nodes`"
            yield Problem(("nodes",), "address-id", "no id depends on `node`, so `nodes` has no effect", hint)
        elif self.nodes is None and with_node:
            text = "the id depends on `node`, but `nodes` is missing"
            yield Problem((), "missing-key", text, "write, for example, nodes: 1..32")


@dataclass(frozen=True, eq=False, kw_only=True)
class ModeSpec(Description):
    """A mode of the bus; commands of different modes exclude each other."""

    called = "a mode of `bus`"
    example = {"bit_rates_kbps": [500, 1000]}

    bit_rates_kbps: Annotated[list[Annotated[int, Limits(ge=1, le=1000)]], Doc("Bit rates in kbit/s, at most 1000.")]
    default_kbps: Annotated[int | None, Doc("The bit rate of a new node, in kbit/s.")] = None


@dataclass(frozen=True, eq=False, kw_only=True)
class NeighbourSpec(Description):
    """Ids of this bus that are not of this protocol, such as those of similar products."""

    called = "a neighbour of `bus`"
    example = {"ids": "0x241..0x260", "title": "Another vendor's lamps"}

    ids: Annotated[
        Ids,
        Doc(
            "The ids: of 11 bits up to 0x7FF, of 29 bits above. Frames of this protocol are none of them.",
            examples=("0x241..0x260",),
        ),
    ]


@dataclass(frozen=True, eq=False, kw_only=True)
class BusSpec(Concept):
    """The settings that host and nodes have in common."""

    called = "`bus`"
    example = {"host": "Host", "dlc": 8}

    host: Annotated[
        str, Limits(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=48), Doc("Name of the host in DBC files.")
    ] = "Host"
    dlc: Annotated[
        int, Limits(ge=0, le=MAX_DATA_BYTES), Doc("Number of data bytes of a frame, unless a message has its own.")
    ] = 8
    frame_format: Annotated[
        FrameFormat,
        Doc(
            "Format of the frames that are sent: classic CAN, CAN FD, or CAN FD with bit rate switch. A CAN FD frame has 0 "
            "to 8, 12, 16, 20, 24, 32, 48 or 64 data bytes. A receiver of CAN FD also accepts classic frames."
        ),
    ] = FrameFormat.CLASSIC
    max_nodes: Annotated[int | None, Limits(ge=1), Doc("Maximum number of nodes on one bus.")] = None
    reply_within_ms: Annotated[Rational | None, Doc("Maximum time from request to reply.")] = None
    answers: Annotated[
        Literal["in_order"] | None,
        Doc(
            "`in_order` if a node answers requests in the order in which it receives them, as the manual states or an erratum "
            "assumes. After a missing reply, a client then sends a read, whose reply shows that no older one is on its way. "
            "Without this key, it waits."
        ),
    ] = None
    modes: Annotated[
        dict[Annotated[Name, Defines("mode")], ModeSpec], Doc("Modes of the bus; the first is the default.")
    ] = field(default_factory=dict)
    neighbours: Annotated[
        dict[Annotated[Name, Defines("neighbour")], NeighbourSpec],
        Doc("Other ids that users meet on such a bus, by name: `decode` and `identify` explain their frames."),
    ] = field(default_factory=dict)
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None


@dataclass(frozen=True, eq=False, kw_only=True)
class NumberRange(Concept):
    """The limits of a number parameter."""

    called = "`number`"
    example = {"min": 1, "max": 10}

    min: Annotated[Rational | None, Doc("Minimum value.")] = None
    max: Annotated[Rational | None, Doc("Maximum value.")] = None


Choice = Annotated[int | ValueName, Defines("value", of="parameter")]


@dataclass(frozen=True, eq=False, kw_only=True)
class ParameterSpec(Description):
    """A property of a node that is not in any frame: a choice among values, or a number."""

    called = "a parameter"
    example = {"values": ["A", "B"]}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": ["values"]}, {"required": ["number"]}]}

    values: Annotated[
        list[Choice] | dict[Annotated[ValueName, Defines("value", of="parameter")], Description] | None,
        Limits(min_length=1, max_length=256),
        Doc(
            "The values of a choice: a list of numbers or names, or names with titles.",
            examples=([14, 15, 18], ["A", "B"]),
        ),
    ] = None
    number: Annotated[NumberRange | None, Doc("A number, with its limits.")] = None

    def problems(self, name: str) -> Iterable[Problem]:
        if (self.values is None) == (self.number is None):
            both = self.values is not None
            text = f"`{name}` has both `values` and `number`" if both else f"`{name}` has neither `values` nor `number`"
            hint = "keep one" if both else "write values: [A, B] for a choice, or number: {} for a number"
            yield Problem((), "parameter-kind", text, hint)


@dataclass(frozen=True, eq=False, kw_only=True)
class SettingSpec(Description):
    """A limit that is set on the node, but not with this protocol."""

    example = {"title": "Limit of the current"}

    only: Only = None


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectSpec(Description):
    """A side effect of a command."""

    called = "an effect"
    example = {"title": "Moves", "level": "warning"}

    level: Annotated[Level, Doc("Severity of the effect: note, warning, or danger.")] = Level.NOTE
    consent: Annotated[
        Consent,
        Doc(
            "What a program has to allow before a client sends a command with this effect: `motion` if something moves or is "
            "free to move, `wear` if each time shortens the life of the node, `contact` if the node may then have another id, "
            "bus or bit rate."
        ),
    ] = Consent.NONE
    repeat: Annotated[
        Repeat,
        Doc(
            "What a request does that is sent again because no reply came: the `same`; or another thing, or that is unknown. In "
            "this case, a client `never` repeats a command with this effect."
        ),
    ] = Repeat.SAME
    kept: Annotated[
        Kept | None,
        Doc(
            "How long the node keeps what a command with this effect writes: `ram` until power-off, `rom` after it, too, `staged` "
            "until power-off unless another command saves it, whose effect is `saved`."
        ),
    ] = None


@dataclass(frozen=True, eq=False, kw_only=True)
class StateSpec(Description):
    """A state of a node, on which depends what commands do."""

    called = "a state"
    example = {"title": "Off", "entered_by": ["switch_off"], "prevents": ["moves"]}

    entered_by: Annotated[list[CommandName], Doc("Commands after which the node is in this state.")] = field(
        default_factory=list
    )
    prevents: Annotated[list[EffectName], Doc("Effects that commands do not have in this state.")] = field(
        default_factory=list
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class ErratumSpec(Concept):
    """An error or omission of the manual, and the correction in this spec."""

    called = "an erratum"
    example = {"id": "unit_of_power", "where": ["types.power"], "manual": "3", "printed": "…", "used": "…", "why": "…"}

    id: Annotated[Name, Doc("A name, unique in the edition.")]
    where: Annotated[
        list[Annotated[str, Ref("path")]],
        Limits(min_length=1),
        Doc("The affected parts of this file, as dotted paths."),
    ]
    manual: Annotated[Section, Doc("Section of the manual.")]
    printed: Annotated[EditionText, Doc("The statement of the manual.")]
    used: Annotated[EditionText, Doc("The statement of this spec.")]
    why: Annotated[EditionText, Doc("The reason for the difference.")]


@dataclass(frozen=True, eq=False, kw_only=True)
class EditionSpec(Description):
    """One exact protocol, identified by a label and a date."""

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
        "write golden frames into a separate file, EDITION.frames.yaml beside EDITION.yaml",
    )
    other_file = (
        "frames",
        "these are golden frames, not a spec",
        "name the spec beside this file; canwright loads both",
    )

    canwright: Annotated[Literal[1], Doc("Version of this language.")]
    family: Annotated[Name, Doc("The name of related protocols; prefix of generated names.")]
    edition: Annotated[EditionName, Doc("Label, with a date if the label is not unique.")]
    date: Annotated[
        str | None,
        Limits(pattern=DATE),
        Doc("Date of the manual: 2023-03 or 2023-03-21."),
    ] = None
    languages: Annotated[list[Language], Limits(min_length=1), Doc("Languages of every text.")] = field(
        default_factory=lambda: ["en"]
    )
    manual: Annotated[EditionText, Doc("Title of the manual.")] = field(default_factory=dict)
    byte_order: Annotated[Order, Doc("Order of bytes, unless a type has its own.")] = Order.LITTLE
    bus: Annotated[BusSpec, Doc("The settings that host and nodes have in common.")] = BusSpec()
    addresses: Annotated[
        dict[Annotated[Name, Defines("address")], AddressSpec],
        Limits(min_length=1, max_length=256),
        Doc("Addresses, by name; the first is the default."),
    ]
    selector: Annotated[Selector | None, Doc("The bits that identify a command.")] = None
    parameters: Annotated[
        dict[Annotated[Name, Defines("parameter")], ParameterSpec], Limits(max_length=256), Doc("Parameters, by name.")
    ] = field(default_factory=dict)
    settings: Annotated[dict[Annotated[Name, Defines("setting")], SettingSpec], Doc("Settings, by name.")] = field(
        default_factory=dict
    )
    effects: Annotated[dict[Annotated[Name, Defines("effect")], EffectSpec], Doc("Effects, by name.")] = field(
        default_factory=dict
    )
    states: Annotated[
        dict[Annotated[Name, Defines("state")], StateSpec], Doc("States, by name; the first is that after power-up.")
    ] = field(default_factory=dict)
    types: Annotated[dict[Annotated[Name, Defines("type")], TypeSpec], Doc("Types, by name.")] = field(
        default_factory=dict
    )
    layouts: Annotated[
        dict[Annotated[Name, Defines("layout")], LayoutSpec], Doc("Layouts shared by several messages, by name.")
    ] = field(default_factory=dict)
    tables: Annotated[dict[Annotated[Name, Defines("table")], TableSpec], Doc("Tables, by name.")] = field(
        default_factory=dict
    )
    commands: Annotated[
        dict[Annotated[Name, Defines("command")], CommandSpec], Limits(min_length=1), Doc("Commands, by name.")
    ]
    errata: Annotated[list[ErratumSpec], Doc("Errata, in the order of the manual.")] = field(default_factory=list)


JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(concept: type[Concept]) -> JsonSchema:
    """The JSON Schema of a file that contains `concept`."""
    definitions: dict[str, JsonSchema] = {}
    body = ConceptForm(concept).body(definitions)
    return {"$schema": JSON_SCHEMA_DIALECT, "$defs": dict(sorted(definitions.items())), **body}


def schema_text(concept: type[Concept]) -> str:
    """The JSON Schema as text, for editors and other tools."""
    return json.dumps(json_schema(concept), indent=2, ensure_ascii=False) + "\n"
