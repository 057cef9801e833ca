"""The notations of the language: rationals, ranges, id rules, positions and raw formats.

Each parser returns exact values, or raises ValueError with a message for the author.
"""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import Literal, NamedTuple

from ..model.checksum import ConstantBytes, DataBytes
from ..model.joined import Joined, JoinedDigits, JoinedText
from ..model.layout import MAX_DATA_BYTES, Space
from ..model.types import PI, Bound, Encoding, Order, Range

LONGEST = 200
"""The maximum number of characters of a notation. It limits the computing time for untrusted text."""
DIGITS = 40
"""The maximum number of characters of one number."""
MAX_NODES = 1 << 16
MAX_ELEMENTS = MAX_DATA_BYTES * 8
"""The maximum number of array elements: one for each bit of a frame."""
LAST_BYTE = MAX_DATA_BYTES * 8 - 1
"""The last position that is accepted. It is beyond a frame, so that a rule reports a bit number used as a byte number."""
MAX_DIGITS = 15
"""The maximum number of decimal digits of a number, which is then exact in every language."""
LAST_ID_BIT = 28
SHORT_ID = 0x7FF
"""The last 11-bit id."""
LAST_ID = (1 << LAST_ID_BIT + 1) - 1

_WHOLE = r"(?:0|[1-9][0-9]*)"
_NUMBER = rf"[+-]?(?:0x[0-9A-Fa-f]+|{_WHOLE}(?:\.[0-9]+)?)"
NUMBER = re.compile(_NUMBER)
_PI = "(?:pi|π)"
_RATIONAL = rf"(?:{_NUMBER}(?:/{_NUMBER})?|(?:{_NUMBER}\*|[+-]?){_PI}(?:/{_NUMBER})?|{_NUMBER}/{_NUMBER}\*{_PI})"
"""A number, a quotient, or a multiple of π."""
RATIONAL_PATTERN = rf"^{_RATIONAL}$"
_SUMMAND = rf"[+-]{_WHOLE}(?:\.[0-9]+)?"
_FACTORS = r"(?!(?:none|nan|inf|pi)\b)[a-z][a-z0-9_]*(?:\*(?!pi\b)[a-z][a-z0-9_]*)?"
_DIVIDED = rf"(?:/{_NUMBER})?(?:/[a-z][a-z0-9_]*)?"
_SCALE = rf"(?:{_RATIONAL}\*|[+-]?){_FACTORS}{_DIVIDED}|{_RATIONAL}/[a-z][a-z0-9_]*"
"""A multiple of at most two parameters, divided by at most one: `a*b/65536`, `360/counts`."""
_MULTIPLE = rf"(?:{_RATIONAL}\*|(?!(?:none|nan|inf|pi)\b)[+-]?)(?!pi\b)[a-z][a-z0-9_]*"
MULTIPLE_PATTERN = rf"^(?:{_RATIONAL}|{_SCALE})$"
_BOUND = rf"(?:{_RATIONAL}|{_MULTIPLE}(?:{_SUMMAND})?)"
RANGE_PATTERN = rf"^{_BOUND}\.\.{_BOUND}$"
_INTEGER = rf"[+-]?(?:0x[0-9A-Fa-f]+|{_WHOLE})"
RAW_INTEGERS_PATTERN = rf"^{_INTEGER}(?:\.\.{_INTEGER})?$"
NODES_PATTERN = rf"^{_WHOLE}\.\.{_WHOLE}$"
RAW_PATTERN = r"^(?:[ui](?:[1-9]|[1-5][0-9]|6[0-4])|f32|f64|(?:ascii|utf8_|bcd)(?:[1-9]|[1-5][0-9]|6[0-4]))$"
CODE_PATTERN = r"^u(?:[1-9]|[1-5][0-9]|6[0-4])$"
_PLACE = rf"{_WHOLE}(?:\.[0-7])?"
RUN_PATTERN = rf"^{_PLACE}(?:\.\.{_PLACE})?$"
AT_PATTERN = rf"^(?:{_WHOLE}(?:\.[0-7])?|id\.{_WHOLE})$"
_ID_NUMBER = rf"(?:0x[0-9A-Fa-f]+|{_WHOLE})"
_WORD = "[a-z][a-z0-9_]*"
_NAMED = rf"(?:(?:{_ID_NUMBER} *\* *)?{_WORD}|{_WORD}(?: *<< *{_WHOLE}| *\* *{_ID_NUMBER}))"
"""The node, or a parameter."""
_TERM = rf"(?:{_ID_NUMBER}|{_NAMED}|\( *{_NAMED} *\))"
ID_PATTERN = rf"^{_TERM}(?: *\+ *{_TERM})*$"


