"""No id belongs to two addresses of one direction, unless all their ids are equal."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import EditionSpec
from ..model.edition import Edition
from ..model.layout import Space
from ..model.message import Address, Direction, Message
from ..semantics.dispatch import dispatch_plan, node_of_id
from . import bit_patterns, can_ids
from .rule import Finding, Findings, Subject


def check(subject: Subject) -> Findings:
    edition = subject.edition
    seen: set[tuple[DocumentPath, str]] = set()
    for direction in Direction:
        for (address, other), shared in sorted(_shared(subject, direction).items()):
            one, two = edition.addresses[address], edition.addresses[other]
            own = subject.spec.addresses[one.name].id is None
            path: DocumentPath = (*one.path, direction.value if own else "id")
            if one.rule(direction) != two.rule(direction) and (path, two.name) not in seen:
                seen.add((path, two.name))
                text = f"the {direction.value} id 0x{shared:X} also belongs to `{two.name}`"
                yield Finding(path, text, "check `id` and `nodes` of both addresses")
        if not seen and not subject.partial:
            yield from _unreachable(edition, direction)


def _unreachable(edition: Edition, direction: Direction) -> Findings:
    """Findings about messages owner_text ids another address takes first, without a message of their code."""
    reported: set[tuple[str, str]] = set()
    earlier: list[tuple[int, bit_patterns.Known, Message]] = []
    """For each earlier rule with variable bits of the id: these bits, the known ones, and a message."""
    for route in dispatch_plan(edition.messages(direction)).routes:
        for message in route.messages if earlier else ():
            free = can_ids.free_bits(message)
            own = can_ids.known(can_ids.of_message(message), free)
            for mask, known, other in earlier:
                if (message.id.extended, message.remote) != (other.id.extended, other.remote):
                    continue
                if (known.value ^ own.value) & known.mask & own.mask or (message.address, other.address) in reported:
                    continue
                shared = can_ids.meet(can_ids.of_message(message), can_ids.of_rule(other.id), mask | free)
                if shared is not None:
                    reported.add((message.address, other.address))
                    taken = f"the ids of this {direction.value} are identified as ids of the address `{other.address}`"
                    text = f"{taken}, which has no such code"
                    owner = node_of_id(other.id, shared)
                    owner_text = f"0x{shared:X} is node {owner} there: " if owner is not None else ""
                    hint = f"{owner_text}check `id`, `nodes` and `selector` of both addresses, or give it another code"
                    yield Finding(message.path, text, hint)
        if route.mask:
            earlier.append((route.mask, can_ids.known(can_ids.of_rule(route.rule), route.mask), route.messages[0]))


def _shared(subject: Subject, direction: Direction) -> dict[tuple[int, int], int]:
    """The indices of every two addresses that share an id, the later one first, with the lowest shared id."""
    edition = subject.edition
    used = {message.address for message in edition.all_messages()}
    owned = [
        (place, its)
        for place, one in enumerate(edition.addresses)
        if not (subject.partial and _is_selected_by_id(subject.spec, one.name))
        for its in _ids(edition, direction, one, used)
    ]
    found: dict[tuple[int, int], int] = {}
    for i, j in bit_patterns.pairs([can_ids.known(its) for _, its in owned]):
        (address, first), (other, second) = owned[i], owned[j]
        same_format = edition.addresses[address].request.extended == edition.addresses[other].request.extended
        shared = can_ids.meet(first, second) if address != other and same_format else None
        if shared is not None:
            found.setdefault((address, other), shared)
    return found


def _is_selected_by_id(spec: EditionSpec, address: str) -> bool:
    """Whether the ids of an address depend on its commands."""
    written = spec.addresses[address]
    selectors = (written.selector, written.reply_selector, spec.selector)
    return any(selector is not None and selector.at.space is Space.ID for selector in selectors)


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
