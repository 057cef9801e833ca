"""Bits of a frame as C expressions: shifts and masks of single bytes, computed at generation time."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from ...model.exhaustive import assert_never
from ...model.layout import Field, Segment, Space
from ...model.message import BitRun, Confusion
from ...semantics.plan import (
    CheckAvailable,
    CheckCode,
    CheckConstant,
    CheckField,
    CheckMeaning,
    CheckNode,
    ChooseFields,
    EncodingStep,
    NeedParameter,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
)
from .expressions import Integer, integer, joined, operand, raw_of, smallest, working
from .names import member


def read(space: Space, segments: Sequence[Segment], width: int, frame: str = "frame") -> str:
    """The expression of some bits of a frame, without a sign."""
    if len(segments) == 1 and not segments[0].raw_low:
        return _term(space, segments[0], frame)
    wide = working(width)
    terms = [f"({wide.name}){operand(_term(space, s, frame))}" for s in segments]
    return joined(
        "|", [f"{term} << {s.raw_low}" if s.raw_low else term for s, term in zip(segments, terms, strict=True)]
    )


def read_field(field: Field, segments: Sequence[Segment]) -> str:
    """The expression of the raw integer of a field, in its C type."""
    kind, width = integer(field.type), field.type.width
    bits = read(field.space, segments, width)
    is_whole = kind.width == working(width).width or (is_byte(field.space, segments) and not segments[0].raw_low)
    unsigned = bits if is_whole else f"({kind.unsigned.name})({bits})"
    if not kind.signed:
        return unsigned
    if kind.width == width < 32:
        return f"canwright_signed{width}({unsigned})"
    wide = Integer(working(width).width, True)
    signed = _sign_extended(field, segments) or f"canwright_signed{wide.width}({bits}, {width}u)"
    return signed if kind == wide else f"({kind.name}){signed}"


def _sign_extended(field: Field, segments: Sequence[Segment]) -> str:
    """A signed number through the sign of its highest byte, which takes fewer instructions; empty if it cannot be read so.

    That byte is a whole one, no byte has bits of both words, and each word is read by itself.
    """
    *rest, top = sorted(segments, key=lambda segment: segment.raw_low)
    is_split = all(s.raw_low >= 32 or s.raw_low + s.width <= 32 for s in segments)
    if not is_byte(field.space, [top]) or field.type.width in (32, 64) or not is_split:
        return ""
    low = [s for s in rest if s.raw_low < 32]
    high = [replace(s, raw_low=s.raw_low - 32) for s in rest if s.raw_low >= 32]
    shift = top.raw_low % 32
    terms = [f"(uint32_t)canwright_signed8({_term(field.space, top, 'frame')})" + (f" << {shift}" if shift else "")]
    read_low = read(field.space, low, 32)
    if field.type.width < 32:
        return f"canwright_signed32({joined('|', [read_low, *terms])}, 32u)"
    words = joined("|", [read(field.space, high, 32), *terms] if high else terms)
    return f"canwright_signed_words({words}, {read_low})"


def key_value(key: BitRun, frame: str = "frame") -> str:
    """The expression of the bits of a key in a frame."""
    return read(key.space, key.segments, key.width, frame)


def constant_differs(check: CheckConstant) -> str:
    """The condition for a frame with another value of a constant field."""
    field, value = check.field, check.raw & ((1 << check.field.type.width) - 1)
    kind = _shown(field.type.width, field.elements[0].segments)
    each = (operand(read(field.space, e.segments, field.type.width)) for e in field.elements)
    return joined("||", [f"{bits} != {kind.bits(value)}" for bits in each])


def is_confused(confusions: Iterable[Confusion]) -> str:
    """The condition for a frame that is identified as another message; empty if no frame is."""
    every = [
        joined(
            "&&",
            [
                joined("||", [f"{operand(key_value(run))} == {value}" for value in labels(run, values)])
                for run, values in confusion.conditions
            ],
        )
        for confusion in confusions
    ]
    return joined("||", every) if every else ""


def constant_read(field: Field) -> str:
    """The expression of the raw bits of a field that is no array."""
    return operand(read(field.space, field.elements[0].segments, field.type.width))


def labels(key: BitRun, values: Iterable[int]) -> list[str]:
    """Values of a key as C literals."""
    return [_shown(key.width, key.segments).bits(value) for value in values]


class Write(NamedTuple):
    """A value for a data byte; if `byte` is None, for bits of the id that are 0 before."""

    byte: int | None
    value: str


def write(space: Space, segments: Sequence[Segment], width: int, name: str) -> Iterator[Write]:
    """Writes a variable of a width, without other bits, into bits that are 0."""
    for s in segments:
        bits = _piece_of(name, working(width), s, is_masked=s.raw_low + s.width < width)
        if space is Space.ID:
            yield Write(None, bits)
        elif s.width == 8:
            yield Write(s.byte, f"(uint8_t)({name} >> {s.raw_low})" if s.raw_low else f"(uint8_t){name}")
        else:
            yield Write(s.byte, f"(uint8_t)(frame->data[{s.byte}] | {bits})")


def write_fields(
    steps: Iterable[EncodingStep], fields: Container[Field], shared: Container[int], values: Mapping[Field, str]
) -> Iterator[Write]:
    """Writes fields except the checksum into a frame whose data bytes are 0; bytes that are `shared` already contain a key.

    `values` are the expressions of constants that are parameters.
    """
    terms: dict[int, list[str]] = {}
    fixed: dict[int, int] = {}
    partial: set[int] = set()
    for step in steps:
        match step:
            case WriteFixed():
                for s in step.segments if step.field in fields else ():
                    if step.space is Space.ID:
                        yield Write(None, f"0x{_piece(step.raw, s):X}u")
                    else:
                        fixed[s.byte] = fixed.get(s.byte, 0) | _piece(step.raw, s)
            case WriteParameter() | WriteField():
                field = step.field
                for number, element in enumerate(field.elements if field in fields else ()):
                    item = f"message->{member(field.name)}" + (f"[{number}]" if field.is_array else "")
                    raw = (
                        f"({integer(field.type).name}){values[field]}" if field in values else raw_of(field.type, item)
                    )
                    for s in element.segments:
                        bits = _write(field, raw, s)
                        if field.space is Space.ID:
                            yield Write(None, bits)
                        else:
                            terms.setdefault(s.byte, []).append(bits)
                            partial.update([s.byte] if s.width < 8 else [])
            case CheckAvailable() | CheckCode() | CheckNode() | NeedParameter() | WriteCode() | CheckMeaning():
                pass  # the function of the message
            case ChooseFields() | CheckField() | WriteChecksum():
                pass  # `chooses`, `check` and `checksum` of the layout
            case _:
                assert_never(step)
    for byte in sorted({*terms, *fixed}):
        before = [f"frame->data[{byte}]"] if byte in shared else []
        constant = [f"0x{fixed[byte]:02X}u"] if byte in fixed else []
        every = [*before, *terms.get(byte, []), *constant]
        yield Write(byte, f"(uint8_t)({joined('|', every)})" if len(every) > 1 or byte in partial else every[0])


def _piece_of(number: str, kind: Integer, s: Segment, *, is_masked: bool = True) -> str:
    """The bits of a number in a segment, at their position, as 32 bits."""
    shifted = f"({number} >> {s.raw_low})" if s.raw_low else number
    masked = f"({shifted} & 0x{(1 << s.width) - 1:X}u)" if is_masked else shifted
    if kind.width == 64:
        masked = f"(uint32_t){masked}"
    return f"({masked} << {s.low})" if s.low else masked


def _piece(value: int, s: Segment) -> int:
    return (value >> s.raw_low & ((1 << s.width) - 1)) << s.low


def _write(field: Field, member: str, s: Segment) -> str:
    kind = integer(field.type)
    if field.space is Space.DATA and s.width == 8:
        if s.raw_low:
            return f"(uint8_t)({_as(kind.unsigned, kind, member)} >> {s.raw_low})"
        return _as(smallest(8, False), kind, member)
    wide = working(field.type.width)
    return _piece_of(_as(wide, kind, member), wide, s)


def _as(wanted: Integer, kind: Integer, expression: str) -> str:
    return expression if kind == wanted else f"({wanted.name}){expression}"


def _term(space: Space, s: Segment, frame: str) -> str:
    source = f"{frame}->id" if space is Space.ID else f"{frame}->data[{s.byte}]"
    if space is Space.DATA and s.width == 8:
        return source
    shifted = f"({source} >> {s.low})" if s.low else source
    return f"{shifted} & 0x{(1 << s.width) - 1:X}u"


def is_byte(space: Space, segments: Sequence[Segment]) -> bool:
    """True for the bits of a whole data byte."""
    return space is Space.DATA and len(segments) == 1 and segments[0].width == 8


def _shown(width: int, segments: Sequence[Segment]) -> Integer:
    """The integer type of a literal: a byte for a whole byte."""
    return smallest(width, False) if len(segments) == 1 and width <= 16 else working(width)