def last_id(extended: bool) -> int:
    """The last id of 29 or of 11 bits."""
    return LAST_ID if extended else SHORT_ID


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
    """A number, a quotient of two numbers, or a multiple of π: `16.5/2048`, `2*pi/65536`."""
    compact = text.replace(" ", "")
    if re.fullmatch(_RATIONAL, compact) and (of_pi := re.search(rf"(?:(?<=[0-9a-fA-F])\*)?{_PI}", compact)):
        rest = compact.replace(of_pi[0], "" if of_pi[0][0] == "*" else "1", 1)
        return rational(rest) * PI
    above, slash, below = compact.partition("/")
    if not slash:
        return number(above)
    if not above or not below:
        raise ValueError(f"`{text}` is not a number; write a quotient of two numbers, for example 33/2048")
    divisor = number(below)
    if divisor == 0:
        raise ValueError(f"`{text}` divides by zero")
    return number(above) / divisor


class Multiple(NamedTuple):
    """An exact rational, or its product with number parameters, as in `model.types.factors`. `text` is the rational."""

    value: Fraction
    parameter: str | None
    text: str


def multiple(text: str) -> Multiple:
    """A rational with its notation, `360/16384` and not 45/2048, or a product: `2/65535*size`, `-size`, `360/counts`."""
    compact = text.replace(" ", "")
    if not re.fullmatch(_MULTIPLE, compact) and re.fullmatch(_SCALE, compact):
        return _of_several(compact)
    parts = re.fullmatch(r"(?:(.*)\*|(?!(?:none|nan|inf|pi)\b)([+-]?))(?!pi\b)([a-z][a-z0-9_]*)", text.replace(" ", ""))
    if parts is None:
        return Multiple(rational(text), None, _printed(text))
    written, sign, parameter = parts.groups()
    factor = f"{sign}1".lstrip("+") if written is None else written
    return Multiple(rational(factor), parameter, _printed(factor))


def _of_several(text: str) -> Multiple:
    """A multiple of several parameters, or of the reciprocal of one."""
    sign = "-" if text.startswith("-") else ""
    above, below, number = list[str](), list[str](), ""
    for operator, factor in re.findall(r"([*/]?)([^*/]+)", text.lstrip("+-")):
        if re.fullmatch(rf"(?!{_PI}$)[a-z][a-z0-9_]*", factor):
            (below if operator == "/" else above).append(factor)
        else:
            number += f"{operator or '*'}{factor}" if number or operator == "/" else factor
    number = sign + (f"1{number}" if number[:1] in ("", "/") else number)
    times = "*".join(above) + "".join(f"/{name}" for name in below)
    return Multiple(rational(number), times, _printed(number))


def _printed(written: str) -> str:
    """A number as documents print it."""
    return re.sub(r"\bpi\b", "π", written.replace(" ", ""))


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


def raw_integers(text: str) -> range | Literal["nan"]:
    """A raw integer `0xFF`, a range of them with both ends `0xFF00..0xFFFF`, or `nan` of a float."""
    if text == "nan":
        return "nan"
    if not re.fullmatch(RAW_INTEGERS_PATTERN, text.replace(" ", "")):
        raise ValueError(
            f"`{text}` is not a raw integer or a range of them; write, for example, 0xFF or 0xFF00..0xFFFF"
        )
    first, _, last = text.replace(" ", "").partition("..")
    low, high = (int(number(end)) for end in (first, last or first))
    if low > high:
        raise ValueError(f"the range `{text}` is empty: {first} is above {last}")
    return range(low, high + 1)


def ids(text: str) -> range:
    """An id `0x300`, or a range of them with both ends `0x241..0x260`."""
    parsed = raw_integers(text)
    if parsed == "nan" or not 0 <= parsed[0] <= parsed[-1] <= LAST_ID:
        raise ValueError(f"`{text}` is not an id or a range of them; write, for example, 0x300 or 0x241..0x260")
    return parsed


def _bound(text: str) -> Bound:
    match = re.fullmatch(rf"{_RATIONAL}|({_MULTIPLE})({_SUMMAND})?", text)
    if match is None:
        raise ValueError(f"`{text}` is not an end of a range; write a number, or number*parameter+number")
    written, constant = match.groups()
    if written is None:
        return Bound(rational(text))
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


