"""How a message writes its id and its data bytes."""

from __future__ import annotations

from dataclasses import dataclass

from ...model.layout import Space, Variant
from ...model.message import Message
from ...model.types import Order
from . import bits, code, text
from .fields import positions, storage
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class EncodeCaseView:
    """The statements that return the data bytes, by the `struct` that writes them or without one."""

    struct: str
    items: tuple[str, ...]
    """What the `struct` writes."""
    statements: tuple[code.Code, ...]


@dataclass(frozen=True, kw_only=True)
class EncodeView:
    """How a message writes its data bytes: one case where all variants of its layout are written in the same way."""

    parameter: str
    cases: tuple[EncodeCaseView, ...]


def encode_view(message: Message, imports: Imports, selector: str = "") -> EncodeView:
    """How a message writes its bytes; `selector` is the expression of the selector's value, if it is not constant."""
    layout = message.layout
    cases = tuple(_case(message, variant, selector, imports) for variant in layout.variants)
    return EncodeView(
        parameter=text.attribute(layout.parameter or ""), cases=cases[:1] if len(set(cases)) == 1 else cases
    )


def _case(message: Message, variant: Variant, selector: str, imports: Imports) -> EncodeCaseView:
    """One `pack`, or else an integer of each byte order."""
    keys = [bits.key_place(k)._replace(target=selector or f"0x{k.value:02X}") for k in message.keys]
    fields = positions(variant.fields, storage(message.layout))
    in_data = [p for p in (*keys, *(p for _, p in fields)) if p.space is Space.DATA]
    ordered = sorted(in_data, key=lambda p: p.first_byte)
    pattern = bits.struct_format(ordered, message.dlc)
    if pattern is not None:
        return EncodeCaseView(struct=pattern, items=tuple(p.target for p in ordered), statements=())
    if not in_data:
        data = 'b""' if message.remote else f"bytes({message.dlc})"
        return EncodeCaseView(struct="", items=(), statements=(f"return {data}",))
    wide = {p.order for p in in_data if len(p.segments) > 1}
    order = Order.BIG if wide == {Order.BIG} else Order.LITTLE
    sides: dict[Order, list[str]] = {Order.LITTLE: [], Order.BIG: []}
    for p in in_data:
        # bits within one byte are the same in both orders
        own = p if len(p.segments) > 1 else p._replace(order=order)
        sides[own.order].append(bits.write(own, message.dlc))
    statements: list[code.Code] = [code.any_of(side.value, terms) for side, terms in sides.items() if terms]
    if len(wide) > 1:
        statements.append(f"return {imports.use('merge')}(little, big, {message.dlc})")
    else:
        statements.append(f'return int.to_bytes({order.value}, {message.dlc}, "{order.value}")')
    return EncodeCaseView(struct="", items=(), statements=tuple(statements))


def constant_data(message: Message) -> str:
    """The expression of the data bytes of a message without fields."""
    data = bytearray(message.dlc)
    for key in message.keys:
        for s in key.segments if key.space is Space.DATA else ():
            data[s.byte] |= (key.value >> s.raw_low & (1 << s.width) - 1) << s.low
    return f'bytes.fromhex("{data.hex(" ").upper()}")'


def fixed_id(message: Message) -> int:
    """The CAN id without the node and the fields."""
    keys = (k for k in message.keys if k.space is Space.ID)
    return message.id.base + sum(k.value << k.segments[0].low for k in keys)


def id_terms(message: Message) -> code.Code | None:
    """The assignment of the bits of the CAN id that fields fill; None for a message without fields in its id."""
    fields = positions(message.layout.fields, storage(message.layout))
    in_id = [bits.write(position, message.dlc) for _, position in fields if position.space is Space.ID]
    return code.any_of("filled", in_id) if in_id else None
