"""Frames in the language: fields, layouts, messages, tables and commands."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.layout import MAX_DATA_BYTES, ROLE_KEYS, NodeRole, Space
from ..model.message import Direction
from ..model.metadata import EndsMotion, Repeat
from ..model.sending import Occasion
from ..model.types import Order
from .checksum import ChecksumSpec
from .concept import Choose, Concept, Defines, Doc, JsonSchema, Limits, Problem, Ref, keys
from .notation import At
from .scalar_types import (
    BitsRun,
    Byte,
    CodeFormat,
    Counter,
    EditionText,
    Indices,
    ManualName,
    Name,
    Nodes,
    Only,
    ParameterName,
    Rational,
    Raw,
    Section,
    Start,
)
from .sending import sending_problems
from .types import Deprecated, Description, EffectName, RenamedFrom

AddressName = Annotated[Name, Ref("address")]
CommandName = Annotated[Name, Ref("command")]
SettingName = Annotated[Name, Ref("setting")]
NameInManual = Annotated[
    ManualName | None,
    Doc("Its name in the manual, if readers may search for it.", examples=("iqControl",)),
]


@dataclass(frozen=True, eq=False, kw_only=True)
class FieldSpec(Description):
    """A run of bits with a type."""

    called = "a field"
    example = {"at": 4, "raw": "u16"}
    schema_extra: ClassVar[JsonSchema] = {"oneOf": [{"required": [key]} for key in ("type", "raw", "entry")]}

    at: Annotated[
        Start | Annotated[list[BitsRun], Limits(min_length=2, max_length=MAX_DATA_BYTES)],
        Doc(
            "The start of the field: byte 4, bit 3 of byte 4 (4.3), or bit 5 of the id (id.5). In the data, a "
            "little-endian field starts at its least significant bit, which is bit 0 of a byte without a bit number. A "
            "big-endian field starts at its most significant bit, which is bit 7. In the id, every field starts at its "
            "least significant bit. A list has several runs of bits, in the order of the field: bytes 2 to 3 and bits 5 to "
            "7 of byte 4. The least significant run of a little-endian field is the first, of a big-endian field the last."
        ),
    ]
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None
    type: Annotated[Annotated[Name, Ref("type")] | None, Doc("A type of this edition.")] = None
    raw: Annotated[Raw | None, Doc("Format of a plain number, instead of a type.")] = None
    entry: Annotated[
        Annotated[Name, Ref("entry")] | None,
        Doc(
            "An entry of a table with one value, instead of a type: the field has the type, title, text and section of that "
            "value. For a value that is both read by index and sent in a frame of its own.",
            examples=("position_actual",),
        ),
    ] = None
    byte_order: Annotated[Order | None, Doc("Byte order of a plain number, if not that of the edition.")] = None
    array: Annotated[Indices | None, Doc("Indices of an array of adjacent elements.", examples=("1..4",))] = None
    only: Only = None
    constant: Annotated[
        int | ParameterName | None,
        Doc("The only valid raw value, or the number parameter that has it.", examples=(0x9E, "host_id")),
    ] = None
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
    checksum: Annotated[
        ChecksumSpec | None,
        Doc(
            "Computed by the sender from other bytes, and checked by the receiver. Users neither give nor get it.",
            examples=({"algorithm": "crc8_sae_j1850", "over": "0..6"},),
        ),
    ] = None
    counter: Annotated[
        Counter | None,
        Doc(
            "The sender increments the value with each frame, from the last one to the first. An encoder rejects other values.",
            examples=("0..14",),
        ),
    ] = None
    variable: Annotated[
        Name | None,
        Doc(
            "The variable of the node that a request writes with this field, or that a reply reads, if it has another name than "
            "the field. The fields of a table entry need none. A variable whose enum has all `states` is set by their commands."
        ),
    ] = None
    manual: Annotated[Section | None, Doc("Section of the manual, if not that of the command.")] = None
    manual_name: NameInManual = None

    def problems(self, name: str) -> Iterable[Problem]:
        given = [key for key in ("type", "raw", "entry") if getattr(self, key) is not None]
        if len(given) != 1:
            text = (
                f"`{name}` has both `{given[0]}` and `{given[1]}`"
                if given
                else f"`{name}` has neither `type` nor `raw`"
            )
            hint = "write, for example, raw: u8 for a plain number"
            hint = "keep `type` for a type, or `raw` for a plain number" if given else hint
            yield Problem((), "field-type", text, hint)
        if self.raw is None and given and self.byte_order is not None:
            hint = "move `byte_order` into the type, or write `raw` instead of `type`"
            yield Problem(("byte_order",), "field-type", f"the {given[0]} defines the byte order", hint, key=False)
        elif self.byte_order is not None and isinstance(self.at, At) and self.at.space is Space.ID:
            text = "`byte_order` has no effect on a field in the id"
            yield Problem(("byte_order",), "no-effect", text, "remove it; in the id, `at` is the least significant bit")
        excluded = "only" if self.only is not None else "array" if self.array is not None else ""
        if isinstance(self.constant, str) and excluded:
            hint = f"remove `{excluded}`, or write a field with a plain value"
            yield Problem(("constant",), "field-type", f"a constant that is a parameter cannot have `{excluded}`", hint)
        roles = [key for key in ROLE_KEYS if getattr(self, key) is not None]
        if len(roles) > 1:
            hint = "keep `constant` if receivers check the value, or `reserved` if they ignore it"
            if NodeRole.key in roles:
                hint = f"omit `{roles[0]}` if the value depends on the node; otherwise omit `holds`"
            text = f"`{name}` has both `{roles[0]}` and `{roles[1]}`"
            yield Problem((roles[1],), "field-type", text, hint)


Fields = Annotated[dict[Name, FieldSpec], Limits(max_length=1000)]


ENTRY = "entry"
"""The word for the layout of the table entry, instead of the name of a layout."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LayoutSpec(Description):
    """Fields with their bits, shared by several messages. Bits without a field are reserved."""

    called = "a layout"
    example = {"fields": {"level": {"at": 4, "raw": "u16"}}}

    fields: Annotated[Fields, Doc("The fields, by name.")]
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None


