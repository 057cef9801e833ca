"""How a message writes its id and its data bytes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model.layout import Space, Variant
from ...model.message import Key, Message
from ...model.types import Order
from ...semantics.bits import placed
from ...semantics.plan import message_plan
from . import bits, code, text
from .class_bodies import ClassBodies, positions, storage
from .imports import Imports


class EncodeView:
    """The statements that return the data bytes: one case where all variants of a layout are written in the same way.

    `selector` is the expression of the code, if that is not constant.
    """

    def __init__(self, message: Message, bodies: ClassBodies, selector: str = "") -> None:
        layout = message.layout
        cases = [tuple(_case(message, variant, bodies, selector)) for variant in layout.variants]
        self.parameter = text.attribute(layout.parameter or "")
        self.cases = cases[:1] if len(set(cases)) == 1 else cases


def _case(message: Message, variant: Variant, bodies: ClassBodies, selector: str) -> Iterator[code.Code]:
    """One `pack`, or else an integer of each byte order; then the checksum."""
    has_checksum = message_plan(message).checksum is not None
    result = "data = " if has_checksum else "return "
    keys = [bits.key_place(k)._replace(target=f"0x{k.value:02X}") for k in message.keys]
    keys[:1] = [key._replace(target=selector or key.target) for key in keys[:1]]
    fields = positions(message, variant.fields, storage(message.layout), bodies.imports)
    in_data = [p for p in (*keys, *(p for _, p in fields)) if p.space is Space.DATA]
    ordered = sorted(in_data, key=lambda p: p.first_byte)
    pattern = bits.struct_format(ordered, message.dlc)
    if pattern is not None:
        pack = bodies.packed.setdefault(pattern, f"_PACK_{len(bodies.packed) + 1}")
        yield code.call(f"{result}{pack}", (p.target for p in ordered))
    elif in_data:
        yield from _integers(in_data, message.dlc, bodies.imports, result)
    else:
        yield f'{result}b""' if message.remote else f"{result}bytes({message.dlc})"
    if has_checksum:
        yield from bodies.checksums.insert(message)


def _integers(in_data: Sequence[bits.RawPosition], dlc: int, imports: Imports, result: str) -> Iterator[code.Code]:
    wide = {p.order for p in in_data if len(p.segments) > 1}
    order = Order.BIG if wide == {Order.BIG} else Order.LITTLE
    sides: dict[Order, list[str]] = {Order.LITTLE: [], Order.BIG: []}
    for p in in_data:
        # bits within one byte are the same in both orders
        own = p if len(p.segments) > 1 else p._replace(order=order)
        sides[own.order] += bits.terms(own, dlc)
    yield from (code.any_of(side.value, terms) for side, terms in sides.items() if terms)
    if len(wide) > 1:
        yield f"{result}{imports.use('merge')}(little, big, {dlc})"
    else:
        yield f'{result}int.to_bytes({order.value}, {dlc}, "{order.value}")'


def constant_data(message: Message) -> str:
    """The expression of the data bytes of a message without fields."""
    data = _placed_keys(message.keys, Space.DATA).to_bytes(message.dlc, "little")
    return f'bytes.fromhex("{data.hex(" ").upper()}")'


def fixed_id(message: Message) -> int:
    """The CAN id without the node, the fields, and a code that can be another one."""
    return message.id.base + _placed_keys(message.keys[bool(message_plan(message).codes) :], Space.ID)


def _placed_keys(keys: Sequence[Key], space: Space) -> int:
    return sum(placed(key.segments, key.value) for key in keys if key.space is space)


def id_terms(message: Message, imports: Imports) -> code.Code | None:
    """The assignment of the bits of the CAN id that fields, or one of several codes, fill; None without any in the id."""
    filling = [p for _, p in positions(message, message.layout.fields, storage(message.layout), imports)]
    if message_plan(message).codes:
        filling.append(bits.key_place(message.keys[0])._replace(target="self._code"))
    in_id = [term for p in filling if p.space is Space.ID for term in bits.terms(p, message.dlc)]
    return code.any_of("filled", in_id) if in_id else None


class ConfusionView(NamedTuple):
    """The condition for a frame that is identified as one of another command."""

    condition: code.Code
    command: str
    uses_id: bool


def confusion_views(message: Message) -> Iterator[ConfusionView]:
    """The conditions on `can_id` and `data`, of which bytes beyond those of the message are 0."""
    for confusion in message.confusions:
        terms: list[code.Code] = []
        for run, values in confusion.conditions:
            shown = [f"0x{value:02X}" for value in values]
            before, read = "and " if terms else "", bits.read_key(run, message.dlc)
            terms.append(
                f"{before}{read} == {shown[0]}"
                if len(shown) == 1
                else code.Items(f"{before}{read} in (", tuple(shown), ")")
            )
        uses_id = any(run.space is Space.ID for run, _ in confusion.conditions)
        yield ConfusionView(code.Parts("if ", tuple(terms), ":", optional=True), confusion.command, uses_id)
