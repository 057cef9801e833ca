"""Changes of what tells messages apart: codes, indices of tables, constants."""

from __future__ import annotations

from collections.abc import Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Command, Key, KeyRole, Message
from .change import Impact, Item, Said, Side
from .collector import Found, Use, listed
from .fields import Editions


def code(value: int | None) -> str:
    """A code, as `0x0A`."""
    return Said("none") if value is None else f"0x{value:02X}"


def code_sent(message: Message) -> int | None:
    """The code in a message, which may differ from its command's."""
    return next((key.value for key in message.keys if key.role is KeyRole.CODE), None)


def index(command: Command) -> str:
    """The index of an entry, as `0x05, 0x0A`."""
    message = command.request or command.reply
    return listed(code(key.value) for key in message.keys if key.role is KeyRole.INDEX) if message else Said("none")


def compare(found: Found, both: Editions, old: Command, new: Command) -> None:
    """All changes of codes, indices and constants that tell messages apart."""
    item, use = Item("command", old.group), Use((Side.SENDING, Side.RECEIVING), (old.group,))
    paths = ((*old.path, "code"), (*new.path, "code"))
    facts = {"old": code(old.code), "new": code(new.code)}
    if old.code != new.code:
        now = [
            c.group for c in both.new.commands if c.address == new.address and c.code == old.code and c.entry is None
        ]
        if now:
            found.add("code-taken", item, *paths, Impact.SILENT, use, **facts, other=now[0])
        else:
            found.add("code-changed", item, *paths, Impact.LOUD, use, **facts)
    if old.entry and new.entry and index(old) != index(new):
        entry = Item.of_entry(old.entry)
        places = ((*old.entry.path, "index"), (*new.entry.path, "index"))
        facts = {"old": index(old), "new": index(new)}
        found.add("index-changed", entry, *places, Impact.SILENT, use, **facts)
    for side, one, other in (
        (Side.SENDING, old.request, new.request),
        (Side.RECEIVING, old.reply, new.reply),
    ):
        if one and other:
            _places(found, both, old, new, one.keys, other.keys, Use((side,), (old.group,)))
            _constants(found, one, other, Use((side,), (old.group,)))


def _constants(found: Found, old: Message, new: Message, use: Use) -> None:
    """Constants that tell one message from others, as a code does."""
    before, after = ({k.name: k for k in m.keys if k.role is KeyRole.CONSTANT} for m in (old, new))
    item = Item("command", use.commands[0])
    for name in before.keys() & after.keys():
        one, other = before[name], after[name]
        if one.value != other.value:
            facts = {"name": name, "old": str(one.value), "new": str(other.value)}
            paths = (*old.path, name, "constant"), (*new.path, name, "constant")
            found.add("constant-changed", item, *paths, Impact.LOUD, use, **facts)
        if (one.space, one.segments) != (other.space, other.segments):
            stood = [formatting.place(k.space, k.segments) for k in (one, other)]
            paths = (*old.path, name, "at"), (*new.path, name, "at")
            found.add("field-moved", item, *paths, Impact.LOUD, use, name=name, old=stood[0], new=stood[1])


def _one_selector(edition: Edition) -> bool:
    """Whether all frames have their code in the same bits."""
    return len({m.keys[0].segments for m in edition.all_messages() if m.keys and m.keys[0].role is KeyRole.CODE}) < 2


def _places(
    found: Found, both: Editions, old: Command, new: Command, one: Sequence[Key], other: Sequence[Key], use: Use
) -> None:
    """Where the code stands, and the index of a table."""

    def stand(keys: Sequence[Key], role: KeyRole) -> str:
        return listed(formatting.place(k.space, k.segments) for k in keys if k.role is role)

    stood = [stand(one, KeyRole.CODE), stand(other, KeyRole.CODE)]
    if stood[0] != stood[1]:
        facts = {"old": stood[0], "new": stood[1]}
        whole = _one_selector(both.old) and _one_selector(both.new)
        item = Item("edition", "") if whole else Item("address", old.address)
        paths: list[DocumentPath] = [
            ("selector",) if whole else ("addresses", c.address, "selector") for c in (old, new)
        ]
        found.add("code-moved", item, paths[0], paths[1], Impact.LOUD, use, **facts)
    stood = [stand(one, KeyRole.INDEX), stand(other, KeyRole.INDEX)]
    if old.entry and new.entry and stood[0] != stood[1]:
        facts = {"old": stood[0], "new": stood[1]}
        was, now = ("tables", old.entry.table, "index"), ("tables", new.entry.table, "index")
        found.add("index-moved", Item("table", old.entry.table), was, now, Impact.LOUD, use, **facts)
