"""No id belongs to two addresses, or to a request and a reply of different nodes."""

from __future__ import annotations

from collections.abc import Collection, Sequence

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


def _findings(subject: CheckInput) -> Findings:
    edition = subject.edition
    seen: set[tuple[DocumentPath, str]] = set()
    for direction in Direction:
        for (index, earlier), shared in sorted(_shared(subject, direction).items()):
            address, earlier_address = edition.addresses[index], edition.addresses[earlier]
            path = _path(subject, address, direction)
            if address.rule(direction) != earlier_address.rule(direction) and (path, earlier_address.name) not in seen:
                seen.add((path, earlier_address.name))
                text = f"the {direction.value} id 0x{shared:X} also belongs to `{earlier_address.name}`"
                related = RelatedItem(_path(subject, earlier_address, direction), f"the id of `{earlier_address.name}`")
                yield Finding(path, text, "check `id` and `nodes` of both addresses", related=(related,))
        if not seen:
            yield from _unreachable(edition, direction)
    yield from _between_directions(subject)
    if not seen:  # ids that collide in one direction usually collide in the other, too
        yield from _between_addresses(subject)


def _path(subject: CheckInput, address: Address, direction: Direction) -> DocumentPath:
    """The path of the id of an address, which has one id or one for each direction."""
    return (*address.path, "id" if subject.spec.addresses[address.name].id is not None else direction.value)


def _between_directions(subject: CheckInput) -> Findings:
    """Findings about ids that are requests of one node and replies of another."""
    edition = subject.edition
    for address in edition.addresses:
        rules = address.request, address.reply
        if rules[0] == rules[1]:
            continue
        used = {message.address for message in edition.all_messages()}
        owned = [(direction, its) for direction in Direction for its in _ids(edition, direction, address, used)]
        for i, j in bit_patterns.pairs([can_ids.known(its) for _, its in owned]):
            (direction, replies), (other_direction, requests) = owned[i], owned[j]
            shared = (
                can_ids.meet(replies, requests) if direction is not other_direction and replies != requests else None
            )
            if shared is not None:
                yield _shared_by_directions(subject, address, replies, requests, shared)
                break


def _between_addresses(subject: CheckInput) -> Findings:
    """Findings about ids that are requests of one address and replies of another, for different nodes."""
    edition = subject.edition
    used = {message.address for message in edition.all_messages()}
    owned = [
        (address, direction, ids)
        for address in edition.addresses
        for direction in Direction
        for ids in _ids(edition, direction, address, used)
    ]
    seen: set[tuple[str, str]] = set()
    for i, j in bit_patterns.pairs([can_ids.known(ids) for *_, ids in owned]):
        (address, direction, first), (other_address, other_direction, second) = owned[i], owned[j]
        rule, other_rule = address.rule(direction), other_address.rule(other_direction)
        if (
            direction is other_direction
            or address is other_address
            or (address.name, other_address.name) in seen
            or rule.extended != other_rule.extended
        ):
            continue
        shared = can_ids.meet(first, second) if None not in (rule.nodes, other_rule.nodes) else None
        if shared is not None and _owner(rule, first, shared) != _owner(other_rule, second, shared):
            seen.add((address.name, other_address.name))
            text = (
                f"0x{shared:X} is the {direction.value}{_owner(rule, first, shared)} here, "
                f"and the {other_direction.value}{_owner(other_rule, second, shared)} of `{other_address.name}`"
            )
            related = RelatedItem(
                _path(subject, other_address, other_direction),
                f"the {other_direction.value} id of `{other_address.name}`",
            )
            path = _path(subject, address, direction)
            yield Finding(path, text, "check `id` and `nodes` of both addresses", related=(related,))


def _shared_by_directions(
    subject: CheckInput, address: Address, replies: range, requests: range, shared: int
) -> Finding:
    paths = {direction: _path(subject, address, direction) for direction in Direction}
    owners = {
        direction: _owner(address.rule(direction), ids, shared)
        for direction, ids in ((Direction.REQUEST, requests), (Direction.REPLY, replies))
    }
    return Finding(
        paths[Direction.REPLY],
        f"the reply ids {_span(replies)} overlap the request ids {_span(requests)}: 0x{shared:X} is "
        f"the reply{owners[Direction.REPLY]} and the request{owners[Direction.REQUEST]}",
        "check `request`, `reply` and `nodes`; if nodes reply on the id of their request, write one `id` for both",
        related=(RelatedItem(paths[Direction.REQUEST], "`request`"),),
    )


def _owner(rule: IdRule, ids: range, shared: int) -> str:
    """` of node 5`, or nothing if the id does not contain a node; `ids` are those of the rule and of keys in the id."""
    return "" if rule.nodes is None else f" of node {rule.nodes[ids.index(shared)]}"


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
                if (message.id.extended, message.remote) != (taker.id.extended, taker.remote):
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


def _shared(subject: CheckInput, direction: Direction) -> dict[tuple[int, int], int]:
    """The indices of every two addresses that share an id, the later one first, with the lowest shared id."""
    edition = subject.edition
    used = {message.address for message in edition.all_messages()}
    owned = [
        (place, its)
        for place, address in enumerate(edition.addresses)
        for its in _ids(edition, direction, address, used)
    ]
    lowest: dict[tuple[int, int], int] = {}
    for i, j in bit_patterns.pairs([can_ids.known(its) for _, its in owned]):
        (address, first), (earlier, second) = owned[i], owned[j]
        same_format = edition.addresses[address].request.extended == edition.addresses[earlier].request.extended
        shared = can_ids.meet(first, second) if address != earlier and same_format else None
        if shared is not None:
            lowest.setdefault((address, earlier), shared)
    return lowest


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
