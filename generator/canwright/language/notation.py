"""The notations of the language: rationals, ranges, id rules, positions and raw formats.

Each parser returns exact values, or raises ValueError with a message for the author.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from ..model.layout import MAX_DATA_BYTES, Space
from ..model.types import Bound, Encoding, Order, Range

LONGEST = 200
"""The maximum number of characters of a notation. It limits the computing time for untrusted text."""
DIGITS = 40
"""The maximum number of characters of one number."""
MAX_NODES = 1 << 16
MAX_ELEMENTS = MAX_DATA_BYTES * 8
"""The maximum number of array elements: one for each bit of a frame."""
LAST_BYTE = MAX_DATA_BYTES * 8 - 1
"""The last position that is accepted. It is beyond a frame, so that a rule reports a bit number used as a byte number."""
LAST_ID_BIT = 28
SHORT_ID = 0x7FF
"""The last 11-bit id."""
LAST_ID = (1 << LAST_ID_BIT + 1) - 1

_WHOLE = r"(?:0|[1-9][0-9]*)"
_NUMBER = rf"[+-]?(?:0x[0-9A-Fa-f]+|{_WHOLE}(?:\.[0-9]+)?)"
NUMBER = re.compile(_NUMBER)
RATIONAL_PATTERN = rf"^{_NUMBER}(/{_NUMBER})?$"
_SUMMAND = rf"[+-]{_WHOLE}(?:\.[0-9]+)?"
_MULTIPLE = rf"(?:{_NUMBER}(?:/{_NUMBER})?\*|(?!(?:none|nan|inf)\b)[+-]?)[a-z][a-z0-9_]*"
MULTIPLE_PATTERN = rf"^(?:{_NUMBER}(?:/{_NUMBER})?|{_MULTIPLE})$"
_BOUND = rf"(?:{_NUMBER}|{_MULTIPLE}(?:{_SUMMAND})?)"
RANGE_PATTERN = rf"^{_BOUND}\.\.{_BOUND}$"
NODES_PATTERN = rf"^{_WHOLE}\.\.{_WHOLE}$"
RAW_PATTERN = r"^(?:[ui](?:[1-9]|[1-5][0-9]|6[0-4])|f32|f64)$"
CODE_PATTERN = r"^u(?:[1-9]|[1-5][0-9]|6[0-4])$"
AT_PATTERN = rf"^(?:{_WHOLE}(?:\.[0-7])?|id\.{_WHOLE})$"
_ID_NUMBER = rf"(?:0x[0-9A-Fa-f]+|{_WHOLE})"
_NODE = rf"(?:(?:{_ID_NUMBER} *\* *)?node|node(?: *<< *{_WHOLE}| *\* *{_ID_NUMBER}))"
_TERM = rf"(?:{_ID_NUMBER}|{_NODE}|\( *{_NODE} *\))"
ID_PATTERN = rf"^{_TERM}(?: *\+ *{_TERM})*$"


def text_of(scalar: str | int | Decimal | Fraction) -> str:
    """A scalar as text; a decimal without an exponent, which is not part of the language."""
    return f"{scalar:f}" if isinstance(scalar, Decimal) else str(scalar)


def number(text: str) -> Fraction:
    """An exact number: `-2048`, `0x1F`, `16.5`."""
    if not NUMBER.fullmatch(text):
        raise ValueError(
            f"`{text}` is not a number; write an integer, a hexadecimal (0x1F), a decimal (0.01) or a quotient (33/2048)"
        )
    if len(text) > DIGITS:
        raise ValueError(f"`{text}` has more than {DIGITS} digits")
    if "x" in text:
        return Fraction(int(text, 16))
    return Fraction(Decimal(text))


def rational(text: str) -> Fraction:
    """A number, or a quotient of two numbers: `16.5/2048`."""
    above, slash, below = text.replace(" ", "").partition("/")
    if not slash:
        return number(above)
    if not above or not below:
        raise ValueError(f"`{text}` is not a number; write a quotient of two numbers, for example 33/2048")
    divisor = number(below)
    if divisor == 0:
        raise ValueError(f"`{text}` divides by zero")
    return number(above) / divisor


@dataclass(frozen=True)
class Multiple:
    """An exact rational, or its product with a number parameter. `text` is the rational as written."""

    value: Fraction
    parameter: str | None
    text: str


def multiple(text: str) -> Multiple:
    """A rational with its notation, `360/16384` and not 45/2048, or a product: `2/65535*size`, `-size`."""
    parts = re.fullmatch(r"(?:(.*)\*|(?!(?:none|nan|inf)\b)([+-]?))([a-z][a-z0-9_]*)", text.replace(" ", ""))
    if parts is None:
        return Multiple(rational(text), None, text.replace(" ", ""))
    written, sign, parameter = parts.groups()
    factor = f"{sign}1".lstrip("+") if written is None else written
    return Multiple(rational(factor), parameter, factor)


def span(text: str) -> Range:
    """A range `low..high`, both ends included; an end may be `100*size-1` or `-size`."""
    low, dots, high = text.replace(" ", "").partition("..")
    if not dots:
        raise ValueError(f"`{text}` is not a range; write it as low..high, for example -850..850")
    if not low or not high:
        raise ValueError(f"the range `{text}` has no {'high' if low else 'low'} end; write it as low..high")
    result = Range(_bound(low), _bound(high))
    if result.is_constant and result.low.constant > result.high.constant:
        raise ValueError(f"the range `{text}` is empty: its low end is above its high end")
    return result


def _bound(text: str) -> Bound:
    match = re.fullmatch(rf"{_NUMBER}|({_MULTIPLE})({_SUMMAND})?", text)
    if match is None:
        raise ValueError(f"`{text}` is not an end of a range; write a number, or number*parameter+number")
    written, constant = match.groups()
    if written is None:
        return Bound(number(text))
    product = multiple(written)
    return Bound(number(constant or "0"), product.value, product.parameter)


def nodes(text: str) -> range:
    """Nodes `1..32`, both ends included."""
    numbers = _numbers(text)
    if len(numbers) > MAX_NODES:
        raise ValueError(f"the {len(numbers)} nodes of `{text}` exceed the maximum of {MAX_NODES}")
    return numbers


def indices(text: str) -> range:
    """Indices of an array `1..4`, both ends included."""
    numbers = _numbers(text)
    if len(numbers) > MAX_ELEMENTS:
        raise ValueError(f"the {len(numbers)} array elements of `{text}` exceed the maximum of {MAX_ELEMENTS}")
    return numbers


def _numbers(text: str) -> range:
    if not re.fullmatch(NODES_PATTERN, text.replace(" ", "")):
        number = re.fullmatch(r"(?:([0-9]{1,9}) *[ -] *)?([0-9]{1,9})", text)
        example = f"{number[1] or 1}..{number[2]}" if number else "1..32"
        raise ValueError(f"`{text}` is not a range of whole numbers; write it as {example}")
    first, last = (int(part) for part in text.replace(" ", "").split(".."))
    if last > LAST_ID:
        raise ValueError(f"the range `{text}` exceeds {LAST_ID}, the last CAN id")
    if first > last:
        raise ValueError(f"the range `{text}` is empty: {first} is above {last}")
    return range(first, last + 1)


def data_bytes(text: str) -> bytes:
    """Data bytes in hex: `A1 00`."""
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise ValueError(
            f"`{text}` is not data; write pairs of hex digits, for example A1 00 00 00 64 00 00 00"
        ) from None


def value(written: str | int | Decimal) -> Fraction | str:
    """A number in its unit, `none` for no value, or the name of an enum member."""
    if isinstance(written, str) and not NUMBER.match(written):
        return written
    return rational(text_of(written).lower())


@dataclass(frozen=True)
class IdExpression:
    """`0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed id; `node_step` is None for an id without `node`."""

    base: int
    node_step: int | None


def id_expression(text: str) -> IdExpression:
    """A sum of numbers and at most one `node`, possibly shifted or multiplied: `0x100 + node`, `1 + (node << 5)`."""
    base = 0
    step: int | None = None
    for term in (part.strip() for part in text.split("+")):
        bare = re.sub(rf"^\( *({_NODE}) *\)$", r"\1", term)
        match = re.fullmatch(rf"(?:({_ID_NUMBER}) *\* *)?node|node *(<<|\*) *({_ID_NUMBER})", bare)
        if match and step is not None:
            raise ValueError(f"`{text}` contains `node` twice; write it once")
        if match:
            step = _node_step(term, match[1] or match[3] or "1", match[2] == "<<")
        elif re.fullmatch(_ID_NUMBER, term):
            base += int(term, 0)
        else:
            form = (
                "other parts of an id as `selector` or fields at id.0"
                if "|" in term
                else "0x100 + node, node << 5 or 0x200"
            )
            raise ValueError(f"`{term}` is not valid in an id; write {form}")
    return IdExpression(base, step)


def _node_step(term: str, written: str, shifted: bool) -> int:
    """The difference between the ids of two adjacent nodes."""
    number = int(written, 0)
    if shifted and number > LAST_ID_BIT:
        raise ValueError(f"`{term}` exceeds {LAST_ID_BIT}, the last bit of a CAN id")
    step = 1 << number if shifted else number
    if not 1 <= step <= LAST_ID:
        raise ValueError(
            f"`{term}` gives all nodes the same id" if not step else f"`{term}` exceeds 0x{LAST_ID:X}, the last CAN id"
        )
    return step


@dataclass(frozen=True)
class At:
    """The start of a field. `bit` is None for a byte alone; the byte order then determines the bit."""

    space: Space
    byte: int
    bit: int | None


def at(text: str) -> At:
    """`4` is byte 4; `4.3` is bit 3 of byte 4; `id.5` is bit 5 of the CAN id."""
    match = re.fullmatch(rf"({_WHOLE})(?:\.([0-7]))?|id\.({_WHOLE})", text)
    if match is None:
        raise ValueError(
            f"`{text}` is not a position; write a byte (4), a byte and one of its bits 0 to 7 (4.3), or an id bit (id.5)"
        )
    byte, bit, id_bit = match.groups()
    if int(id_bit or 0) > LAST_ID_BIT or int(byte or 0) > LAST_BYTE:
        raise ValueError(
            f"`{text}` is outside of a frame; the last byte is {MAX_DATA_BYTES - 1}, the last id bit is {LAST_ID_BIT}"
        )
    if id_bit is not None:
        return At(Space.ID, 0, int(id_bit))
    return At(Space.DATA, int(byte), None if bit is None else int(bit))


def raw_format(text: str) -> tuple[Encoding, int]:
    """`u16` unsigned, `i56` signed, `f32` and `f64` IEEE float; the number is the width in bits."""
    if not re.fullmatch(RAW_PATTERN, text):
        raise ValueError(f"`{text}` is not a raw format; write u or i and 1 to 64 bits (u8, i16, i56), or f32, f64")
    width = int(text[1:])
    if text[0] == "f":
        return Encoding.FLOAT, width
    return (Encoding.SIGNED if text[0] == "i" else Encoding.UNSIGNED), width


def code_format(text: str) -> tuple[Encoding, int]:
    """The raw format of a code or an index, which is unsigned."""
    encoding, width = raw_format(text)
    if encoding is not Encoding.UNSIGNED:
        raise ValueError(f"`{text}` is not unsigned, as codes and indices must be; write u{width}")
    return encoding, width


def frame_bits(start: At, width: int, order: Order) -> tuple[int, ...]:
    """Frame bits of a field from the least significant raw bit up.

    A little-endian field starts at its least significant bit, by default bit 0 of the byte, and continues upwards. A
    big-endian field starts at its most significant bit, by default bit 7, and continues downwards into the next byte.
    """
    if start.space is Space.ID or order is Order.LITTLE:
        first = start.byte * 8 + (start.bit or 0)
        return tuple(range(first, first + width))
    first = start.byte * 8 + (7 - (7 if start.bit is None else start.bit))
    descending = (first + i for i in range(width))
    return tuple(reversed([n // 8 * 8 + (7 - n % 8) for n in descending]))
