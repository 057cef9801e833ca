"""The part of the language that knows no frame: concepts, and types of raw bits."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from ..model.types import Order
from .scalar_types import Multiple, Name, Raw, Span, Text, is_map


class Concept(BaseModel):
    """What all concepts share: no unknown keys, nothing changes once it is read.

    `stand_ins` are read in place of keys that it needs and that could not be read, so that the rest is; `mistaken` is a
    key of the file that this one may be mistaken for, and what is told then.
    """

    stand_ins: ClassVar[dict[str, object]] = {}
    mistaken: ClassVar[tuple[str, str, str]] = ("", "", "")

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True, strict=True, defer_build=True)


class Titled(Concept):
    """What people read of a concept."""

    title: Annotated[Text | None, Field(description="A few words, as a heading.")] = None
    about: Annotated[Text | None, Field(description="A sentence or two for whoever uses it.")] = None


def _none_or_plain(value: object) -> str:
    return "none" if value == "none" else "plain"


CaseMultiple = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Multiple, Tag("plain")], Discriminator(_none_or_plain)
]
CaseSpan = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Span, Tag("plain")], Discriminator(_none_or_plain)
]


class _By(Concept):
    """What there is for each value of a choice parameter."""

    model_config = ConfigDict(extra="allow")

    @model_validator(mode="before")
    @classmethod
    def _names_its_parameter(cls, written: Any) -> Any:
        if isinstance(written, dict) and "by" not in written:
            raise PydanticCustomError("by_missing", "`by` is missing here")
        return written


class ScaleBy(_By):
    """A scale for each value of a choice parameter; `none` where the manual gives none."""

    __pydantic_extra__: dict[str, CaseMultiple]
    by: Annotated[Name, Field(description="The parameter that decides.")]


class OffsetBy(_By):
    """An offset for each value of a choice parameter; `none` where the manual gives none."""

    __pydantic_extra__: dict[str, CaseMultiple]
    by: Annotated[Name, Field(description="The parameter that decides.")]


class RangeBy(_By):
    """A range for each value of a choice parameter; `none` where the manual gives none."""

    __pydantic_extra__: dict[str, CaseSpan]
    by: Annotated[Name, Field(description="The parameter that decides.")]


Scale = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Multiple, Tag("plain")] | Annotated[ScaleBy, Tag("map")],
    Discriminator(lambda value: "none" if value == "none" else is_map(value)),
]
OffsetChoice = Annotated[Annotated[Multiple, Tag("plain")] | Annotated[OffsetBy, Tag("map")], Discriminator(is_map)]
SpanChoice = Annotated[Annotated[Span, Tag("plain")] | Annotated[RangeBy, Tag("map")], Discriminator(is_map)]


class Member(Titled):
    """A name for one raw value."""

    value: Annotated[int, Field(description="The raw value that has this name.")]


BitNumber = Annotated[int, Field(ge=0, le=63)]


class Flag(Titled):
    """A name for one bit."""

    bit: Annotated[BitNumber, Field(description="The bit, 0 is the least significant.")]


def _names_first(written: Any) -> Any:
    """Refuses `{0: idle}` at once, and not each of its keys and values."""
    entries = written.items() if isinstance(written, dict) else ()
    if entries and all(str(key).isdigit() and isinstance(value, str) for key, value in entries):
        raise PydanticCustomError("names_first", "the names come first here, and what they stand for behind them")
    return written


Value = Annotated[Annotated[int, Tag("plain")] | Annotated[Member, Tag("map")], Discriminator(is_map)]
Bit = Annotated[Annotated[BitNumber, Tag("plain")] | Annotated[Flag, Tag("map")], Discriminator(is_map)]


class Type(Titled):
    """How raw bits become a value."""

    stand_ins: ClassVar[dict[str, object]] = {"raw": "i64"}
    model_config = ConfigDict(json_schema_extra={"not": {"required": ["range", "raw_range"]}})

    raw: Annotated[Raw, Field(description="Sign and width: u8, i16, i56 (1 to 64 bits), or f32, f64.")]
    byte_order: Annotated[Order | None, Field(description="Overrides the edition's byte order.", strict=False)] = None
    unit: Annotated[str | None, Field(description="A unit of units.yaml; left out for a bare number.")] = None
    scale: Annotated[
        Scale | None,
        Field(
            description="value = raw * scale + offset. As printed: 0.01, 1/64, 16.5/2048; `none` if none is known. A "
            "multiple of a number parameter, as 2/65535*size, makes offset and range multiples of the same one."
        ),
    ] = None
    offset: Annotated[OffsetChoice | None, Field(description="Added after scaling, in the unit: -40, or -size.")] = None
    raw_range: Annotated[SpanChoice | None, Field(description="Allowed raw integers, when the manual says so.")] = None
    range: Annotated[SpanChoice | None, Field(description="Allowed values in the unit, when the manual says so.")] = (
        None
    )
    plausible: Annotated[
        Span | None,
        Field(
            description="Values in the unit that a working node reports. `canwright identify` reasons from it; nothing is "
            "refused for it.",
            examples=["6..100"],
        ),
    ] = None
    enum: Annotated[
        Annotated[dict[Name, Value], Field(min_length=1)] | None,
        BeforeValidator(_names_first),
        Field(
            description="The raw values that have a name: the value, or a mapping where there is a title to it.",
            examples=[{"idle": 0, "running": 1}, {"idle": {"value": 0, "title": "Waits"}}],
        ),
    ] = None
    flags: Annotated[
        Annotated[dict[Name, Bit], Field(min_length=1)] | None,
        BeforeValidator(_names_first),
        Field(
            description="The bits that have a name, 0 is the least significant: the bit, or a mapping with a title.",
            examples=[{"hot": 0, "stuck": 7}, {"hot": {"bit": 0, "title": "Too hot"}}],
        ),
    ] = None
    differs: Annotated[
        Text | None, Field(description="Why this scale or unit is another one than that of its like.")
    ] = None