AlternativeReplies = Annotated[
    list[CommandName],
    Doc(
        "Commands whose reply a node can send instead of the reply, such as an error. Of an address: for each command with "
        "this address, a request and a reply.",
        examples=(["abort"],),
    ),
]

ERROR_REPLIES = ("error", "errors", "error_reply", "error_replies", "nack", "or_reply", "alternatives")
"""Words of other formats for `alternative_replies`."""


NO_SEGMENTS = "canwright does not describe segmented transfers; use can-isotp, can-j1939 or canopen for these messages"
SEGMENTED = {
    **dict.fromkeys(("isotp", "iso_tp", "tp", "transport", "transport_protocol"), NO_SEGMENTS),
    **dict.fromkeys(("segmented", "segments", "multi_frame", "multiframe", "multipacket", "multi_packet"), NO_SEGMENTS),
}
"""Words of other formats for transfers that are put together from several frames before they are decoded."""


Code = Byte | Annotated[dict[Name, Byte], Limits(min_length=1)]
"""A code, or one code for each kind of table entry."""


PERIODS = ("period", "period_ms", "cycle_ms", "cycle_time", "cycle_time_ms", "interval", "interval_ms")
"""Words of other formats for `every_ms`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MessageSpec(Concept):
    """A request or reply with more keys than its fields."""

    called = "a request or a reply"
    advice = {**dict.fromkeys(PERIODS, "write, for example, every_ms: 100"), **SEGMENTED}
    schema_extra: ClassVar[JsonSchema] = {"dependentSchemas": {"of": {"propertyNames": {"enum": ["of", "from_each"]}}}}

    layout: Annotated[
        Annotated[Name, Ref("layout", words=(ENTRY,))] | Fields | None,
        Doc("Fields, the name of a shared layout, or `entry` for the fields of the table entry."),
    ] = None
    fields: Annotated[Fields | None, Doc("Further fields, in addition to those of `layout`.")] = None
    of: Annotated[CommandName | None, Doc("The command with this reply.")] = None
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
    accept: Annotated[
        list[Byte] | None,
        Limits(max_length=256),
        Doc("Further codes that a receiver accepts. A decoded message keeps its code, with which it is encoded again."),
    ] = None
    address: Annotated[AddressName | None, Doc("Address, if not that of the command.")] = None
    dlc: Annotated[
        int | None,
        Limits(ge=0, le=MAX_DATA_BYTES),
        Doc(
            "Number of data bytes, if not that of the bus. A longer message is a segmented transfer, which is not described."
        ),
    ] = None
    remote: Annotated[bool | None, Doc("True for a remote frame, which has no data.")] = None
    frames: Annotated[
        dict[Name, Indices] | None,
        Limits(min_length=1, max_length=1),
        Doc(
            "The reply consists of several frames, in any order: the field with the number of each, and its first and last "
            "value. A node may send fewer.",
            examples=({"part": "1..3"},),
        ),
    ] = None
    every_ms: Annotated[
        Rational | None, Doc("Nominal period of a cyclic frame, in whole microseconds.", examples=(100, 2.5))
    ] = None
    timeout_ms: Annotated[
        Rational | None,
        Doc(
            "The receiver treats a silence of this length as a failure: a watchdog that the host has to feed, or a node "
            "that no longer sends. In whole microseconds.",
            examples=(500,),
        ),
    ] = None
    sent: Annotated[
        list[Occasion] | None,
        Limits(min_length=1, max_length=len(Occasion)),
        Doc(
            "When the frame is sent, if that does not follow from the other keys: a frame with `every_ms` is cyclic, and the "
            "reply to a request is sent on request. `on_request` without a request means that of another command.",
            examples=(["cyclic", "on_change"],),
        ),
    ] = None


def _message_kind(value: Mapping[str, object]) -> int:
    """0 for fields, 1 for a message with further keys."""
    names_fields = all(isinstance(inner, dict) and "at" in inner for inner in value.values())
    return int(bool(set(value) & set(keys(MessageSpec))) and not names_fields)


Request = Annotated[Annotated[Name, Ref("layout", words=(ENTRY, "none"))] | Fields | MessageSpec, Choose(_message_kind)]
Reply = Annotated[
    Annotated[Name, Ref("layout", words=(ENTRY, "echo", "none"))] | Fields | MessageSpec, Choose(_message_kind)
]


@dataclass(frozen=True, eq=False, kw_only=True)
class Selector(Concept):
    """The bits that identify a command or a table entry."""

    example = {"at": 0, "raw": "u8"}

    at: Annotated[Start, Doc("Start of the bits, in the data or in the id.")]
    raw: Annotated[CodeFormat, Doc("Format, usually u8.")]
    byte_order: Annotated[Order | None, Doc("Overrides the edition's byte order.")] = None


@dataclass(frozen=True, eq=False, kw_only=True)
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
    layout: Annotated[Annotated[Name, Ref("layout")] | Fields, Doc("Fields, or the name of a shared layout.")]
    renamed_from: RenamedFrom = None
    kind: Annotated[
        Name | None, Doc("Kind of entry, a name that you choose, if the codes of a command depend on it.")
    ] = None
    commands: Annotated[
        list[CommandName] | None,
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
    effects: Annotated[list[EffectName], Doc("Effects of writing this entry, in addition to those of the command.")] = (
        field(default_factory=list)
    )
    manual: Annotated[Section | None, Doc("Section of the manual, if not that of the command.")] = None


@dataclass(frozen=True, eq=False, kw_only=True)
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
    entries: Annotated[
        dict[Annotated[Name, Defines("entry")], EntrySpec], Limits(min_length=1), Doc("The entries, by name.")
    ]
    manual: Annotated[Section | None, Doc("Section of the manual.")] = None


@dataclass(frozen=True, eq=False, kw_only=True)
class CommandSpec(Description):
    """A code with its request and its reply."""

    called = "a command"
    example = {"code": "0x10", "reply": "none"}
    advice = {
        **dict.fromkeys(
            ("every_ms", "timeout_ms", "sent", *PERIODS),
            "state it of the frame: reply: {layout: NAME, every_ms: 100}, or the same in `request`",
        ),
        **dict.fromkeys(ERROR_REPLIES, "write alternative_replies: [COMMAND], the commands whose reply comes instead"),
        "replies": "write `reply` for one, then further_replies: [COMMAND] or alternative_replies: [COMMAND]",
        "frames": "state it of the reply: reply: {layout: NAME, frames: {FIELD: 1..3}}",
        **SEGMENTED,
    }
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
    address: Annotated[AddressName | None, Doc("Address, if not the first.")] = None
    mode: Annotated[Annotated[Name, Ref("mode")] | None, Doc("Bus mode, if not the first.")] = None
    table: Annotated[
        Annotated[Name, Ref("table")] | None,
        Doc("Table; the command then has one form for each entry, `COMMAND_ENTRY`."),
    ] = None
    manual: Annotated[Section | None, Doc("Section of the manual, in quotes.", examples=("2.10",))] = None
    manual_name: NameInManual = None
    only: Only = None
    reply_within_ms: Annotated[
        Rational | None, Doc("Maximum time from request to reply, if it is longer than that of the bus.")
    ] = None
    implemented: Annotated[bool, Doc("False if the manual states that it is not implemented.")] = True
    request: Annotated[
        Request | None,
        Doc(
            "Fields, the name of a shared layout, `entry` (the fields of the table entry), or `none` for a frame that "
            "nodes send without a request. Without this key, the request has no fields."
        ),
    ] = None
    reply: Annotated[
        Reply | None,
        Doc(
            "Fields, the name of a shared layout, `echo` (the reply repeats the request), `entry` (the fields of the "
            "table entry) or `none`."
        ),
    ] = None
    further_replies: Annotated[
        list[CommandName],
        Doc("Commands whose replies follow the reply, each in a frame of its own.", examples=(["cells_2", "cells_3"],)),
    ] = field(default_factory=list)
    alternative_replies: AlternativeReplies = field(default_factory=list)
    effects: Annotated[list[EffectName], Doc("Side effects; names of `effects`.")] = field(default_factory=list)
    repeat: Annotated[
        Repeat | None,
        Doc(
            "What a second request does, if that does not follow from the effects: the `same`, or `never` to be repeated."
        ),
    ] = None
    ends_motion: Annotated[
        EndsMotion | None,
        Doc(
            "`stop` if it stops a node, `switch_off` if the node is then without power. A client sends it, without consent, to "
            "the nodes that a program moved when the program ends. Its request has no values, and an address has one of each."
        ),
    ] = None
    limited_by: Annotated[list[SettingName], Doc("Settings that limit it.")] = field(default_factory=list)
    not_limited_by: Annotated[list[SettingName], Doc("Settings that do not limit it, contrary to expectation.")] = (
        field(default_factory=list)
    )
    notes: Annotated[list[EditionText], Doc("Further information for users.")] = field(default_factory=list)

    def problems(self, name: str) -> Iterable[Problem]:
        if self.reply is None:
            hint = "write fields, the name of a layout, `echo`, or `none`"
            yield Problem((), "missing-reply", f"`{name}` has no `reply`", hint)
        elif self.request == self.reply == "none":
            hint = "omit `request` if the request has only a code, or define the reply"
            text = f"`{name}` has neither a request nor a reply"
            yield Problem(("request",), "missing-reply", text, hint, key=False)
        elif self.request == "none" and self.reply == "echo":
            text = f"`{name}` has no request to repeat"
            yield Problem(("reply",), "echo-of-nothing", text, "define the reply, or write `none`", key=False)
        if isinstance(self.request, MessageSpec):
            yield from _without_effect("request", self.request, REPLY_KEYS | {"frames"}, "a request", "remove it")
        if isinstance(self.reply, MessageSpec) and self.reply.of is not None:
            hint = "remove it, or remove `of` and define the reply here"
            further = set(keys(MessageSpec)) - REPLY_KEYS
            yield from _without_effect("reply", self.reply, further, "the reply of another command", hint)
        for direction, message in ((Direction.REQUEST, self.request), (Direction.REPLY, self.reply)):
            if isinstance(message, MessageSpec) and message.of is None:
                answers = direction is Direction.REPLY and self.request != "none"
                yield from sending_problems(message, direction, answers=answers)
        if self.table is None:
            yield from self._entries_of_nothing(name)
        for key in FURTHER_REPLIES if "none" in (self.request, self.reply) else ():
            if getattr(self, key):
                hint = "write reply: {of: COMMAND}" if self.reply == "none" else "remove it"
                text = f"`{name}` has no {'reply' if self.reply == 'none' else 'request'}, so `{key}` has no effect"
                yield Problem((key,), "no-effect", text, hint)

    def _entries_of_nothing(self, name: str) -> Iterator[Problem]:
        """Findings about the keys that need the entry of a table."""
        if isinstance(self.code, dict):
            text = f"`{name}` has no table, so its code cannot depend on an entry"
            hint = "write one code, or add the `table` of the command"
            yield Problem(("code",), "entry-of-nothing", text, hint, key=False)
        for key, message in (("request", self.request), ("reply", self.reply)):
            layout = message.layout if isinstance(message, MessageSpec) else message
            if layout == ENTRY:
                text = f"`{name}` has no table, so `entry` is unknown"
                yield Problem((key,), "entry-of-nothing", text, "add the `table` of the command", key=False)
            if isinstance(message, MessageSpec) and isinstance(message.code, dict):
                text = f"`{name}` has no table, so its code cannot depend on an entry"
                hint = "write one code, or add the `table` of the command"
                yield Problem((key, "code"), "entry-of-nothing", text, hint, key=False)


REPLY_KEYS = frozenset(("of", "from_each"))
"""The only keys of a reply with `of`, which requests do not have."""
FURTHER_REPLIES = ("further_replies", "alternative_replies")
"""Keys of commands with the names of other commands, whose replies also answer the request."""


def _without_effect(
    key: str, written: MessageSpec, names: Collection[str], concept: str, hint: str
) -> Iterator[Problem]:
    for name in sorted(names):
        if getattr(written, name) is not None:
            yield Problem((key, name), "no-effect", f"`{name}` has no effect on {concept}", hint)
