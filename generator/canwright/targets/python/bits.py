"""Python expressions that read and write the bits of fields; the form is chosen at generation time."""

from __future__ import annotations

from typing import NamedTuple

from ...model.layout import Element, Field, Segment, Space, is_one_run
from ...model.message import BitRun
from ...model.types import Encoding, Order

_STRUCT = {8: "b", 16: "h", 32: "i", 64: "q"}


class RawPosition(NamedTuple):
    """The position of one raw integer on the wire; `target` is the expression that has it."""

    target: str
    space: Space
    order: Order
    signed: bool
    width: int
    segments: tuple[Segment, ...]

    @property
    def first_byte(self) -> int:
        return min(self.segments[0].byte, self.segments[-1].byte)

    @property
    def whole_bytes(self) -> bool:
        return self.is_one_run and self.space is Space.DATA and all(s.width == 8 for s in self.segments)

    @property
    def is_one_run(self) -> bool:
        return is_one_run(self.segments, self.order)

    def shift(self, dlc: int) -> int:
        """The position of the least significant bit, in the data as one integer of this byte order."""
        return self.shift_of(self.segments[0], dlc)

    def shift_of(self, lowest: Segment, dlc: int) -> int:
        """The position of the least significant bit of a segment."""
        if self.space is Space.ID or self.order is Order.LITTLE:
            return lowest.byte * 8 + lowest.low
        return (dlc - 1 - lowest.byte) * 8 + lowest.low


def place(target: str, field: Field, element: Element) -> RawPosition:
    """The place of one element of a field."""
    signed = field.type.encoding is Encoding.SIGNED
    return RawPosition(target, field.space, field.type.order, signed, field.type.width, element.segments)


def key_place(key: BitRun) -> RawPosition:
    """The place of a selector."""
    return RawPosition("", key.space, key.order, False, key.width, key.segments)


def struct_format(places: list[RawPosition], dlc: int) -> str | None:
    """The `struct` format of all places in their order; None when no format fits."""
    if not places or not all(p.whole_bytes and p.width in _STRUCT for p in places):
        return None
    orders = {p.order for p in places if p.width > 8} or {Order.LITTLE}
    starts = [p.first_byte for p in places]
    if len(orders) > 1 or starts != sorted(starts):
        return None
    text, at = "<" if orders == {Order.LITTLE} else ">", 0
    for p in places:
        code = _STRUCT[p.width]
        text += _padding(p.first_byte - at) + (code if p.signed else code.upper())
        at = p.first_byte + p.width // 8
    return text + _padding(dlc - at)


def _padding(count: int) -> str:
    return "" if count == 0 else "x" if count == 1 else f"{count}x"


def read(p: RawPosition, dlc: int) -> str:
    """The raw integer, as an expression of `data` or `can_id`."""
    mask = f"0x{(1 << p.width) - 1:X}"
    if p.space is Space.ID:
        return _signed(f"can_id >> {p.shift(dlc)} & {mask}" if p.shift(dlc) else f"can_id & {mask}", p)
    if p.whole_bytes:
        first, count = p.first_byte, p.width // 8
        if count == 1 and not p.signed:
            return f"data[{first}]"
        part = "data" if count == dlc else f"data[{first}:{first + count}]"
        signed = ", signed=True" if p.signed else ""
        return f'int.from_bytes({part}, "{p.order.value}"{signed})'
    if not p.is_one_run:
        return _signed(" | ".join(_read_segment(s) for s in p.segments), p)
    if len(p.segments) == 1:
        word, low = f"data[{p.segments[0].byte}]", p.segments[0].low
    else:
        word, low = f'int.from_bytes(data, "{p.order.value}")', p.shift(dlc)
    shifted = f"{word} >> {low} & {mask}" if low else f"{word} & {mask}"
    return _signed(shifted, p)


def _read_segment(s: Segment) -> str:
    """The bits of a segment at their place in the raw integer."""
    shifted = f"data[{s.byte}] >> {s.low}" if s.low else f"data[{s.byte}]"
    bits = shifted if s.low + s.width == 8 else f"{shifted} & 0x{(1 << s.width) - 1:X}"
    return f"({bits}) << {s.raw_low}" if s.raw_low else f"({bits})" if bits != f"data[{s.byte}]" else bits


def data_byte(key: BitRun) -> int | None:
    """The position of the data byte that a selector is; None for any other bits."""
    p = key_place(key)
    return p.first_byte if p.whole_bytes and p.width == 8 else None


def read_key(key: BitRun, shortest: int) -> str:
    """The value of a selector, other than one data byte, in data of at least `shortest` bytes.

    Bytes beyond the data are left out.
    """
    p = key_place(key)
    if p.space is Space.ID:
        return read(p, 0)
    first, last = p.first_byte, max(s.byte for s in p.segments)
    low = p.segments[0].low
    word = f'int.from_bytes(data[{first}:{last + 1}], "{p.order.value}")'
    if first == last < shortest:
        word = f"data[{first}]"
    if p.whole_bytes:
        return word
    mask = f"0x{(1 << p.width) - 1:X}"
    return f"{word} >> {low} & {mask}" if low else f"{word} & {mask}"


def _signed(expression: str, p: RawPosition) -> str:
    sign = f"0x{1 << (p.width - 1):X}"
    return f"(({expression}) ^ {sign}) - {sign}" if p.signed else expression


def write(p: RawPosition, dlc: int) -> str:
    """The raw integer shifted to its position, in the data as one integer of its byte order."""
    return " | ".join(terms(p, dlc))


def terms(p: RawPosition, dlc: int) -> list[str]:
    """The terms of the same, which `|` combines."""
    if not p.is_one_run:
        return [_write_segment(p, s, dlc) for s in p.segments]
    mask = f"0x{(1 << p.width) - 1:X}"
    shift = p.shift(dlc)
    return [f"({p.target} & {mask}) << {shift}" if shift else f"{p.target} & {mask}"]


def _write_segment(p: RawPosition, s: Segment, dlc: int) -> str:
    """The bits of a segment at their position in the data."""
    shifted = f"{p.target} >> {s.raw_low}" if s.raw_low else p.target
    bits = f"{shifted} & 0x{(1 << s.width) - 1:X}"
    shift = p.shift_of(s, dlc)
    return f"({bits}) << {shift}" if shift else f"({bits})"
