"""The small notations of the language: rationals, ranges, id rules, positions and raw formats.

Each parser takes the text as written and returns exact values, or raises ValueError with a sentence for the writer.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from ..model.layout import MAX_DATA_BYTES, Space
from ..model.types import Bound, Encoding, Order, Range

LONGEST = 200
"""Characters of a notation, so that no text of a stranger makes numbers that take long to reckon with."""
DIGITS = 40
"""Characters of one number."""
MOST_NODES = 1 << 16
MOST_ELEMENTS = MAX_DATA_BYTES * 8
"""Elements of an array: no frame has more bits."""
LAST_BYTE = MAX_DATA_BYTES * 8 - 1
"""The last position that is read: a bit in place of a byte is reported with the byte it is in."""
LAST_ID_BIT = 28
SHORT_ID = 0x7FF
"""The last id of 11 bits."""
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


def number(text: str) -> Fraction:
    """One number as written, exact: `-2048`, `0x1F`, `16.5`."""
    if not NUMBER.fullmatch(text):
        raise ValueError(
            f"`{text}` is not a number; write an integer, a hexadecimal like 0x1F, a decimal like 0.01 or a quotient like 33/2048"
        )
    if len(text) > DIGITS:
        raise ValueError(f"`{text}` has more than {DIGITS} digits")
    if "x" in text:
        return Fraction(int(text, 16))
    return Fraction(Decimal(text))


def rational(text: str) -> Fraction:
    """A number, or a quotient of two as a manual prints it: `16.5/2048`."""
    above, slash, below = text.replace(" ", "").partition("/")
    if not slash:
        return number(above)
    if not above or not below:
        raise ValueError(f"`{text}` is not a number; a quotient has two, like 33/2048")
    divisor = number(below)
    if divisor == 0:
        raise ValueError(f"`{text}` divides by zero")
    return number(above) / divisor


@dataclass(frozen=True)
class Multiple:
    """A rational, or so many times a number parameter; exact. `text` is the rational the way it was written."""

    value: Fraction
    parameter: str | None
    text: str


def multiple(text: str) -> Multiple:
    """A rational that people read as it was written: `360/16384` and not 45/2048; also `2/65535*size` and `-size`."""
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
    found = multiple(written)
    return Bound(number(constant or "0"), found.value, found.parameter)


def nodes(text: str) -> range:
    """Nodes `1..32`, both ends included."""
    found = _numbers(text)
    if len(found) > MOST_NODES:
        raise ValueError(f"`{text}` are {len(found)} nodes, more than {MOST_NODES}")
    return found


def indices(text: str) -> range:
    """Indices of an array `1..4`, both ends included."""
    found = _numbers(text)
    if len(found) > MOST_ELEMENTS:
        raise ValueError(f"an array `{text}` has {len(found)} elements, and a frame has room for {MOST_ELEMENTS}")
    return found


def _numbers(text: str) -> range:
    if not re.fullmatch(NODES_PATTERN, text.replace(" ", "")):
        number = re.fullmatch(r"(?:([0-9]{1,9}) *[ -] *)?([0-9]{1,9})", text)
        meant = f"{number[1] or 1}..{number[2]}" if number else "1..32"
        raise ValueError(f"`{text}` is not a range of whole numbers; write it as {meant}")
    first, last = (int(part) for part in text.replace(" ", "").split(".."))
    if last > LAST_ID:
        raise ValueError(f"the range `{text}` goes beyond {LAST_ID}, the last CAN id")
    if first > last:
        raise ValueError(f"the range `{text}` is empty: {first} is above {last}")
    return range(first, last + 1)


@dataclass(frozen=True)
class IdExpression:
    """`0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed id; `node_step` is None when no node is in it."""

    base: int
    node_step: int | None


def id_expression(text: str) -> IdExpression:
    """A sum of numbers and at most one `node`, which may be shifted or multiplied: `0x100 + node`, `1 + (node << 5)`."""
    base = 0
    step: int | None = None
    for term in (part.strip() for part in text.split("+")):
        bare = re.sub(rf"^\( *({_NODE}) *\)$", r"\1", term)
        match = re.fullmatch(rf"(?:({_ID_NUMBER}) *\* *)?node|node *(<<|\*) *({_ID_NUMBER})", bare)
        if match and step is not None:
            raise ValueError(f"`{text}` names node twice")
        if match:
            step = _node_step(term, match[1] or match[3] or "1", match[2] == "<<")
        elif re.fullmatch(_ID_NUMBER, term):
            base += int(term, 0)
        else:
            more = "; for the other parts of an id there are `selector` and fields at id.0" if "|" in term else ""
            raise ValueError(f"`{term}` does not belong in an id; write it like 0x100 + node, node << 5 or 0x200{more}")
    return IdExpression(base, step)


def _node_step(term: str, written: str, shifted: bool) -> int:
    """How far the id of a node is from that of the next."""
    number = int(written, 0)
    if shifted and number > LAST_ID_BIT:
        raise ValueError(f"`{term}` is beyond the last bit of a CAN id, {LAST_ID_BIT}")
    step = 1 << number if shifted else number
    if not 1 <= step <= LAST_ID:
        raise ValueError(
            f"`{term}` gives no node an id of its own" if not step else f"`{term}` is beyond 0x{LAST_ID:X}"
        )
    return step


@dataclass(frozen=True)
class At:
    """Where a field starts. `bit` is None when only the byte is given, and the byte order decides."""

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
        raise ValueError(f"`{text}` is in no frame: there are bytes up to {LAST_BYTE}, and id bits up to {LAST_ID_BIT}")
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
    """As `raw_format`, of what selects: codes and indices are unsigned."""
    encoding, width = raw_format(text)
    if encoding is not Encoding.UNSIGNED:
        raise ValueError(f"codes and indices are unsigned, and `{text}` is not; write u{width}")
    return encoding, width


def frame_bits(start: At, width: int, order: Order) -> tuple[int, ...]:
    """Frame bits of a field from the least significant raw bit up.

    A little-endian field starts at its least significant bit, by default bit 0 of the byte, and goes on upwards. A
    big-endian one starts at its most significant bit, by default bit 7, and goes on downwards into the next byte.
    """
    if start.space is Space.ID or order is Order.LITTLE:
        first = start.byte * 8 + (start.bit or 0)
        return tuple(range(first, first + width))
    first = start.byte * 8 + (7 - (7 if start.bit is None else start.bit))
    descending = (first + i for i in range(width))
    return tuple(reversed([n // 8 * 8 + (7 - n % 8) for n in descending]))
