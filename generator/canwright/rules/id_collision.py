"""No id belongs to two addresses, or to a request and a reply of different nodes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from ..model.layout import Space
from ..model.message import Address, Direction, IdRule, Message
from ..semantics.dispatch import dispatch_plan, node_of_id
from . import bit_patterns, can_ids
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    try:
        yield from _findings(subject)
    except bit_patterns.TooManyPairsError:
        text = "these addresses have too many ids in common to compare every two of them"
        yield Finding(
            ("addresses",), text, "use fewer addresses, or fewer nodes; there may be further collisions", True
        )


class _Owned(NamedTuple):
    """Ids of an address in one direction."""

    place: int
    address: Address
    direction: Direction
    ids: range

    @property
    def rule(self) -> IdRule:
        return self.address.rule(self.direction)


def _findings(subject: CheckInput) -> Findings:
    edition = subject.edition
    meetings = list(_meetings(edition))
    seen: set[tuple[DocumentPath, str]] = set()
    for direction in Direction:
        same = [met for met in meetings if met[0].direction is met[1].direction is direction]
        for later, earlier, shared in sorted(same, key=lambda met: (met[0].place, met[1].place)):
            path = _path(subject, later)
            if later.rule != earlier.rule and (path, earlier.address.name) not in seen:
                seen.add((path, earlier.address.name))
                text = f"the {direction.value} id 0x{shared:X} also belongs to `{earlier.address.name}`"
                related = RelatedItem(_path(subject, earlier), f"the id of `{earlier.address.name}`")
                yield Finding(path, text, BOTH, related=(related,))
        if not seen:
            yield from _unreachable(edition, direction)
    reported: set[tuple[Address, Address]] = set()
    for later, earlier, shared in meetings:
        pair = later.address, earlier.address
        if later.direction is earlier.direction or pair in reported:
            continue
        if later.address is earlier.address:
            finding = _between_directions(subject, later, earlier, shared)
        else:  # ids that collide in one direction usually collide in the other, too
            finding = None if seen else _between_addresses(subject, later, earlier, shared)
        if finding:
            reported.add(pair)
            yield finding


BOTH = "check `id` and `nodes` of both addresses"


def _meetings(edition: Edition) -> Iterator[tuple[_Owned, _Owned, int]]:
    """Every two sets of ids that share one, with the lowest shared id: the later set first."""
    used = {message.address for message in edition.all_messages()}
    owned = [
        _Owned(place, address, direction, ids)
        for place, address in enumerate(edition.addresses)
        for direction in Direction
        for ids in _ids(edition, direction, address, used)
    ]
    for i, j in bit_patterns.pairs([can_ids.known(its.ids) for its in owned]):
        later, earlier = owned[i], owned[j]
        is_same = (later.place, later.direction) == (earlier.place, earlier.direction)
        if _kind(later.rule) == _kind(earlier.rule) and not is_same:
            shared = can_ids.meet(later.ids, earlier.ids)
            if shared is not None:
                yield later, earlier, shared


def _kind(rule: IdRule) -> tuple[object, ...]:
    """What ids have in common that can be compared: those with a parameter only among themselves."""
    return rule.extended, rule.parameter, rule.parameter_step


def _path(subject: CheckInput, owned: _Owned) -> DocumentPath:
    """The path of the id of an address, which has one id or one for each direction."""
    address = owned.address
    return (*address.path, "id" if subject.spec.addresses[address.name].id is not None else owned.direction.value)


def _between_directions(subject: CheckInput, replies: _Owned, requests: _Owned, shared: int) -> Finding | None:
    """The finding about an id that is a request of one node of an address and a reply of another."""
    if replies.rule == requests.rule or replies.ids == requests.ids:
        return None
    return Finding(
        _path(subject, replies),
        f"the reply ids {_span(replies.ids)} overlap the request ids {_span(requests.ids)}: 0x{shared:X} is "
        f"the reply{_owner(replies, shared)} and the request{_owner(requests, shared)}",
        "check `request`, `reply` and `nodes`; if nodes reply on the id of their request, write one `id` for both",
        related=(RelatedItem(_path(subject, requests), "`request`"),),
    )


def _between_addresses(subject: CheckInput, first: _Owned, second: _Owned, shared: int) -> Finding | None:
    """The finding about an id that is a request of one address and a reply of another, for different nodes."""
    if None in (first.rule.nodes, second.rule.nodes) or _owner(first, shared) == _owner(second, shared):
        return None
    text = (
        f"0x{shared:X} is the {first.direction.value}{_owner(first, shared)} here, "
        f"and the {second.direction.value}{_owner(second, shared)} of `{second.address.name}`"
    )
    related = RelatedItem(_path(subject, second), f"the {second.direction.value} id of `{second.address.name}`")
    return Finding(_path(subject, first), text, BOTH, related=(related,))


def _owner(owned: _Owned, shared: int) -> str:
    """` of node 5`, or nothing if the id does not contain a node."""
    nodes = owned.rule.nodes
    return "" if nodes is None else f" of node {nodes[owned.ids.index(shared)]}"


def _span(ids: range) -> str:
    return f"0x{ids[0]:X}" if len(ids) == 1 else f"0x{ids[0]:X}..0x{ids[-1]:X}"


def _unreachable(edition: Edition, direction: Direction) -> Findings:
    """Findings about messages whose ids are identified as those of an earlier address, which has no such code."""
    reported: set[tuple[str, str]] = set()
    earlier: list[tuple[int, bit_patterns.Known, Message]] = []
    """For each earlier rule with variable bits of the id: these bits, the known ones, and a message."""
    for route in dispatch_plan(edition, direction).routes:
        for message in route.messages if earlier else ():
            free = can_ids.free_bits(message)
            own = can_ids.known(can_ids.of_message(message), free)
            for mask, known, taker in earlier:
                if (_kind(message.id), message.remote) != (_kind(taker.id), taker.remote):
                    continue
                if (known.value ^ own.value) & known.mask & own.mask or (message.address, taker.address) in reported:
                    continue
                shared = can_ids.meet(can_ids.of_message(message), can_ids.of_rule(taker.id), mask | free)
                if shared is not None:
                    reported.add((message.address, taker.address))
                    taken = f"the ids of this {direction.value} are identified as ids of the address `{taker.address}`"
                    text = f"{taken}, which has no such code"
                    owner = node_of_id(taker.id, shared)
                    owner_text = f"0x{shared:X} is node {owner} there: " if owner is not None else ""
                    hint = f"{owner_text}check `id`, `nodes` and `selector` of both addresses, or give it another code"
                    yield Finding(message.path, text, hint)
        if route.mask:
            earlier.append((route.mask, can_ids.known(can_ids.of_rule(route.rule), route.mask), route.messages[0]))


def _ids(edition: Edition, direction: Direction, address: Address, used: Collection[str]) -> Sequence[range]:
    """The ids of an address; if the selector is in the id, those of its messages.

    An address without messages, which is not in `used`, has all ids of its rule.
    """
    rule = address.rule(direction)
    of_address = [m for m in edition.of_rule(direction, rule) if m.address == address.name]
    if not of_address and address.name in used:
        return []
    selected = [can_ids.of_message(m) for m in of_address if any(k.space is Space.ID for k in m.keys)]
    return list(dict.fromkeys(selected)) or [can_ids.of_rule(rule)]
