"""Changes of what distinguishes messages: codes, indices of tables, constants."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Command, Key, KeyRole, Message
from .change import Item, Keyword, Side
from .collector import BOTH_SIDES, Attribute, Subject, given, listed
from .fields import Editions, place_of, what_is_sent
from .forms import constants, messages
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
    Attribute[Field]("constant-changed", "constant", lambda f: what_is_sent(f.role)),
    Attribute[Field]("field-moved", "at", place_of),
    Attribute[Field]("byte-order-changed", "byte_order", lambda f: Keyword(f.type.order.value)),
)
_ORDER = Attribute[Key]("byte-order-changed", "byte_order", lambda key: Keyword(key.order.value))
_INDEX = Attribute[Command]("index-changed", "index", index)


def compare(command: Subject, both: Editions, old: Command, new: Command) -> None:
    """All changes of codes, indices and constants that distinguish messages."""
    command = command.used(*BOTH_SIDES)
    if same_kind(old, new) and old.code != new.code:
        facts = {"old": code(old.code), "new": code(new.code)}
        taken = [
            c.spec_name for c in both.new.commands if (c.address, c.code, c.entry) == (new.address, old.code, None)
        ]
        if taken:
            command.at("code").add("code-taken", **facts, other=min(taken))
        else:
            command.at("code").add("code-changed", **facts)
    if old.entry and new.entry:
        entry = command.of(Item.of_entry(old.entry), old.entry, new.entry)
        entry.attributes([_INDEX], old, new)
        if not same_kind(old, new):
            entry.at("kind").add("kind-changed", old=given(old.entry.kind), new=given(new.entry.kind))
    for side, message, another in ((Side.SENDING, old.request, new.request), (Side.RECEIVING, old.reply, new.reply)):
        if message and another and (message.address == another.address or message.id == another.id):
            of_replies = side is Side.RECEIVING and not _like_requests(old, new)
            _code_moved(command.used(side), both, message, another, "reply_selector" if of_replies else "selector")
    for direction, message, another in messages(old, new):
        frames = command.used(Side.of(direction))
        if old.entry and new.entry:
            _index_moved(frames, both, (old.entry.table, new.entry.table), message, another)
        _constants(frames.within(message.path, another.path), message, another)


def same_kind(old: Command, new: Command) -> bool:
    """Whether the codes are those of one kind of entry."""
    codes = [[code_sent(m) for m in c.messages] for c in (old, new)]
    return codes[0] == codes[1] or (old.entry and old.entry.kind) == (new.entry and new.entry.kind)


def _constants(message: Subject, old: Message, new: Message) -> None:
    """Constants that distinguish one message from others, as a code does, in one edition or in both."""
    before, after = constants(old), constants(new)
    matched = by_name((*before.values(), *old.layout.fields), (*after.values(), *new.layout.fields)).also(_is_same)
    for old_field, new_field in matched.pairs:
        if old_field.name in before or new_field.name in after:
            constant = message.of(message.item, old_field, new_field)
            constant.renamed("field-renamed", old_field.name, new_field.name)
            constant.attributes(_OF_CONSTANT, old_field, new_field, name=new_field.name)
    for gone in (field for field in matched.removed if field.name in before):
        message.within(gone.path, new.path).removed("field-removed", None, name=gone.name, place=place_of(gone))
    for fresh in (field for field in matched.added if field.name in after):
        message.within(old.path, fresh.path).add("field-added", name=fresh.name, place=place_of(fresh))


def _is_same(old: Field, new: Field) -> bool:
    return all(row.shown(old) == row.shown(new) for row in _OF_CONSTANT)


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


def _code_moved(command: Subject, both: Editions, old: Message, new: Message, key: str) -> None:
    if _one_selector(both.old) and _one_selector(both.new):
        selector = command._replace(item=Item("edition", ""), places=(("selector",), ("selector",)))
    else:
        places = ("addresses", old.address, key), ("addresses", new.address, key)
        selector = command._replace(item=Item("address", old.address), places=places)
    _moved(selector, both, old, new, KeyRole.CODE, "code-moved")


def _pairs(old: Message, new: Message, role: KeyRole) -> Iterator[tuple[Key, Key]]:
    """The keys of a role in both messages."""
    return zip(*([k for k in m.keys if k.role is role] for m in (old, new)), strict=False)


def _follow_edition(both: Editions, old: Message, new: Message, role: KeyRole) -> bool:
    """Whether the keys of a role have other bits because the edition has another byte order."""
    orders = {(old_key.order, new_key.order) for old_key, new_key in _pairs(old, new, role)}
    return both.old.order is not both.new.order and orders == {(both.old.order, both.new.order)}


def _index_moved(command: Subject, both: Editions, tables: tuple[str, str], old: Message, new: Message) -> None:
    places = ("tables", tables[0], "index"), ("tables", tables[1], "index")
    index = command._replace(item=Item("table", tables[0]), places=places)
    _moved(index, both, old, new, KeyRole.INDEX, "index-moved")


def _moved(subject: Subject, both: Editions, old: Message, new: Message, role: KeyRole, rule: str) -> None:
    """Adds the change of the bits of keys; of their byte order, or of the edition's, if they stay in the same bytes."""
    follows = _follow_edition(both, old, new, role)
    before, after = _place_of(old.keys, role), _place_of(new.keys, role)
    if before != after and not follows:
        subject.add(rule, old=before, new=after)
    for old_key, new_key in _pairs(old, new, role):
        if old_key.segments != new_key.segments and (follows or _place(old_key) == _place(new_key)):
            owner = subject._replace(item=Item("edition", ""), places=((), ())) if follows else subject
            owner.attributes([_ORDER], old_key, new_key, name="byte_order" if follows else role.value)
