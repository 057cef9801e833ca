"""The part of the language that knows no frame: concepts, and types of raw bits."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from ..model.types import Order
from .concept import Concept, JsonSchema, Key, Limits
from .scalar_types import Multiple, Name, Raw, Span, Text


@dataclass(frozen=True, kw_only=True)
class Titled(Concept):
    """What people read of a concept."""

    title: Annotated[Text | None, Key("A few words, as a heading.")] = None
    about: Annotated[Text | None, Key("A sentence or two for whoever uses it.")] = None


CaseMultiple = Literal["none"] | Multiple
CaseSpan = Literal["none"] | Span


@dataclass(frozen=True, kw_only=True)
class ScaleBy(Concept):
    """A scale for each value of a choice parameter; `none` where the manual gives none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[Name, Key("The parameter that decides.")]
    by_value: dict[str, CaseMultiple]


@dataclass(frozen=True, kw_only=True)
class OffsetBy(Concept):
    """An offset for each value of a choice parameter; `none` where the manual gives none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[Name, Key("The parameter that decides.")]
    by_value: dict[str, CaseMultiple]


@dataclass(frozen=True, kw_only=True)
class RangeBy(Concept):
    """A range for each value of a choice parameter; `none` where the manual gives none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[Name, Key("The parameter that decides.")]
    by_value: dict[str, CaseSpan]


Scale = Literal["none"] | Multiple | ScaleBy
OffsetChoice = Multiple | OffsetBy
SpanChoice = Span | RangeBy


@dataclass(frozen=True, kw_only=True)
class Member(Titled):
    """A name for one raw value."""

    value: Annotated[int, Key("The raw value that has this name.")]


BitNumber = Annotated[int, Limits(ge=0, le=63)]


@dataclass(frozen=True, kw_only=True)
class Flag(Titled):
    """A name for one bit."""

    bit: Annotated[BitNumber, Key("The bit, 0 is the least significant.")]


Value = int | Member
Bit = BitNumber | Flag


@dataclass(frozen=True, kw_only=True)
class Type(Titled):
    """How raw bits become a value."""

    called = "a type"
    example = {"raw": "u16", "unit": "V", "scale": "0.1"}
    schema_extra: ClassVar[JsonSchema] = {"not": {"required": ["range", "raw_range"]}}

    raw: Annotated[Raw, Key("Sign and width: u8, i16, i56 (1 to 64 bits), or f32, f64.")]
    byte_order: Annotated[Order | None, Key("Overrides the edition's byte order.")] = None
    unit: Annotated[str | None, Key("A unit of units.yaml; left out for a bare number.")] = None
    scale: Annotated[
        Scale | None,
        Key(
            "value = raw * scale + offset. As printed: 0.01, 1/64, 16.5/2048; `none` if none is known. A "
            "multiple of a number parameter, as 2/65535*size, makes offset and range multiples of the same one."
        ),
    ] = None
    offset: Annotated[OffsetChoice | None, Key("Added after scaling, in the unit: -40, or -size.")] = None
    raw_range: Annotated[SpanChoice | None, Key("Allowed raw integers, when the manual says so.")] = None
    range: Annotated[SpanChoice | None, Key("Allowed values in the unit, when the manual says so.")] = None
    plausible: Annotated[
        Span | None,
        Key(
            "Values in the unit that a working node reports. `canwright identify` reasons from it; nothing is "
            "refused for it.",
            examples=("6..100",),
        ),
    ] = None
    enum: Annotated[
        Annotated[dict[Name, Value], Limits(min_length=1)] | None,
        Key(
            "The raw values that have a name: the value, or a mapping where there is a title to it.",
            examples=(
                {"idle": 0, "running": 1},
                {"idle": {"value": 0, "title": "Waits"}},
            ),
        ),
    ] = None
    flags: Annotated[
        Annotated[dict[Name, Bit], Limits(min_length=1)] | None,
        Key(
            "The bits that have a name, 0 is the least significant: the bit, or a mapping with a title.",
            examples=(
                {"hot": 0, "stuck": 7},
                {"hot": {"bit": 0, "title": "Too hot"}},
            ),
        ),
    ] = None
    differs: Annotated[Text | None, Key("Why this scale or unit is another one than that of its like.")] = None
