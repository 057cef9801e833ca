"""Changes of what distinguishes messages: codes, indices of tables, constants."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Command, Key, KeyRole, Message
from ..model.types import Order
from .change import Item, Keyword, Side
from .collector import AffectedUsers, Attribute, Collector, Places, at, given, listed, paths
from .fields import Editions, constant_keys, place_of
from .forms import messages
from .match import by_name


def code(value: int | None) -> str:
    """A code, as `0x0A`."""
    return Keyword("none") if value is None else f"0x{value:02X}"


def code_sent(message: Message) -> int | None:
    """The code in a message, which may differ from its command's."""
    return next((key.value for key in message.keys if key.role is KeyRole.CODE), None)


def index(command: Command) -> str:
    """The index of an entry, as `0x05, 0x0A`."""
    message = command.request or command.reply
    return listed(code(key.value) for key in message.keys if key.role is KeyRole.INDEX) if message else Keyword("none")


_OF_CONSTANT = (
    Attribute["_Field"](
        "constant-changed", "constant", lambda f: Keyword("any value") if f.value is None else str(f.value)
    ),
    Attribute["_Field"]("field-moved", "at", lambda f: f.place),
    Attribute["_Field"]("byte-order-changed", "byte_order", lambda f: Keyword(f.order.value)),
)
_ORDER = Attribute[Key]("byte-order-changed", "byte_order", lambda key: Keyword(key.order.value))
_INDEX = Attribute[Command]("index-changed", "index", index)


def compare(collector: Collector, both: Editions, old: Command, new: Command) -> None:
    """All changes of codes, indices and constants that distinguish messages."""
    if same_kind(old, new) and old.code != new.code:
        item, use, places = (
            Item("command", old.spec_name),
            AffectedUsers(tuple(Side), (old.spec_name,)),
            at(paths(old, new), "code"),
        )
        facts = {"old": code(old.code), "new": code(new.code)}
        taken = [
            c.spec_name for c in both.new.commands if (c.address, c.code, c.entry) == (new.address, old.code, None)
        ]
        if taken:
            collector.add("code-taken", item, places, use, **facts, other=min(taken))
        else:
            collector.add("code-changed", item, places, use, **facts)
    if old.entry and new.entry:
        use = AffectedUsers(tuple(Side), (old.spec_name,))
        collector.attributes([_INDEX], Item.of_entry(old.entry), paths(old.entry, new.entry), old, new, use)
        if not same_kind(old, new):
            facts = {"old": given(old.entry.kind), "new": given(new.entry.kind)}
            places = at(paths(old.entry, new.entry), "kind")
            collector.add("kind-changed", Item.of_entry(old.entry), places, use, **facts)
    for side, message, another in ((Side.SENDING, old.request, new.request), (Side.RECEIVING, old.reply, new.reply)):
        if message and another and (message.address == another.address or message.id == another.id):
            of_replies = side is Side.RECEIVING and not _like_requests(old, new)
            key = "reply_selector" if of_replies else "selector"
            _code_moved(collector, both, message, another, key, AffectedUsers((side,), (old.spec_name,)))
    for direction, message, another in messages(old, new):
        use = AffectedUsers((Side.of(direction),), (old.spec_name,))
        _index_moved(collector, both, old, new, message, another, use)
        _constants(collector, message, another, use)


def same_kind(old: Command, new: Command) -> bool:
    """Whether the codes are those of one kind of entry."""
    codes = [[code_sent(m) for m in (c.request, c.reply) if m] for c in (old, new)]
    return codes[0] == codes[1] or (old.entry and old.entry.kind) == (new.entry and new.entry.kind)


class _Field(NamedTuple):
    """A key or a field of a message; `value` is None where it is no constant."""

    name: str
    value: int | None
    place: str
    order: Order
    path: DocumentPath


def _constants(collector: Collector, old: Message, new: Message, use: AffectedUsers) -> None:
    """Constants that distinguish one message from others, as a code does, in one edition or in both."""
    item, (before, after) = Item("command", use.commands[0]), (constant_keys(m) for m in (old, new))
    matched = by_name(_fields(old), _fields(new)).also(lambda a, b: a[1:4] == b[1:4])
    for old_field, new_field in matched.pairs:
        if old_field.name not in before and new_field.name not in after:
            continue
        places = old_field.path, new_field.path
        collector.renamed("field-renamed", item, places, use, old=old_field.name, new=new_field.name)
        collector.attributes(_OF_CONSTANT, item, places, old_field, new_field, use, name=new_field.name)
    for gone in (field for field in matched.removed if field.name in before):
        places, facts = (gone.path, new.path), {"name": gone.name, "place": gone.place}
        collector.removed("field-removed", item, places, use, None, **facts)
    for fresh in (field for field in matched.added if field.name in after):
        places, facts = (old.path, fresh.path), {"name": fresh.name, "place": fresh.place}
        collector.add("field-added", item, places, use, **facts)


