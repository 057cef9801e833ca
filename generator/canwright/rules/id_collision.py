"""No id belongs to two addresses of one direction, unless all their ids are the same."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Address, Direction, Edition, Space
from . import alike, ids
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    edition = subject.edition
    for direction in Direction:
        for (address, other), shared in sorted(_shared(edition, direction).items()):
            one, two = edition.addresses[address], edition.addresses[other]
            if one.rule(direction) != two.rule(direction):
                text = f"the {direction.value} id 0x{shared:X} belongs to `{two.name}` as well"
                yield Finding(one.path, text, "check `id` and `nodes` of both")


def _shared(edition: Edition, direction: Direction) -> dict[tuple[int, int], int]:
    """The places of every two addresses that share an id, the later one first, with the first id that they share."""
    owned = [(place, its) for place, one in enumerate(edition.addresses) for its in _ids(edition, direction, one)]
    found: dict[tuple[int, int], int] = {}
    for i, j in alike.pairs([ids.known(its) for _, its in owned]):
        (address, first), (other, second) = owned[i], owned[j]
        same_format = edition.addresses[address].request.extended == edition.addresses[other].request.extended
        shared = ids.meet(first, second) if address != other and same_format else None
        if shared is not None:
            found.setdefault((address, other), shared)
    return found


def _ids(edition: Edition, direction: Direction, address: Address) -> Sequence[range]:
    """The ids of an address; where the selector is in the id, those of its messages."""
    rule = address.rule(direction)
    of_address = [m for m in edition.of_rule(direction, rule) if m.address == address.name]
    selected = [ids.of_message(m) for m in of_address if any(k.space is Space.ID for k in m.keys)]
    return list(dict.fromkeys(selected)) or [ids.of_rule(rule)]
