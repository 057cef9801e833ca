"""How a message writes its id and its data bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...model.layout import Space, Variant
from ...model.message import Message
from ...model.types import Order, Parameter
from . import bits, text
from .class_bodies import variant_values
from .fields import places
from .imports import Imports


@dataclass(frozen=True, kw_only=True)
class EncodeCaseView:
    """The expression of the data bytes under some values of the layout's parameter."""

    values: tuple[str, ...]
    expression: str


@dataclass(frozen=True, kw_only=True)
class EncodeView:
    """The data bytes of a message; `parameter` decides among several cases."""

    parameter: str
    cases: tuple[EncodeCaseView, ...]


def encode_view(message: Message, parameters: Mapping[str, Parameter], imports: Imports, code: str = "") -> EncodeView:
    """How a message writes its bytes; `code` is the expression of the selector's value, if it is not constant."""
    layout = message.layout
    cases = (
        EncodeCaseView(
            values=variant_values(layout, variant, parameters), expression=_data(message, variant, code, imports)
        )
        for variant in layout.variants
    )
    return EncodeView(parameter=text.attribute(layout.parameter or ""), cases=tuple(cases))


def _data(message: Message, variant: Variant, code: str, imports: Imports) -> str:
    """The expression of the data bytes: one `pack`, or else an integer of each byte order."""
    keys = [bits.key_place(k)._replace(target=code or f"0x{k.value:02X}") for k in message.keys]
    in_data = [p for p in (*keys, *(p for _, p in places(variant.fields))) if p.space is Space.DATA]
    ordered = sorted(in_data, key=lambda p: p.first_byte)
    pattern = bits.struct_format(ordered, message.dlc)
    if pattern is not None:
        return f'{imports.use("pack")}("{pattern}", {", ".join(p.target for p in ordered)})'
    if not in_data:
        return f"bytes({message.dlc})"
    wide = {p.order for p in in_data if len(p.segments) > 1}
    order = Order.BIG if wide == {Order.BIG} else Order.LITTLE
    sides: dict[Order, list[str]] = {Order.LITTLE: [], Order.BIG: []}
    for p in in_data:
        # bits within one byte are the same in both orders
        own = p if len(p.segments) > 1 else p._replace(order=order)
        sides[own.order].append(f"({bits.write(own, message.dlc)})")
    little, big = (" | ".join(sides[side]) for side in (Order.LITTLE, Order.BIG))
    if len(wide) > 1:
        return f"{imports.use('merge')}({little}, {big}, {message.dlc})"
    return f'({little or big}).to_bytes({message.dlc}, "{order.value}")'


def constant_data(message: Message) -> str:
    """The expression of the data bytes of a message without fields."""
    data = bytearray(message.dlc)
    for key in message.keys:
        for s in key.segments if key.space is Space.DATA else ():
            data[s.byte] |= (key.value >> s.raw_low & (1 << s.width) - 1) << s.low
    return repr(bytes(data))


def fixed_id(message: Message) -> int:
    """The CAN id without the node and the fields."""
    keys = (k for k in message.keys if k.space is Space.ID)
    return message.id.base + sum(k.value << k.segments[0].low for k in keys)


def can_id(message: Message) -> str:
    """The expression of the CAN id of a message with fields in its id; empty for any other."""
    in_id = places(f for f in message.layout.fields if f.space is Space.ID)
    terms = (f" + ({bits.write(place, message.dlc)})" for _, place in in_id)
    return f"super().can_id{''.join(terms)}" if in_id else ""
