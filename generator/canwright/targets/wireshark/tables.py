"""The tables of an edition as the runtime interprets them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from ...model import formatting
from ...model.layout import Field, ReservedRole, Space
from ...model.message import Command, Message
from ...model.types import Linear, Type
from ...semantics.frame import data_bits
from ..nested_source import Code, Table, Value
from ..tables import EditionTables
from . import text


class LuaTables(EditionTables):
    """Numbers are doubles; the titles of fields and flags are part of the tables."""

    unknown = False

    def view(self) -> Table:
        """The argument of `codec.edition`."""
        return {
            "name": self.edition.name,
            "reply_within": _nanoseconds(self.edition.bus.reply_within_ms),
            **self.tables(),
        }

    def integer(self, raw: int, width: int) -> Value:
        return text.key(raw, width)

    def type(self, type_: Type) -> dict[str, Value]:
        flags: list[Value] = [[m.value, m.name, text.english(m.title) or m.name] for m in type_.flags]
        return {**super().type(type_), "flags": flags or None, "limits": _limits(type_)}

    def linear(self, linear: Linear) -> Value:
        factor, addend, divisor = map(text.number, linear.as_quotient)
        if max(map(abs, linear.as_quotient)) > text.EXACT:
            factor, addend, divisor = text.number(linear.scale), text.number(linear.offset), Code("1.0")
        return {
            "identity": linear.is_identity or None,
            "factor": factor,
            "addend": addend,
            "divisor": divisor,
            "times": linear.times,
        }

    def field(self, field: Field) -> dict[str, Value]:
        return {**super().field(field), "label": text.english(field.title) or formatting.spoken(field.name)}

    def message(self, message: Message) -> dict[str, Value]:
        return {**super().message(message), "reserved": list(_reserved(message))}

    def answer(self, command: Command, request: Message, reply: Message) -> dict[str, Value]:
        """`distinct` requests have reserved bits that the reply uses."""
        return {
            **super().answer(command, request, reply),
            "distinct": True if _reserved_mask(request) & ~_reserved_mask(reply) else None,
            "reply_within": _nanoseconds(command.reply_within_ms),
        }


def _nanoseconds(milliseconds: Fraction | None) -> Value:
    return None if milliseconds is None else text.number(milliseconds * 1_000_000)


def _limits(type_: Type) -> Value:
    """The smallest and the largest allowed raw integer under any parameters; None if they are unknown."""
    spans = [span for _, span in type_.raw_range.distinct()]
    known = [span for span in spans if span is not None and span.is_constant]
    if not known or len(known) < len(spans):
        return None
    lows, highs = zip(*((span.low.constant, span.high.constant) for span in known), strict=True)
    return [text.number(min(lows)), text.number(max(highs))]


def _reserved_mask(message: Message) -> int:
    """The data bits that a sender always writes with the same value and a receiver ignores."""
    used = [field for field in message.layout.fields if field not in _reserved_fields(message)]
    taken = data_bits((field.space, element.segments) for field in used for element in field.elements)
    keys = data_bits((key.space, key.segments) for key in message.keys)
    return (1 << 8 * message.dlc) - 1 & ~(taken | keys)


def _reserved_fields(message: Message) -> Sequence[Field]:
    return [f for f in message.layout.fields if isinstance(f.role, ReservedRole) and not f.only]


def _reserved(message: Message) -> Iterator[Value]:
    """Runs of reserved bits within a byte: the byte, the position, the width, and the value."""
    value = 0
    for field in _reserved_fields(message):
        for element in field.elements if field.space is Space.DATA else ():
            for s in element.segments:
                bits = (field.role.sent_raw or 0) >> s.raw_low & (1 << s.width) - 1
                value |= bits << s.byte * 8 + s.low
    mask = _reserved_mask(message)
    for byte in range(message.dlc):
        for low, width in _runs(mask >> 8 * byte & 0xFF):
            yield [byte, low, width, value >> 8 * byte + low & (1 << width) - 1]


def _runs(mask: int) -> Iterator[tuple[int, int]]:
    """The lowest bit and the width of each run of bits that are set."""
    low = 0
    while mask >> low:
        if mask >> low & 1:
            width = ((mask >> low) ^ (mask >> low) + 1).bit_length() - 1
            yield low, width
            low += width
        else:
            low += 1
