"""The position of a big-endian field or selector of less than a byte has the number of a bit."""

from __future__ import annotations

from ..language.concept import parts
from ..language.edition import EditionSpec, FieldSpec, Selector
from ..model.layout import Space
from ..model.types import Order
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for path, part in parts(subject.spec):
        if not isinstance(part, FieldSpec | Selector):
            continue
        if isinstance(part.at, list):
            continue  # each run states its bits
        width, order = _format(subject.spec, part)
        if width < 8 and order is Order.BIG and part.at.space is Space.DATA and part.at.bit is None:
            name = f"`{path[-1]}`" if isinstance(part, FieldSpec) else "this selector"
            text = f"{name} is big-endian and at byte {part.at.byte}, without a bit number: it starts at bit 7, the highest"
            yield Finding((*path, "at"), text, _hint(part, part.at.byte, width))


def _format(spec: EditionSpec, part: FieldSpec | Selector) -> tuple[int, Order]:
    """Width and byte order."""
    if isinstance(part, FieldSpec) and part.type is not None:
        type_ = spec.types[part.type]
        return type_.raw.bits, type_.byte_order or spec.byte_order
    return part.raw.bits if part.raw else 8, part.byte_order or spec.byte_order


def _hint(part: FieldSpec | Selector, byte: int, width: int) -> str:
    count = len(part.array or ()) if isinstance(part, FieldSpec) else 0
    if count:
        return f"write at: {byte}.7 if the first element is the highest; otherwise {byte}.0 and `byte_order: little`"
    if width == 1:
        return f"write at: {byte}.7 for the highest bit of the byte, or {byte}.0 for the lowest"
    return f"write at: {byte}.7 for bits {8 - width} to 7 of the byte, or {byte}.{width - 1} for bits 0 to {width - 1}"
