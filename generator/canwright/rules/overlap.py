"""Fields and keys of one message do not overlap."""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import EditionSpec
from ..model.layout import Space, Variant, bits_of
from ..model.message import Direction, Key, KeyRole, Message
from ..model.types import Order
from .rule import Finding, Findings, RelatedItem, Subject

HIGHEST = "; `at` is the highest bit of a big-endian field"
INDEX = "the table's index"
APART = "move one of them, or give them different `only`"
WITHOUT_INDEX = (
    "move it; if replies do not contain the index, define them once as a separate command with `request: none`, and "
    "write `reply: {of: COMMAND}` here"
)


def check(subject: Subject) -> Findings:
    seen = set()
    for message in subject.edition.all_messages():
        for variant in message.layout.variants:
            for finding in _clashes(subject.spec, message, variant):
                if finding not in seen:
                    seen.add(finding)
                    yield finding


def _clashes(spec: EditionSpec, message: Message, variant: Variant) -> Findings:
    taken: dict[Space, dict[int, RelatedItem]] = {space: {} for space in Space}
    for key in message.keys:
        bits, others = bits_of(key.segments), taken[key.space]
        clash = next(filter(others.__contains__, bits), None)
        if clash is not None and key.role is KeyRole.INDEX:
            text = f"the table's index shares {_where(key.space, clash)} with {others[clash].item}"
            yield Finding(_path_of(spec, message, key), text, "move one of them", related=(others[clash],))
        others.update(dict.fromkeys(bits, _item(spec, message, key)))
    for field in variant.fields:
        others = taken[field.space]
        for element in field.elements:
            clash = next(filter(others.__contains__, element.bits), None)
            if clash is not None:
                hint = WITHOUT_INDEX if others[clash].item == INDEX and message.direction is Direction.REPLY else APART
                if field.type.order is Order.BIG and field.type.width % 8 and field.space is Space.DATA:
                    hint += HIGHEST
                text = f"`{field.name}` shares {_where(field.space, clash)} with {others[clash].item}"
                yield Finding((*field.path, "at"), text, hint, related=(others[clash],))
            others.update(dict.fromkeys(element.bits, RelatedItem((*field.path, "at"), f"`{field.name}`")))


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
