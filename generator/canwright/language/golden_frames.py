"""Golden frames: bytes and the values they must mean, from a named source, and frames that must be refused.

They stand beside their edition, `v1.yaml` and `v1.frames.yaml`, and are written from manuals and public sources, never
by running this code.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema

from ..model.message import Direction
from ..model.refusal import Refusal
from . import notation
from .edition import Concept, Name, Text


def _data(value: object) -> bytes:
    if not isinstance(value, (str, int)) or isinstance(value, bool):
        raise ValueError("expected data bytes in hex, in quotes: 'A1 00 64'")
    try:
        return bytes.fromhex(str(value))
    except ValueError:
        raise ValueError(
            f"`{value}` is not data; write pairs of hex digits, for example A1 00 00 00 64 00 00 00"
        ) from None


Data = Annotated[
    bytes,
    BeforeValidator(_data),
    WithJsonSchema({"type": "string", "pattern": "^([0-9A-Fa-f]{2} ?)*$", "examples": ["A1 00 00 00 64 00 00 00"]}),
]


def _special(value: object) -> str:
    return "special" if value in ("nan", "inf", "-inf") else "list" if isinstance(value, list) else "name_or_number"


def _value(value: object) -> object:
    """A number in its unit, `none` for no value, or the name of an enum member."""
    if isinstance(value, str) and not notation.NUMBER.match(value):
        return value
    return notation.rational(str(value).lower() if isinstance(value, bool) else str(value))


Single = Annotated[
    Fraction | str,
    BeforeValidator(_value),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]}),
]
Value = Annotated[
    Annotated[Literal["nan", "inf", "-inf"], Tag("special")]
    | Annotated[list[Single], Tag("list")]
    | Annotated[Single, Tag("name_or_number")],
    Discriminator(_special),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}, {"type": "array"}]}),
]
RawValue = Annotated[
    Annotated[list[int], Tag("list")] | Annotated[int, Tag("plain")],
    Discriminator(lambda value: "list" if isinstance(value, list) else "plain"),
]
Given = Annotated[
    Annotated[int, Tag("number")] | Annotated[str, Tag("name")],
    Discriminator(lambda value: "number" if isinstance(value, int) else "name"),
    BeforeValidator(lambda value: str(value) if isinstance(value, Decimal) else value),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]}),
]


class Sourced(Concept):
    """What every entry says of itself."""

    source: Annotated[Name, Field(description="A name of `sources`.")]
    note: Annotated[str | None, Field(description="What a reader of this entry should know.")] = None
    parameters: Annotated[
        dict[Name, Given], Field(description="What is known of the node.", examples=[{"model": "A", "size": 12.5}])
    ] = {}


class Frame(Sourced):
    """A frame of a command, one direction of it, and what it means.

    Decoding `data` from `id` gives exactly `node`, `raw` and `values`; encoding `raw`, and `values` where all of them
    are given, gives exactly `id` and `data`, unless `decode_only`.
    """

    request: Annotated[Name | None, Field(description="The command, when this is its request.")] = None
    reply: Annotated[Name | None, Field(description="The command, when this is its reply.")] = None
    id: Annotated[int, Field(ge=0, description="CAN id.")]
    extended: Annotated[bool, Field(description="True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Field(description="True for a remote frame.")] = False
    node: Annotated[int | None, Field(description="Node; left out when the address has none.")] = None
    data: Annotated[Data, Field(description="Data bytes in hex, byte 0 first; none in a remote frame.")]
    raw: Annotated[dict[Name, RawValue], Field(description="Every field and its raw integer.")] = {}
    values: Annotated[
        dict[Name, Value],
        Field(
            description="Fields and their values in their unit, exact; an enum by name, flags as a list of names, "
            "`none` when there is no value to be had."
        ),
    ] = {}
    decode_only: Annotated[
        bool, Field(description="True when an encoder writes other bytes, for example 0 in reserved bits.")
    ] = False

    @property
    def direction(self) -> Direction:
        return Direction.REQUEST if self.request else Direction.REPLY

    @property
    def command(self) -> str:
        return self.request or self.reply or ""


class RefusedFrame(Sourced):
    """A frame that no target may decode, and why."""

    decode: Annotated[Direction, Field(description="The direction it is read in.", strict=False)]
    id: Annotated[int, Field(ge=0, description="CAN id.")]
    extended: Annotated[bool, Field(description="True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Field(description="True for a remote frame.")] = False
    data: Annotated[Data, Field(description="Data bytes in hex, byte 0 first.")]
    says: Annotated[Refusal, Field(description="Why it is refused.", strict=False)]


class RefusedValues(Sourced):
    """Values that no target may encode, and why."""

    encode: Annotated[Direction, Field(description="Which message of the command.", strict=False)]
    command: Annotated[Name, Field(description="The command.")]
    node: Annotated[int | None, Field(description="Node; left out when the address has none.")] = None
    raw: Annotated[dict[Name, RawValue], Field(description="Fields and raw integers.")] = {}
    values: Annotated[
        dict[Name, Value], Field(description="Fields and values; `nan`, `inf` and `-inf` are numbers.")
    ] = {}
    says: Annotated[Refusal, Field(description="Why it is refused.", strict=False)]
    field: Annotated[Name | None, Field(description="The field that is to be named.")] = None


class CheckedFrame(Concept):
    """One frame of an exchange."""

    id: Annotated[int, Field(ge=0, description="CAN id.")]
    extended: Annotated[bool, Field(description="True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Field(description="True for a remote frame.")] = False
    data: Annotated[Data, Field(description="Data bytes in hex, byte 0 first.")]


class Exchange(Sourced):
    """A request and a frame that came after it: its answer, or why not."""

    request: Annotated[CheckedFrame, Field(description="What the host sent.")]
    reply: Annotated[CheckedFrame, Field(description="What came back.")]
    says: Annotated[Refusal | None, Field(description="Left out when the reply answers the request.", strict=False)] = (
        None
    )


def _refused_kind(value: object) -> str:
    if not isinstance(value, dict) or "encode" in value:
        return "values entry"
    return "frame entry" if {"decode", "id", "data"} & set(value) else "values entry"


TAGS = frozenset({"frame entry", "values entry"})
"""Steps of a location that only say which form an entry has."""
Refused = Annotated[
    Annotated[RefusedFrame, Tag("frame entry")] | Annotated[RefusedValues, Tag("values entry")],
    Discriminator(_refused_kind),
]


class GoldenFrames(Concept):
    """The golden frames of one edition."""

    mistaken: ClassVar[tuple[str, str, str]] = (
        "commands",
        "this is a spec, not its golden frames",
        "golden frames stand in a file of their own, EDITION.frames.yaml beside EDITION.yaml",
    )

    canwright: Annotated[Literal[1], Field(description="Version of this language.")]
    family: Annotated[Name, Field(description="Family of the edition.")]
    edition: Annotated[str, Field(description="Name of the edition.")]
    sources: Annotated[
        dict[Name, Text],
        Field(description="Where frames come from, by name.", examples=[{"manual": "Examples of the manual."}]),
    ]
    frames: Annotated[list[Frame], Field(description="Frames and what they mean.")]
    refused: Annotated[list[Refused], Field(description="Frames and values that must be refused.")] = []
    exchanges: Annotated[list[Exchange], Field(description="Requests with what came after them.")] = []

    @cached_property
    def of_command(self) -> dict[tuple[str, Direction], list[Frame]]:
        """The frames of each direction of a command."""
        found: dict[tuple[str, Direction], list[Frame]] = {}
        for frame in self.frames:
            found.setdefault((frame.command, frame.direction), []).append(frame)
        return found
