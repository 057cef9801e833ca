"""Fields and keys of one message do not overlap."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import EditionSpec
from ..model.layout import Field, Space, Variant, bits_of
from ..model.message import Direction, Key, KeyRole, Message
from ..model.types import Order
from .byte_order import highest_byte
from .rule import CheckInput, Finding, Findings, RelatedItem

HIGHEST = "; `at` is the highest bit of a big-endian field"
INDEX = "the table's index"
APART = "move one of them, or give them different `only`"
WITHOUT_INDEX = (
    "move it; if replies do not contain the index, define them once as a separate command with `request: none`, and "
    "write `reply: {of: COMMAND}` here"
)


MAX_OVERLAPS = 20
"""The maximum number of findings about one message. A frame is full after a few fields, so that a search that ends
after this number of overlaps takes a time that does not depend on the number of fields."""


def check(subject: CheckInput) -> Findings:
    reported: set[Finding] = set()
    compared = set()
    for message in subject.edition.all_messages():
        keys = tuple((key.role, key.space, key.segments) for key in message.keys)
        table = subject.spec.commands[str(message.path[1])].table
        parts = (message.layout, message.direction, message.address, table, keys)
        if parts in compared:
            continue
        compared.add(parts)
        clashes = (
            finding for variant in message.layout.variants for finding in _some_clashes(subject.spec, message, variant)
        )
        new = list(
            itertools.islice((finding for finding in dict.fromkeys(clashes) if finding not in reported), MAX_OVERLAPS)
        )
        reported.update(new)
        if len(new) == MAX_OVERLAPS:
            new[-1] = new[-1]._replace(message=f"{new[-1].message}; further overlaps of this message are not listed")
        yield from new


def _some_clashes(spec: EditionSpec, message: Message, variant: Variant) -> Findings:
    return itertools.islice(_clashes(spec, message, variant), MAX_OVERLAPS)


def _clashes(spec: EditionSpec, message: Message, variant: Variant) -> Findings:
    taken: dict[Space, dict[int, RelatedItem]] = {space: {} for space in Space}
    for key in message.keys:
        bits, owners = bits_of(key.segments), taken[key.space]
        clash = next(filter(owners.__contains__, bits), None)
        if clash is not None and key.role is KeyRole.INDEX:
            text = f"the table's index shares {_where(key.space, clash)} with {owners[clash].item}"
            yield Finding(_path_of(spec, message, key), text, "move one of them", related=(owners[clash],))
        owners.update(dict.fromkeys(bits, _item(spec, message, key)))
    for field in variant.fields:
        owners = taken[field.space]
        for element in field.elements:
            clash = next(filter(owners.__contains__, element.bits), None)
            misplaced = clash is not None and _misplaced(message, variant, field, owners[clash])
            if clash is not None and misplaced:
                path, text, hint = misplaced
                both = (owners[clash], RelatedItem((*field.path, "at"), f"`{field.name}`"))
                yield Finding(path, text, hint, related=tuple(item for item in both if item.path != path))
            elif clash is not None:
                hint = WITHOUT_INDEX if owners[clash].item == INDEX and message.direction is Direction.REPLY else APART
                if field.type.order is Order.BIG and field.type.width % 8 and field.space is Space.DATA:
                    hint += HIGHEST
                text = f"`{field.name}` shares {_where(field.space, clash)} with {owners[clash].item}"
                yield Finding((*field.path, "at"), text, hint, related=(owners[clash],))
            owners.update(dict.fromkeys(element.bits, RelatedItem((*field.path, "at"), f"`{field.name}`")))


def _misplaced(
    message: Message, variant: Variant, field: Field, owner: RelatedItem
) -> tuple[DocumentPath, str, str] | None:
    """Path, text and hint for a big-endian field at its lowest byte; None if its bytes would not be free before that."""
    fields = {(*placed.path, "at"): placed for placed in variant.fields if placed.space is Space.DATA}
    for path in (owner.path, (*field.path, "at")):
        start = highest_byte(fields[path]) if path in fields else None
        if start is not None:
            size = fields[path].type.width // 8
            wanted = set(range(start * 8, (start + size) * 8))
            keys = {bit for key in message.keys if key.space is Space.DATA for bit in bits_of(key.segments)}
            used = {b for at, placed in fields.items() if at != path for e in placed.elements for b in e.bits} | keys
            if wanted.isdisjoint(used) or wanted.isdisjoint(_lowered(fields, path) | keys):
                name = fields[path].name
                last = start + size - 1
                text = f"`{name}` is big-endian and uses bytes {last} to {last + size - 1}, where other fields are"
                return path, text, f"`at` is the first, highest byte: write at: {start} for bytes {start} to {last}"
    return None


def _lowered(fields: Mapping[DocumentPath, Field], path: DocumentPath) -> set[int]:
    """The bits of all other fields if every big-endian one is at its lowest byte, too."""
    bits: set[int] = set()
    for at, field in fields.items():
        start = highest_byte(field)
        if at != path:
            size = field.type.width // 8
            moved = range(start * 8, (start + size) * 8) if start is not None else ()
            bits.update(moved or (bit for element in field.elements for bit in element.bits))
    return bits


def _item(spec: EditionSpec, message: Message, key: Key) -> RelatedItem:
    """A key of a message: the index of a table, a selector or a constant."""
    if key.role is KeyRole.INDEX:
        return RelatedItem(_path_of(spec, message, key), INDEX)
    address = spec.addresses[message.address]
    of_edition = not (address.selector or address.reply_selector)
    path: DocumentPath = ("selector",) if of_edition else ("addresses", message.address)
    return RelatedItem(path, "the selector", key=True)


def _path_of(spec: EditionSpec, message: Message, key: Key) -> DocumentPath:
    """The path of the position of a key of a table."""
    table = spec.commands[str(message.path[1])].table or ""
    path: DocumentPath = ("tables", table, "index")
    number = next(i for i, k in enumerate(k for k in message.keys if k.role is KeyRole.INDEX) if k is key)
    return (*path, number, "at") if isinstance(spec.tables[table].index, list) else (*path, "at")


def _where(space: Space, bit: int) -> str:
    return f"bit {bit % 8} of byte {bit // 8}" if space is Space.DATA else f"bit {bit} of the id"
