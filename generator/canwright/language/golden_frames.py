"""Golden frames: bytes and the values they must mean, from a named source, and frames that must be refused.

They stand beside their edition, `v1.yaml` and `v1.frames.yaml`, and are written from manuals and public sources, never
by running this code.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Literal

from ..model.message import Direction
from ..model.refusal import Refusal
from . import notation
from .concept import Choose, Concept, Key, Limits, Notation
from .scalar_types import Name, Text


def _data(text: str) -> bytes:
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise ValueError(
            f"`{text}` is not data; write pairs of hex digits, for example A1 00 00 00 64 00 00 00"
        ) from None


Data = Annotated[
    bytes,
    Notation(
        _data,
        "data bytes in hex, in quotes: 'A1 00 64'",
        {"type": "string", "pattern": "^([0-9A-Fa-f]{2} ?)*$", "examples": ["A1 00 00 00 64 00 00 00"]},
    ),
]


def _value(value: str | int | Decimal) -> Fraction | str:
    """A number in its unit, `none` for no value, or the name of an enum member."""
    if isinstance(value, str) and not notation.NUMBER.match(value):
        return value
    return notation.rational(str(value).lower())


def _given(value: str | int | Decimal) -> int | str:
    if isinstance(value, bool):
        raise ValueError(f"`{str(value).lower()}` is neither a number nor the name of a value")
    return str(value) if isinstance(value, Decimal) else value


_SCALAR = {"anyOf": [{"type": "number"}, {"type": "string"}]}
Single = Annotated[Fraction | str, Notation(_value, "a number or a name here", _SCALAR, any_scalar=True)]
Value = list[Single] | Single
RawValue = list[int] | int
Given = Annotated[int | str, Notation(_given, "a number or a name here", _SCALAR, any_scalar=True)]


@dataclass(frozen=True, kw_only=True)
class Sourced(Concept):
    """What every entry says of itself."""

    source: Annotated[Name, Key("A name of `sources`.")]
    note: Annotated[str | None, Key("What a reader of this entry should know.")] = None
    parameters: Annotated[
        dict[Name, Given], Key("What is known of the node.", examples=({"model": "A", "size": 12.5},))
    ] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Frame(Sourced):
    """A frame of a command, one direction of it, and what it means.

    Decoding `data` from `id` gives exactly `node`, `raw` and `values`; encoding `raw`, and `values` where all of them
    are given, gives exactly `id` and `data`, unless `decode_only`.
    """

    request: Annotated[Name | None, Key("The command, when this is its request.")] = None
    reply: Annotated[Name | None, Key("The command, when this is its reply.")] = None
    id: Annotated[int, Limits(ge=0), Key("CAN id.")]
    extended: Annotated[bool, Key("True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Key("True for a remote frame.")] = False
    node: Annotated[int | None, Key("Node; left out when the address has none.")] = None
    data: Annotated[Data, Key("Data bytes in hex, byte 0 first; none in a remote frame.")]
    raw: Annotated[dict[Name, RawValue], Key("Every field and its raw integer.")] = field(default_factory=dict)
    values: Annotated[
        dict[Name, Value],
        Key(
            "Fields and their values in their unit, exact; an enum by name, flags as a list of names, "
            "`none` when there is no value to be had."
        ),
    ] = field(default_factory=dict)
    decode_only: Annotated[bool, Key("True when an encoder writes other bytes, for example 0 in reserved bits.")] = (
        False
    )

    @property
    def direction(self) -> Direction:
        return Direction.REQUEST if self.request else Direction.REPLY

    @property
    def command(self) -> str:
        return self.request or self.reply or ""


@dataclass(frozen=True, kw_only=True)
class RefusedFrame(Sourced):
    """A frame that no target may decode, and why."""

    decode: Annotated[Direction, Key("The direction it is read in.")]
    id: Annotated[int, Limits(ge=0), Key("CAN id.")]
    extended: Annotated[bool, Key("True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Key("True for a remote frame.")] = False
    data: Annotated[Data, Key("Data bytes in hex, byte 0 first.")]
    says: Annotated[Refusal, Key("Why it is refused.")]


@dataclass(frozen=True, kw_only=True)
class RefusedValues(Sourced):
    """Values that no target may encode, and why."""

    encode: Annotated[Direction, Key("Which message of the command.")]
    command: Annotated[Name, Key("The command.")]
    node: Annotated[int | None, Key("Node; left out when the address has none.")] = None
    raw: Annotated[dict[Name, RawValue], Key("Fields and raw integers.")] = field(default_factory=dict)
    values: Annotated[dict[Name, Value], Key("Fields and values; `nan`, `inf` and `-inf` are numbers.")] = field(
        default_factory=dict
    )
    says: Annotated[Refusal, Key("Why it is refused.")]
    field: Annotated[Name | None, Key("The field that is to be named.")] = None


@dataclass(frozen=True, kw_only=True)
class CheckedFrame(Concept):
    """One frame of an exchange."""

    id: Annotated[int, Limits(ge=0), Key("CAN id.")]
    extended: Annotated[bool, Key("True when the id is a 29-bit one.")] = False
    remote: Annotated[bool, Key("True for a remote frame.")] = False
    data: Annotated[Data, Key("Data bytes in hex, byte 0 first.")]


@dataclass(frozen=True, kw_only=True)
class Exchange(Sourced):
    """A request and a frame that came after it: its answer, or why not."""

    request: Annotated[CheckedFrame, Key("What the host sent.")]
    reply: Annotated[CheckedFrame, Key("What came back.")]
    says: Annotated[Refusal | None, Key("Left out when the reply answers the request.")] = None


def _refused_kind(value: Mapping[str, object]) -> int:
    """0 for a frame, 1 for values."""
    return int("encode" in value or not {"decode", "id", "data"} & set(value))


Refused = Annotated[RefusedFrame | RefusedValues, Choose(_refused_kind)]


@dataclass(frozen=True, kw_only=True)
class GoldenFrames(Concept):
    """The golden frames of one edition."""

    example = {"canwright": 1, "family": "lamp", "edition": "v1", "sources": {}, "frames": []}
    other = (
        "commands",
        "this is a spec, not its golden frames",
        "golden frames stand in a file of their own, EDITION.frames.yaml beside EDITION.yaml",
    )

    canwright: Annotated[Literal[1], Key("Version of this language.")]
    family: Annotated[Name, Key("Family of the edition.")]
    edition: Annotated[str, Key("Name of the edition.")]
    sources: Annotated[
        dict[Name, Text],
        Key("Where frames come from, by name.", examples=({"manual": "Examples of the manual."},)),
    ]
    frames: Annotated[list[Frame], Key("Frames and what they mean.")]
    refused: Annotated[list[Refused], Key("Frames and values that must be refused.")] = field(default_factory=list)
    exchanges: Annotated[list[Exchange], Key("Requests with what came after them.")] = field(default_factory=list)

    @cached_property
    def of_command(self) -> dict[tuple[str, Direction], list[Frame]]:
        """The frames of each direction of a command."""
        found: dict[tuple[str, Direction], list[Frame]] = {}
        for frame in self.frames:
            found.setdefault((frame.command, frame.direction), []).append(frame)
        return found