def counter(text: str) -> range:
    """The values of a counter `0..14`, both ends included."""
    return _numbers(text)


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


BLANK = "__"
"""A byte that `canwright frames` leaves to the author."""


def data_bytes(text: str) -> bytes:
    """Data bytes in hex: `A1 00`."""
    if BLANK in text:
        raise ValueError(f"`{text}` has no bytes yet; replace each {BLANK} by the byte of the manual or of a log")
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise ValueError(
            f"`{text}` is not data; write pairs of hex digits, for example A1 00 00 00 64 00 00 00"
        ) from None


CHECKSUM_INPUT_PATTERN = rf"^(?:id|id_low|{_WHOLE}\.\.{_WHOLE}|[0-9A-Fa-f]{{2}}(?: [0-9A-Fa-f]{{2}})*)$"


def checksum_input(written: object) -> DataBytes | ConstantBytes | Literal["id", "id_low"]:
    """Bytes over which a checksum is computed: data bytes `0..6`, the `id`, its low byte, or constant bytes in hex, `34 12`."""
    if written == "id":
        return "id"
    if written == "id_low":
        return "id_low"
    if isinstance(written, str) and ".." in written:
        numbers = _numbers(written)
        if numbers[-1] > LAST_BYTE:
            raise ValueError(f"`{written}` is outside of a frame; the last byte is {MAX_DATA_BYTES - 1}")
        return DataBytes(numbers[0], numbers[-1])
    if isinstance(written, str) and re.fullmatch(CHECKSUM_INPUT_PATTERN, written):
        return ConstantBytes(bytes.fromhex(written))
    text = text_of(written) if isinstance(written, (str, int, Decimal)) else str(written)
    example = f'{text}..{text} for data byte {text}, or "{int(text):02X}"' if text.isdigit() else '0..6, id, or "34 12"'
    raise ValueError(f"`{text}` is no input of a checksum; write {example} for constant bytes in hex")


_WITH_UNIT = re.compile(rf"{_NUMBER} +\S")


class QuotedNumber(Fraction):
    """A number that is written in quotes, which can be a text."""

    text = ""


def value(written: str | int | Decimal) -> Fraction | str:
    """A number in its unit, `none` for no value, the name of an enum member, or a text."""
    if written == "pi":  # a name; a multiple of π has a number
        return "pi"
    if not isinstance(written, str):
        return rational(text_of(written).lower())
    try:
        number = QuotedNumber(rational(written.lower()))
    except ValueError:
        if NUMBER.fullmatch(written) or _WITH_UNIT.match(written):
            raise
        return written
    number.text = written
    return number


class IdExpression(NamedTuple):
    """`0x100 + node`, `node << 5`, `300 + node * 10`, or a fixed id; `node_step` is None for an id without `node`.

    `parameter` is the parameter in the id; `parameter_step` is its factor.
    """

    base: int
    node_step: int | None
    parameter: str | None = None
    parameter_step: int = 1


def id_expression(text: str) -> IdExpression:
    """A sum of numbers, at most one `node` and at most one parameter: `0x100 + node`, `(host_id << 8) + node`."""
    base = 0
    steps: dict[str, int] = {}
    for term in (part.strip() for part in text.split("+")):
        bare = re.sub(rf"^\( *({_NAMED}) *\)$", r"\1", term)
        match = re.fullmatch(rf"(?:({_ID_NUMBER}) *\* *)?({_WORD})|({_WORD}) *(<<|\*) *({_ID_NUMBER})", bare)
        if match:
            name = match[2] or match[3]
            if name in steps:
                raise ValueError(f"`{text}` contains `{name}` twice; write it once")
            steps[name] = _id_step(term, name, match[1] or match[5] or "1", match[4] == "<<")
        elif re.fullmatch(_ID_NUMBER, term):
            base += int(term, 0)
        else:
            form = (
                "other parts of an id as `selector` or fields at id.0"
                if "|" in term
                else "0x100 + node, node << 5 or 0x200"
            )
            raise ValueError(f"`{term}` is not valid in an id; write {form}")
    node_step = steps.pop("node", None)
    if len(steps) > 1:
        raise ValueError(f"`{text}` contains the parameters {' and '.join(steps)}; an id has at most one")
    return IdExpression(base, node_step, *next(iter(steps.items()), (None, 1)))


