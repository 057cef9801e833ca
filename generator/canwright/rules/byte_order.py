"""Big-endian fields at the position of their lowest byte, which other tools state."""

from __future__ import annotations

from ..model.layout import Field
from ..model.types import Order


def highest_byte(field: Field) -> int | None:
    """The highest byte of a big-endian field of whole bytes if `at` is its lowest byte; None for other fields."""
    size, bits = field.type.width // 8, field.elements[0].bits
    if field.type.order is not Order.BIG or field.type.width % 8 or size < 2 or len(field.elements) > 1:
        return None
    if max(bits) - min(bits) >= field.type.width:
        return None
    start = min(bits) // 8 - size + 1
    return start if start >= 0 and min(bits) % 8 == 0 else None
