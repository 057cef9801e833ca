"""The tables of an edition as the runtime interprets them."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ...model import formatting
from ...model.layout import Field
from ...model.message import Message
from ...model.types import Linear, Type
from ...semantics.exchange import ExchangePlan
from ...semantics.plan import message_plan
from ...semantics.valid_raws import RawInterval, merged, valid_raws
from ..field_contents import Content
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
            "hash": self.edition.hash,
            "reply_within": _nanoseconds(self.edition.bus.reply_within_ms),
            **self.tables(),
        }

    def integer(self, raw: int, width: int) -> Value:
        return text.key(raw, width)

    def type(self, type_: Type) -> dict[str, Value]:
        flags: list[Value] = [[m.value, m.name, text.english(m.title) or m.name] for m in type_.flags]
        no_values: list[Value] = [[*_halves(n.raws[0]), *_halves(n.raws[-1]), n.name] for n in type_.no_values]
        return {
            **super().type(type_),
            "flags": flags or None,
            "limits": _limits(type_),
            "no_values": no_values or None,
        }

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

    def field(self, field: Field, content: Content | None) -> dict[str, Value]:
        return {**super().field(field, content), "label": text.english(field.title) or formatting.spoken(field.name)}

    def message(self, message: Message) -> dict[str, Value]:
        """A message with all that the dissector checks and shows of it."""
        sending = formatting.sending(message.sending) if message.sending else None
        return {
            **super().message(message),
            **self.checked(message),
            "reserved": list(_reserved(message)),
            "sending": sending,
        }

    def answer(self, exchange: ExchangePlan) -> dict[str, Value]:
        return {
            **super().answer(exchange),
            "distinct": exchange.has_distinct_request or None,
            "reply_within": _nanoseconds(exchange.command.reply_within_ms),
        }


def _nanoseconds(milliseconds: Fraction | None) -> Value:
    return None if milliseconds is None else text.number(milliseconds * 1_000_000)


def _halves(raw: int) -> tuple[int, int]:
    """A raw integer as its higher bits, with the sign, and its lower 32 bits."""
    return raw >> 32, raw & 0xFFFFFFFF


def _limits(type_: Type) -> Value:
    """The smallest and the largest valid raw integer under any parameters; None if all of its width can be valid."""
    low, high = type_.number_limits
    known = [valid for _, valid in valid_raws(type_).distinct() if isinstance(valid, RawInterval)]
    if not known or any(valid.low_bound or valid.high_bound for valid in known):
        return None
    ends = min(valid.low for valid in known), max(valid.high for valid in known)
    return None if ends == (low, high) else [text.number(end) for end in ends]


def _reserved(message: Message) -> Iterator[Value]:
    """Runs of reserved bits within a byte: the byte, the position, the width, and the value."""
    reserved = message_plan(message).reserved
    for byte in range(message.dlc):
        bits = (range(bit, bit + 1) for bit in range(8) if reserved.mask >> 8 * byte + bit & 1)
        for run in merged(bits):
            yield [byte, run.start, len(run), reserved.value >> 8 * byte + run.start & (1 << len(run)) - 1]