def _id_step(term: str, name: str, written: str, shifted: bool) -> int:
    """The difference between the ids of two adjacent nodes, or of two adjacent values of a parameter."""
    number = int(written, 0)
    if shifted and number > LAST_ID_BIT:
        raise ValueError(f"`{term}` exceeds {LAST_ID_BIT}, the last bit of a CAN id")
    step = 1 << number if shifted else number
    if not 1 <= step <= LAST_ID:
        raise ValueError(
            f"`{term}` has no effect on the id; write a factor above 0 for `{name}`"
            if not step
            else f"`{term}` exceeds 0x{LAST_ID:X}, the last CAN id"
        )
    return step


class At(NamedTuple):
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
            f"`{text}` is outside of a frame; the last byte is 7, in CAN FD {MAX_DATA_BYTES - 1}, the last id bit is {LAST_ID_BIT}"
        )
    if id_bit is not None:
        return At(Space.ID, 0, int(id_bit))
    return At(Space.DATA, int(byte), None if bit is None else int(bit))


class Run(NamedTuple):
    """Adjacent bits of the data, both ends included; `last` is None for one whole byte or one bit."""

    first: At
    last: At | None


def run(text: str) -> Run:
    """`2` is byte 2, `2..3` are bytes 2 and 3, `4.5..4.7` are bits 5 to 7 of byte 4, `4.5` is one bit."""
    if not re.fullmatch(RUN_PATTERN, text):
        raise ValueError(f"`{text}` is not a run of bits; write bytes (2..3), bits (4.5..4.7), or one of them (2, 4.5)")
    first, _, last = text.partition("..")
    return Run(at(first), at(last) if last else None)


def run_bits(of: Run, order: Order) -> tuple[int, ...]:
    """Frame bits of a run from the least significant raw bit up; none if it is written in the other direction.

    As for `frame_bits`, a little-endian run starts at its least significant bit, a big-endian one at its most significant.
    """
    start, end = of.first, of.last or of.first
    if order is Order.LITTLE:
        first = start.byte * 8 + (start.bit or 0)
        last = end.byte * 8 + (7 if end.bit is None else end.bit)
        return tuple(range(first, last + 1))
    first = start.byte * 8 + (0 if start.bit is None else 7 - start.bit)
    last = end.byte * 8 + (7 if end.bit is None else 7 - end.bit)
    return tuple(reversed([n // 8 * 8 + (7 - n % 8) for n in range(first, last + 1)]))


class RawFormat(NamedTuple):
    """The encoding and the width of a raw integer; of each if several are `joined` to one value."""

    encoding: Encoding
    width: int
    joined: Joined | None = None

    @property
    def bits(self) -> int:
        """The bits of a field."""
        return self.width * (self.joined.count if self.joined else 1)


def raw_format(text: str) -> RawFormat:
    """`u16` unsigned, `i56` signed, `f32` and `f64` IEEE float; the number is the width in bits.

    `ascii8` and `utf8_8` are texts of 8 bytes, `bcd4` is a number of 4 decimal digits.
    """
    if not re.fullmatch(RAW_PATTERN, text):
        raise ValueError(
            f"`{text}` is not a raw format; write u or i and 1 to 64 bits (u8, i16, i56), f32, f64, or ascii8, utf8_8, bcd4"
        )
    joined = re.fullmatch("(ascii|utf8_|bcd)([0-9]+)", text)
    if joined:
        codec, count = {"ascii": "ascii", "utf8_": "utf-8"}.get(joined[1]), int(joined[2])
        if codec is None and count > MAX_DIGITS:
            raise ValueError(f"`{text}` has too many digits; write at most bcd{MAX_DIGITS}")
        kind = JoinedText(count, codec) if codec else JoinedDigits(count)
        return RawFormat(Encoding.UNSIGNED, kind.width, kind)
    width = int(text[1:])
    if text[0] == "f":
        return RawFormat(Encoding.FLOAT, width)
    return RawFormat(Encoding.SIGNED if text[0] == "i" else Encoding.UNSIGNED, width)


def code_format(text: str) -> RawFormat:
    """The raw format of a code or an index, which is unsigned."""
    raw = raw_format(text)
    if raw.encoding is not Encoding.UNSIGNED or raw.joined:
        raise ValueError(f"`{text}` is not unsigned, as codes and indices must be; write u{raw.bits}")
    return raw


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
