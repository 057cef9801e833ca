"""No id belongs to two addresses of one direction, unless all their ids are the same."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Address, Direction, Edition, IdRule, Space
from . import ids
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    edition = subject.edition
    for direction in Direction:
        for i, address in enumerate(edition.addresses):
            for other in edition.addresses[:i]:
                shared = _shared(edition, direction, address, other)
                if shared is not None and _rule(address, direction) != _rule(other, direction):
                    text = f"the {direction.value} id 0x{shared:X} belongs to `{other.name}` as well"
                    yield Finding(address.path, text, "check `id` and `nodes` of both")


def _shared(edition: Edition, direction: Direction, one: Address, other: Address) -> int | None:
    if one.request.extended != other.request.extended:
        return None
    for first in _ids(edition, direction, one):
        for second in _ids(edition, direction, other):
            found = ids.meet(first, second)
            if found is not None:
                return found
    return None


def _ids(edition: Edition, direction: Direction, address: Address) -> Sequence[range]:
    """The ids of an address; where the selector is in the id, those of its messages."""
    of_address = [m for m in edition.messages(direction) if m.address == address.name]
    selected = [ids.of_message(m) for m in of_address if any(k.space is Space.ID for k in m.keys)]
    rule = _rule(address, direction)
    return list(dict.fromkeys(selected)) or [ids.of_rule(rule)]


def _rule(address: Address, direction: Direction) -> IdRule:
    return address.request if direction is Direction.REQUEST else address.reply
