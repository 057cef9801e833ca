"""Which messages share the bits that tell them apart: the same id rule and the same places of keys."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from functools import reduce
from operator import or_
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Segment, Space
from ...model.message import Direction, Message


class Form(NamedTuple):
    """What messages have in common that are matched and stamped alike, but for length and codes."""

    address: str
    direction: Direction
    remote: bool
    id_mask: int
    places: tuple[tuple[Space, int, tuple[Segment, ...]], ...]


def form_of(message: Message) -> Form:
    return Form(
        message.address,
        message.direction,
        message.remote,
        message.id_mask,
        tuple((key.space, key.width, key.segments) for key in message.keys),
    )


def named_forms(forms: Iterable[Form]) -> dict[Form, tuple[str, ...]]:
    """What the name of each form is made of: address and direction, and a number from the second one on."""
    result: dict[Form, tuple[str, ...]] = {}
    numbers: Counter[tuple[str, str]] = Counter()
    for form in dict.fromkeys(forms):
        name = (form.address, form.direction.value)
        numbers[name] += 1
        result[form] = name if numbers[name] == 1 else (*name, str(numbers[name]))
    return result


def address_mask(edition: Edition, address: str, direction: Direction) -> int:
    """Bits of the id that keys and fields fill in some message of this direction."""
    here = edition.address(address)
    rule = here.rule(direction)
    return reduce(or_, (m.id_mask for m in edition.of_rule(direction, rule)), 0)
