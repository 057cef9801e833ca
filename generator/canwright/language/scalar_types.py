"""Types of scalars: names, texts, and notations with their JSON Schemas."""

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Annotated, Any, Literal

from ..model.checksum import ConstantBytes, DataBytes
from ..model.types import Range, factors
from . import notation
from .concept import Doc, JsonSchema, Limits, Notation, Ref, Translated
from .notation import At, IdExpression
from .suggestions import VISIBLE


def _written(
    parse: Callable[[str], Any],
    example: str,
    schema: JsonSchema,
    names: Callable[[Any], Iterable[str | None]] = lambda value: (),
) -> Notation:
    return Notation(parse, f"a number or a short text here, for example {example}", schema, names=names)


def _number_or(pattern: str, *examples: str | int | float) -> JsonSchema:
    return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": pattern}], "examples": list(examples)}


def _text_of(pattern: str, *examples: str) -> JsonSchema:
    return {"type": "string", "pattern": pattern, "examples": list(examples)}


Name = Annotated[str, Limits(pattern=r"^[a-z][a-z0-9_]*$", max_length=48)]
EditionName = Annotated[str, Limits(pattern=r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$", max_length=40)]
ValueName = Annotated[str, Limits(pattern=r"^[A-Za-z0-9][A-Za-z0-9_]*$", max_length=32)]
Rational = Annotated[
    Fraction,
    _written(notation.rational, "0.01 or 1/64", _number_or(notation.RATIONAL_PATTERN, 0.01, "1/64", "16.5/2048")),
]
Multiple = Annotated[
    notation.Multiple,
    _written(
        notation.multiple,
        "0.01, 1/64 or 2/65535*size",
        _number_or(notation.MULTIPLE_PATTERN, 0.01, "1/64", "16.5/2048", "2*pi/65536", "2/65535*size", "360/counts"),
        lambda multiple: factors(multiple.parameter).names if multiple.parameter else (),
    ),
    Ref("parameter"),
]
Span = Annotated[
    Range,
    _written(
        notation.span,
        "-850..850",
        _text_of(notation.RANGE_PATTERN, "-850..850", "0..100*size-1", "-size..size"),
        lambda span: [span.low.parameter, span.high.parameter],
    ),
    Ref("parameter"),
]
RawIntegers = Annotated[
    range | Literal["nan"],
    _written(
        notation.raw_integers,
        "0xFF or 0xFF00..0xFFFF",
        {
            "anyOf": [
                {"type": "integer"},
                {"type": "string", "pattern": notation.RAW_INTEGERS_PATTERN},
                {"const": "nan"},
            ],
            "examples": [255, "0xFF00..0xFFFF", -32768, "nan"],
        },
    ),
]
Ids = Annotated[
    range,
    _written(
        notation.ids,
        "0x300 or 0x241..0x260",
        _number_or(notation.RAW_INTEGERS_PATTERN, 0x300, "0x300", "0x241..0x260"),
    ),
]
Nodes = Annotated[range, _written(notation.nodes, "1..32", _text_of(notation.NODES_PATTERN, "1..32"))]
Indices = Annotated[range, _written(notation.indices, "1..4", _text_of(notation.NODES_PATTERN, "1..4"))]
Counter = Annotated[range, _written(notation.counter, "0..14", _text_of(notation.NODES_PATTERN, "0..14"))]
Start = Annotated[At, _written(notation.at, "4, 4.3 or id.5", _number_or(notation.AT_PATTERN, 4, 4.3, "id.5"))]
BitsRun = Annotated[
    notation.Run, _written(notation.run, "2..3 or 4.5..4.7", _number_or(notation.RUN_PATTERN, "2..3", "4.5..4.7", 4.5))
]
IdText = Annotated[
    IdExpression,
    _written(
        notation.id_expression,
        "0x100 + node",
        _number_or(notation.ID_PATTERN, "0x100 + node", "node << 5", "300 + node * 10", "host_id", 640),
        lambda expression: [expression.parameter],
    ),
    Ref("parameter"),
]
Raw = Annotated[
    notation.RawFormat,
    _written(notation.raw_format, "u8", _text_of(notation.RAW_PATTERN, "u8", "i16", "i56", "f32", "ascii8")),
]
ChecksumInput = Annotated[
    DataBytes | ConstantBytes | Literal["id", "id_low"],
    Notation(
        notation.checksum_input,
        'data bytes, `id`, `id_low` or constant bytes here, for example 0..6 or "34 12"',
        _text_of(notation.CHECKSUM_INPUT_PATTERN, "0..6", "id", "34 12"),
        any_scalar=True,
    ),
]
CodeFormat = Annotated[
    notation.RawFormat, _written(notation.code_format, "u8", _text_of(notation.CODE_PATTERN, "u8", "u16"))
]
Byte = Annotated[int, Limits(ge=0)]
Section = Annotated[str, Limits(min_length=1, max_length=80)]
ManualName = Annotated[str, Limits(min_length=1, max_length=120, pattern=VISIBLE)]
Line = Annotated[str, Limits(min_length=1, max_length=2000, pattern=VISIBLE)]
Language = Literal["en", "zh"]
Text = Line | dict[Language, Line]
"""A text as it is written."""
EditionText = Annotated[
    dict[str, str],
    Translated(Text),
    Doc("A text in each language of the edition, or a plain text if the edition has one language."),
]
"""A text in every language of the edition; empty without one."""
ParameterName = Annotated[Name, Ref("parameter")]
Only = Annotated[
    dict[ParameterName, Annotated[list[Annotated[ValueName, Ref("value", of="parameter")]], Limits(min_length=1)]]
    | None,
    Doc(
        "Parameter to the values for which this exists; without it, this always exists.",
        examples=({"model": ["A", "B"]},),
    ),
]
