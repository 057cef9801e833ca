"""Types of the language: conversions of raw bits to values."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from ..model.joined import JoinedText
from ..model.types import Encoding, Order
from .concept import Concept, Doc, JsonSchema, Limits, Problem, Ref
from .scalar_types import EditionName, EditionText, Multiple, Name, ParameterName, Raw, RawIntegers, Span


@dataclass(frozen=True, eq=False, kw_only=True)
class Description(Concept):
    """A title and a text."""

    title: Annotated[EditionText, Doc("A few words, used as a heading.")] = field(default_factory=dict)
    about: Annotated[EditionText, Doc("One or two sentences for users.")] = field(default_factory=dict)


EffectName = Annotated[Name, Ref("effect")]

RenamedFrom = Annotated[
    Name | None,
    Doc(
        "Name in previous editions, for `canwright diff`: the meaning is the same. Otherwise, an item with another name "
        "and another title, unit or type in the same place has another meaning."
    ),
]


@dataclass(frozen=True, eq=False, kw_only=True)
class DeprecatedSpec(Concept):
    """Since when an item is deprecated, and until when it remains. Texts can name the replacement."""

    called = "`deprecated`"
    example = {"since": "v2.36"}

    since: Annotated[EditionName, Doc("The first edition, or its label, in which it is deprecated.")]
    until: Annotated[
        EditionName | None,
        Doc(
            "The first edition, or its date, that may lack it. `canwright diff` reports an earlier removal as a change that "
            "breaks programs, and a later one as announced. Without this key, any later edition may lack it.",
            examples=("v3", "2027-03"),
        ),
    ] = None


Deprecated = Annotated[
    DeprecatedSpec | None,
    Doc("Since when this is deprecated, and until when it remains.", examples=({"since": "v2.36", "until": "v3"},)),
]


ParameterValueName = Annotated[str, Ref("value", of="parameter")]
CaseMultiple = Literal["none"] | Multiple
CaseSpan = Literal["none"] | Span


@dataclass(frozen=True, eq=False, kw_only=True)
class ScaleBy(Concept):
    """A scale for each value of a choice parameter; `none` if the manual states none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[ParameterName, Doc("The parameter; its values are the other keys.")]
    by_value: dict[ParameterValueName, CaseMultiple]