def _fields(message: Message) -> Iterator[_Field]:
    yield from (_Field(k.name, k.value, _place(k), k.order, k.path) for k in message.keys if k.role is KeyRole.CONSTANT)
    yield from (_Field(f.name, f.role.sent_raw, place_of(f), f.type.order, f.path) for f in message.layout.fields)


def _place(key: Key) -> str:
    return formatting.place(key.space, key.segments)


def _place_of(keys: Sequence[Key], role: KeyRole) -> str:
    return listed(_place(k) for k in keys if k.role is role)


@functools.lru_cache(maxsize=2)
def _one_selector(edition: Edition) -> bool:
    """Whether all frames have their code in the same bits."""
    keys = [m.keys[0] for m in edition.all_messages() if m.keys and m.keys[0].role is KeyRole.CODE]
    return len({(key.space, key.segments) for key in keys}) < 2


def _like_requests(old: Command, new: Command) -> bool:
    """Whether the replies of both editions have their code where the requests have it."""
    return all(
        c.request is None
        or c.reply is None
        or _place_of(c.request.keys, KeyRole.CODE) == _place_of(c.reply.keys, KeyRole.CODE)
        for c in (old, new)
    )


def _code_moved(collector: Collector, both: Editions, old: Message, new: Message, key: str, use: AffectedUsers) -> None:
    facts = {"old": _place_of(old.keys, KeyRole.CODE), "new": _place_of(new.keys, KeyRole.CODE)}
    whole = _one_selector(both.old) and _one_selector(both.new)
    item = Item("edition", "") if whole else Item("address", old.address)
    of_address = ("addresses", old.address, key), ("addresses", new.address, key)
    places: Places = (("selector",), ("selector",)) if whole else of_address
    if facts["old"] != facts["new"] and not _follow_edition(both, old, new, KeyRole.CODE):
        collector.add("code-moved", item, places, use, **facts)
    _turned(collector, both, item, places, old, new, KeyRole.CODE, use)


def _pairs(old: Message, new: Message, role: KeyRole) -> Iterator[tuple[Key, Key]]:
    """The keys of a role in both messages."""
    return zip(*([k for k in m.keys if k.role is role] for m in (old, new)), strict=False)


def _follow_edition(both: Editions, old: Message, new: Message, role: KeyRole) -> bool:
    """Whether the keys of a role have other bits because the edition has another byte order."""
    orders = {(old_key.order, new_key.order) for old_key, new_key in _pairs(old, new, role)}
    return both.old.order is not both.new.order and orders == {(both.old.order, both.new.order)}


def _turned(
    collector: Collector,
    both: Editions,
    item: Item,
    places: Places,
    old: Message,
    new: Message,
    role: KeyRole,
    use: AffectedUsers,
) -> None:
    """Adds the change of the byte order of keys that stay in the same bytes, or of the edition if they follow it."""
    follows = _follow_edition(both, old, new, role)
    for old_key, new_key in _pairs(old, new, role):
        if old_key.segments == new_key.segments or not (follows or _place(old_key) == _place(new_key)):
            continue
        if follows:
            item, places = Item("edition", ""), ((), ())
        name = "byte_order" if follows else role.value
        collector.attributes([_ORDER], item, places, old_key, new_key, use, name=name)


def _index_moved(
    collector: Collector,
    both: Editions,
    old: Command,
    new: Command,
    old_message: Message,
    new_message: Message,
    use: AffectedUsers,
) -> None:
    facts = {"old": _place_of(old_message.keys, KeyRole.INDEX), "new": _place_of(new_message.keys, KeyRole.INDEX)}
    if not old.entry or not new.entry:
        return
    item, places = (
        Item("table", old.entry.table),
        at((("tables", old.entry.table), ("tables", new.entry.table)), "index"),
    )
    if facts["old"] != facts["new"] and not _follow_edition(both, old_message, new_message, KeyRole.INDEX):
        collector.add("index-moved", item, places, use, **facts)
    _turned(collector, both, item, places, old_message, new_message, KeyRole.INDEX, use)
