"""What a spec's writer writes, as types: read from its text, exact, each with its JSON Schema."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Literal, TypeVar

from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema

from ..model.types import Encoding, Range
from . import notation
from .notation import At, IdExpression
from .suggestions import VISIBLE

T = TypeVar("T")


def _written(parse: Callable[[str], T], example: str) -> BeforeValidator:
    """Validates a notation from its text; numbers come from the source exact, so their text is as written."""

    def validate(value: object) -> T:
        if isinstance(value, bool) or not isinstance(value, (str, int, Decimal)):
            raise ValueError(f"expected a number or a short text here, like {example}")
        text = str(value)
        if len(text) > notation.LONGEST:
            raise ValueError(f"this is longer than {notation.LONGEST} characters; expected a number or a short text")
        return parse(text)

    return BeforeValidator(validate)


def _number_or(pattern: str, *examples: str | int | float) -> WithJsonSchema:
    return WithJsonSchema(
        {"anyOf": [{"type": "number"}, {"type": "string", "pattern": pattern}], "examples": list(examples)}
    )


def _text_of(pattern: str, *examples: str) -> WithJsonSchema:
    return WithJsonSchema({"type": "string", "pattern": pattern, "examples": list(examples)})


Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=48)]
ValueName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_]*$", max_length=32)]
Rational = Annotated[
    Fraction,
    _written(notation.rational, "0.01 or 1/64"),
    _number_or(notation.RATIONAL_PATTERN, 0.01, "1/64", "16.5/2048"),
]
Multiple = Annotated[
    notation.Multiple,
    _written(notation.multiple, "0.01, 1/64 or 2/65535*size"),
    _number_or(notation.MULTIPLE_PATTERN, 0.01, "1/64", "16.5/2048", "2/65535*size"),
]
Span = Annotated[
    Range,
    _written(notation.span, "-850..850"),
    _text_of(notation.RANGE_PATTERN, "-850..850", "0..100*size-1", "-size..size"),
]
Nodes = Annotated[range, _written(notation.nodes, "1..32"), _text_of(notation.NODES_PATTERN, "1..32")]
Indices = Annotated[range, _written(notation.indices, "1..4"), _text_of(notation.NODES_PATTERN, "1..4")]
Start = Annotated[At, _written(notation.at, "4, 4.3 or id.5"), _number_or(notation.AT_PATTERN, 4, 4.3, "id.5")]
IdText = Annotated[
    IdExpression,
    _written(notation.id_expression, "0x100 + node"),
    _number_or(notation.ID_PATTERN, "0x100 + node", "node << 5", "300 + node * 10", 640),
]
Raw = Annotated[
    tuple[Encoding, int], _written(notation.raw_format, "u8"), _text_of(notation.RAW_PATTERN, "u8", "i16", "i56", "f32")
]
CodeFormat = Annotated[
    tuple[Encoding, int], _written(notation.code_format, "u8"), _text_of(notation.CODE_PATTERN, "u8", "u16")
]
Byte = Annotated[int, Field(ge=0)]
Section = Annotated[str, Field(min_length=1, max_length=80)]
Line = Annotated[str, Field(min_length=1, max_length=2000, pattern=VISIBLE)]
Language = Literal["en", "zh"]


def is_map(value: object) -> str:
    return "map" if isinstance(value, dict) else "plain"


Text = Annotated[
    Annotated[Line, Tag("plain")] | Annotated[dict[Language, Line], Tag("map")],
    Discriminator(is_map),
    Field(description="A text in each language of the edition, or a plain text where there is one language."),
]

Only = Annotated[
    dict[Name, Annotated[list[ValueName], Field(min_length=1)]] | None,
    Field(
        description="Parameter to the values under which this is there; left out, it always is.",
        examples=[{"model": ["A", "B"]}],
    ),
]