@dataclass(frozen=True, eq=False, kw_only=True)
class OffsetBy(Concept):
    """An offset for each value of a choice parameter; `none` if the manual states none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[ParameterName, Doc("The parameter; its values are the other keys.")]
    by_value: dict[ParameterValueName, CaseMultiple]


@dataclass(frozen=True, eq=False, kw_only=True)
class RangeBy(Concept):
    """A range for each value of a choice parameter; `none` if the manual states none."""

    cases: ClassVar[str] = "by_value"

    by: Annotated[ParameterName, Doc("The parameter; its values are the other keys.")]
    by_value: dict[ParameterValueName, CaseSpan]


Scale = Literal["none"] | Multiple | ScaleBy
OffsetChoice = Multiple | OffsetBy
SpanChoice = Span | RangeBy


@dataclass(frozen=True, eq=False, kw_only=True)
class NameSpec(Description):
    """A name for one raw value."""

    value: Annotated[int, Doc("The raw value with this name.")]
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None


@dataclass(frozen=True, eq=False, kw_only=True)
class MemberSpec(NameSpec):
    """A name for one raw value of an enum."""

    without_effects: Annotated[
        list[EffectName], Doc("Effects that a command does not have if its request contains this value.")
    ] = field(default_factory=list)


BitNumber = Annotated[int, Limits(ge=0, le=63)]


@dataclass(frozen=True, eq=False, kw_only=True)
class FlagSpec(Description):
    """A name for one bit."""

    bit: Annotated[BitNumber, Doc("The bit; 0 is the least significant one.")]
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None


@dataclass(frozen=True, eq=False, kw_only=True)
class NoValueSpec(Description):
    """A name for raw integers that are not a number."""

    raw: Annotated[RawIntegers, Doc("The raw integer, the range of raw integers, or `nan` of a float.")]
    renamed_from: RenamedFrom = None
    deprecated: Deprecated = None


NamedValue = int | MemberSpec
NamedBit = BitNumber | FlagSpec
NamedRaws = RawIntegers | NoValueSpec
NamedNumber = int | NameSpec


NO_VALUE_WORDS = ("not_available", "unavailable", "error", "invalid", "undefined", "special", "special_values")
"""Words of manuals and of other formats for `no_value`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TypeSpec(Description):
    """A conversion of raw bits to a value."""

    called = "a type"
    example = {"raw": "u16", "unit": "V", "scale": "0.1"}
    advice = dict.fromkeys(NO_VALUE_WORDS, "write, for example, no_value: {not_available: 0xFF}")
    schema_extra: ClassVar[JsonSchema] = {"not": {"required": ["range", "raw_range"]}}

    raw: Annotated[
        Raw,
        Doc(
            "Sign and width: u8, i16, i56 (1 to 64 bits), or f32, f64; or a text of 8 bytes: ascii8, utf8_8; or a number of 4 "
            "decimal digits: bcd4."
        ),
    ]
    padding: Annotated[
        int | None,
        Limits(ge=0, le=255),
        Doc(
            "The byte after the end of a text, 0 without this key. A text ends before the first 0, or before padding at its end."
        ),
    ] = None
    byte_order: Annotated[Order | None, Doc("Overrides the edition's byte order.")] = None
    unit: Annotated[Annotated[str, Ref("unit")] | None, Doc("A unit of units.yaml; omitted for a plain number.")] = None
    scale: Annotated[
        Scale | None,
        Doc(
            "value = raw * scale + offset. A number as printed (0.01, 1/64, 16.5/2048, 2*pi/65536), or `none` if it is unknown. "
            "If it is a multiple of a number parameter (2/65535*size), offset and range are multiples of it, too."
        ),
    ] = None
    offset: Annotated[OffsetChoice | None, Doc("Added after scaling, in the unit: -40, or -size.")] = None
    raw_range: Annotated[SpanChoice | None, Doc("Valid raw integers, if the manual states them.")] = None
    range: Annotated[SpanChoice | None, Doc("Valid values in the unit, if the manual states them.")] = None
    plausible: Annotated[
        Span | None,
        Doc(
            "Values in the unit that a working node is assumed to report. It is an assumption, unlike `range`, which "
            "the manual states. `canwright identify` and `canwright decode` use it; no frame is rejected because of it.",
            examples=("6..100",),
        ),
    ] = None
    enum: Annotated[
        Annotated[dict[Name, NamedValue], Limits(min_length=1)] | None,
        Doc(
            "Named raw values: the value, or a mapping with a title.",
            examples=(
                {"idle": 0, "running": 1},
                {"idle": {"value": 0, "title": "Waits"}},
            ),
        ),
    ] = None
    flags: Annotated[
        Annotated[dict[Name, NamedBit], Limits(min_length=1)] | None,
        Doc(
            "Named bits, 0 is the least significant one: the bit, or a mapping with a title.",
            examples=(
                {"hot": 0, "stuck": 7},
                {"hot": {"bit": 0, "title": "Too hot"}},
            ),
        ),
    ] = None
    no_value: Annotated[
        Annotated[dict[Name, NamedRaws], Limits(min_length=1)] | None,
        Doc(
            "Named raw integers of a number that mean that there is no value: a raw integer, a range, or a mapping with a "
            "title; of a float, `nan`. Ranges do not apply to them. Without a name, an encoder writes the last raw integer of the first one.",
            examples=(
                {"not_available": 0xFF, "error": 0xFE},
                {"not_available": "0xFF00..0xFFFF"},
                {"invalid": {"raw": -32768, "title": "Not calibrated"}},
                {"not_available": "nan"},
            ),
        ),
    ] = None
    names: Annotated[
        Annotated[dict[Name, NamedNumber], Limits(min_length=1)] | None,
        Doc(
            "Names for some raw integers of a number, shown beside the value: the raw integer, or a mapping with a title. "
            "Each is within the range.",
            examples=(
                {"stopped": 0, "maximum": 1000},
                {"maximum": {"value": 1000, "title": "Full power"}},
            ),
        ),
    ] = None
    differs: Annotated[EditionText, Doc("The reason why this scale or unit differs from that of similar types.")] = (
        field(default_factory=dict)
    )

    def problems(self, name: str) -> Iterable[Problem]:
        joined = self.raw.joined
        for key in (
            ("unit", "scale", "offset", "range", "raw_range", "plausible", "enum", "flags", "names") if joined else ()
        ):
            if getattr(self, key) is not None:
                what = "a text" if isinstance(joined, JoinedText) else "a number of decimal digits"
                yield Problem((key,), "no-effect", f"{what} has no `{key}`", "remove it")
        if self.padding is not None and not isinstance(joined, JoinedText):
            yield Problem(("padding",), "no-effect", "only a text has `padding`", "remove it")
        if self.raw_range is not None and self.range is not None:
            yield Problem(("range",), "two-ranges", "there are both `range` and `raw_range`", "keep one", key=False)
        if self.raw_range is not None and self.raw[0] is Encoding.FLOAT:
            text = "`raw_range` is in raw integers, but this is a float"
            yield Problem(("raw_range",), "two-ranges", text, "write `range`")
        if self.names is not None and self.raw[0] is Encoding.FLOAT:
            text = "`names` are for raw integers, but this type is a float"
            yield Problem(("names",), "no-effect", text, "remove it, or write u or i in `raw`")
        yield from self._no_value_problems()
        if self.scale != "none":
            return
        for key in ("offset", "plausible"):
            if getattr(self, key) is not None:
                text = f"`{key}` is in the unit, but there is no scale"
                yield Problem((key,), "two-ranges", text, "remove it, or write a scale")
        if self.range is not None:
            text = "`range` is in the unit, but there is no scale"
            yield Problem(("range",), "two-ranges", text, "write `raw_range` in raw integers")

    def _no_value_problems(self) -> Iterable[Problem]:
        """Of floats, `no_value` names NaN; of all other types, raw integers."""
        is_float = self.raw[0] is Encoding.FLOAT
        for name, written in (self.no_value or {}).items():
            is_nan = (written.raw if isinstance(written, NoValueSpec) else written) == "nan"
            if is_float and not is_nan:
                text = "this type is a float, of which only NaN can have a name"
                yield Problem(("no_value", name), "value", text, f"write {name}: nan, or u or i in `raw`", key=False)
            elif is_nan and not is_float:
                text = "only a float has NaN, but this type has integers"
                yield Problem(("no_value", name), "value", text, "write the raw integer, or f32 in `raw`", key=False)
