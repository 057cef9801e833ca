"""Changes of commands: what there is, its codes, its frames, what it does."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Command, Direction, EchoReply, Message, OtherReply, SharedReply
from ..model.metadata import Effect, Level
from . import discriminators, fields, match
from .change import Fact, Impact, Item, Said, Side
from .collector import Found, Use, listed
from .fields import Editions


def compare(found: Found, old: Edition, new: Edition) -> None:
    """All changes of all commands, and of the layouts and types that they use."""
    matched = match.commands(old, new)
    layouts = [(a.layout, b.layout) for pair in matched.pairs for _, a, b in messages(*pair)]
    pairs = [(a.name, b.name) for a, b in layouts if a.shared and b.shared]
    types = [(a.name, b.name) for a, b in fields.type_pairs(layouts)]
    both = Editions(
        old,
        new,
        match.renamed(types, old.types, new.types),
        match.renamed(pairs, old.layouts, new.layouts),
    )
    kept = _tables(found, old, new)
    matched = dataclasses.replace(
        matched,
        removed=tuple(c for c in matched.removed if c.group not in kept),
        added=tuple(c for c in matched.added if c.group not in kept),
    )
    repurposed = [
        (one, other) for one in matched.removed for other in matched.added if match.code_of(one) == match.code_of(other)
    ]
    for one, other in repurposed:
        _repurposed(found, one, other)
    for one in matched.removed:
        if all(one is not gone for gone, _ in repurposed):
            _removed(found, one, new)
    for other in matched.added:
        if all(other is not fresh for _, fresh in repurposed):
            _added(found, other, old)
    for one, other in matched.pairs:
        _command(found, both, one, other)


def _tables(found: Found, old: Edition, new: Edition) -> set[str]:
    """The commands that use a table in one edition alone: all their forms are others."""
    before, after = ({c.group: c for c in edition.commands} for edition in (old, new))
    kept = {
        name for name in before.keys() & after.keys() if (before[name].entry is None) != (after[name].entry is None)
    }
    for name in before:
        if name in kept:
            one, other = before[name], after[name]
            facts = {key: _table(c) for key, c in (("old", one), ("new", other))}
            use = Use((Side.SENDING, Side.RECEIVING), (name,))
            places = (*one.path, "table"), (*other.path, "table")
            found.add("table-of-command-changed", _item(one), *places, Impact.SILENT, use, **facts)
    return kept


def _table(command: Command) -> Fact:
    return (Said("the table"), f" `{command.entry.table}`") if command.entry else Said("no table")


def messages(old: Command, new: Command) -> Iterator[tuple[Direction, Message, Message]]:
    """The frames of a command that both editions have and that are its own."""
    for direction in Direction:
        one, other = (c.message(direction) for c in (old, new))
        if one is None or other is None or one.command != old.name or other.command != new.name:
            continue
        if direction is Direction.REQUEST or not _is_another(old, new, one, other):
            yield direction, one, other


def _is_another(old: Command, new: Command, one: Message, other: Message) -> bool:
    """Whether a reply needs no look: it is an echo in both editions, or in one and has nothing of the other's."""
    echoes = old.is_echoed + new.is_echoed
    if echoes == 2:
        return old.request is not None and new.request is not None
    return echoes == 1 and not match.fields(one.layout, other.layout).pairs


def _item(command: Command) -> Item:
    return Item("command", command.group)


def _code(command: Command) -> str:
    return f" ({discriminators.code(command.code)})" if command.code is not None else ""


def _repurposed(found: Found, old: Command, new: Command) -> None:
    use = Use((Side.SENDING, Side.RECEIVING), (old.group,))
    if old.entry and new.entry:
        item = Item.of_entry(old.entry)
        facts = {"index": discriminators.index(old), "old": old.entry.name, "new": new.entry.name}
        found.add("entry-repurposed", item, old.entry.path, new.entry.path, Impact.SILENT, use, **facts)
        return
    facts = {"code": _code(old), "old": old.group, "new": new.group}
    where = (old.path, new.path)
    found.add("command-repurposed", _item(old), *where, Impact.SILENT, use, **facts, meaning=new.title)


def _removed(found: Found, old: Command, new: Edition) -> None:
    use = Use((Side.SENDING,), (old.group,))
    if old.entry and any(c.group == old.group for c in new.commands):
        item = Item.of_entry(old.entry)
        facts = {"name": old.entry.name, "index": discriminators.index(old)}
        found.add("entry-removed", item, old.entry.path, ("tables", old.entry.table), Impact.LOUD, use, **facts)
        return
    facts = {"name": old.group, "code": _code(old)}
    found.add("command-removed", _item(old), old.path, ("commands",), Impact.LOUD, use, **facts)


def _added(found: Found, new: Command, old: Edition) -> None:
    if new.entry and any(c.group == new.group for c in old.commands):
        item = Item.of_entry(new.entry)
        facts = {"name": new.entry.name, "index": discriminators.index(new)}
        use = Use((), (new.group,))
        found.add("entry-added", item, ("tables", new.entry.table), new.entry.path, Impact.SAFE, use, **facts)
        return
    facts = {"name": new.group, "code": _code(new)}
    item, use = _item(new), Use((), (new.group,))
    found.add("command-added", item, ("commands",), new.path, Impact.SAFE, use, **facts)


def _command(found: Found, both: Editions, old: Command, new: Command) -> None:
    item, where = _item(old), (old.path, new.path)
    use = Use((Side.SENDING,), (old.group,))
    if old.entry and new.entry and old.entry.table != new.entry.table:
        table, names = Item("table", old.entry.table), {"old": old.entry.table, "new": new.entry.table}
        found.renamed("table-renamed", table, old.entry.path[:2], new.entry.path[:2], use, **names)
    if old.entry and new.entry and old.entry.name != new.entry.name:
        entry = Item.of_entry(old.entry)
        names = {"old": old.entry.name, "new": new.entry.name}
        found.renamed("entry-renamed", entry, old.entry.path, new.entry.path, use, **names)
    elif old.group != new.group:
        names = {"old": old.group, "new": new.group}
        found.renamed("command-renamed", item, *where, use, **names)
    discriminators.compare(found, both, old, new)
    _facts(found, both, old, new)
    _texts(found, both, old, new)
    _reply(found, old, new)
    for direction, one, other in messages(old, new):
        used = Use((Side.of(direction),), (old.group,))
        _message(found, both, old, new, one, other)
        fields.compare(found, both, old.group, one.layout, other.layout, used)


def _facts(found: Found, both: Editions, old: Command, new: Command) -> None:
    item, use = _item(old), Use((Side.SENDING,), (old.group,))

    def add(rule: str, impact: Impact, key: str, one: Fact, other: Fact) -> None:
        found.add(rule, item, (*old.path, key), (*new.path, key), impact, use, old=one, new=other)

    if old.implemented != new.implemented:
        impact = Impact.SILENT if new.implemented else Impact.LOUD
        add("implemented-changed", impact, "implemented", *(Said("yes" if c.implemented else "no") for c in (old, new)))
    if old.mode != new.mode:
        add("mode-of-command-changed", Impact.LOUD, "mode", *(c.mode or "none" for c in (old, new)))
    silent = {s.name for s in old.limited_by} != {s.name for s in new.limited_by}
    if silent or {s.name for s in old.not_limited_by} != {s.name for s in new.not_limited_by}:
        key = "limited_by" if silent else "not_limited_by"
        add("limits-changed", Impact.SILENT if silent else Impact.SAFE, key, *map(_limits, (old, new)))
    shared = [_shared(edition, c) for edition, c in ((both.old, old), (both.new, new))]
    _conditions(found, item, (old.path, new.path), shared, use)
    if old.entry and new.entry:
        entry = Item.of_entry(old.entry)
        own = [
            ({p: v for p, v in c.only.items() if p not in only}, tuple(e for e in c.effects if e not in effects))
            for c, (only, effects) in zip((old, new), shared, strict=True)
        ]
        _conditions(found, entry, (old.entry.path, new.entry.path), own, use)


_Conditions = tuple[Mapping[str, tuple[str, ...]], tuple[Effect, ...]]


def _shared(edition: Edition, command: Command) -> _Conditions:
    """Where a command is there and what it does, as far as that holds for all entries of its table."""
    if command.entry is None:
        return command.only, command.effects
    forms = [c for c in edition.commands if c.group == command.group]
    only = {p: v for p, v in command.only.items() if all(c.only.get(p) == v for c in forms)}
    return only, tuple(e for e in command.effects if all(e in c.effects for c in forms))


def _conditions(
    found: Found, item: Item, places: tuple[DocumentPath, DocumentPath], told: Sequence[_Conditions], use: Use
) -> None:
    """Where something is there, and what it does besides."""
    (old_only, before), (new_only, after) = told

    def add(rule: str, impact: Impact, key: str, one: str, other: str) -> None:
        found.add(rule, item, (*places[0], key), (*places[1], key), impact, use, old=one, new=other)

    if old_only != new_only:
        scopes = [formatting.condition(only) or Said("all") for only in (old_only, new_only)]
        add("availability-changed", Impact.SILENT, "only", scopes[0], scopes[1])
    names = [{e.name for e in effects} for effects in (before, after)]
    if names[0] != names[1]:
        other = [e for e in (*before, *after) if (e.name in names[0]) != (e.name in names[1])]
        impact = Impact.SILENT if any(e.level is not Level.NOTE for e in other) else Impact.SAFE
        add("effects-changed", impact, "effects", *(listed(e.name for e in effects) for effects in (before, after)))


def _limits(command: Command) -> Fact:
    others = listed(s.name for s in command.not_limited_by)
    said = (" (", Said("not by"), f" {others})") if command.not_limited_by else ()
    return (listed(s.name for s in command.limited_by), *said)


def _texts(found: Found, both: Editions, old: Command, new: Command) -> None:
    item, name = _item(old), old.group
    if old.entry and new.entry:
        tables = both.old.table(old.entry.table), both.new.table(new.entry.table)
        of_table = Item("table", old.entry.table), (tables[0].path, tables[1].path)
        found.texts(*of_table, *tables)
        found.section(*of_table, tables[0].manual, tables[1].manual, Use((), (old.group,)))
        of_entry = Item.of_entry(old.entry), (old.entry.path, new.entry.path)
        found.texts(*of_entry, old.entry, new.entry)
        own = [
            entry.manual if entry.manual != table.manual else ""
            for entry, table in zip((old.entry, new.entry), tables, strict=True)
        ]
        found.section(*of_entry, own[0], own[1], Use((), (old.group,)))
    places = ((*old.path, "title"), (*new.path, "title"))
    found.title(item, places, (old.group, new.group), old.group_title, new.group_title)
    found.text("text-changed", item, ((*old.path, "about"), (*new.path, "about")), name, old.about, new.about)
    notes = [{lang: "\n".join(n[lang] for n in c.notes) for lang in c.title} for c in (old, new)]
    found.text("text-changed", item, ((*old.path, "notes"), (*new.path, "notes")), name, *notes)
    found.section(item, (old.path, new.path), old.manual, new.manual, Use((), (old.group,)))


def _reply(found: Found, old: Command, new: Command) -> None:
    item, where = _item(old), ((*old.path, "reply"), (*new.path, "reply"))
    use = Use((Side.RECEIVING,), (old.group,))
    one, other = _form(old), _form(new)
    if one != other:
        impact = Impact.LOUD if other == "none" else Impact.SAFE if one == "none" else Impact.SILENT
        layouts = ["".join(r.message.layout.name for r in c.replies if isinstance(r, SharedReply)) for c in (old, new)]
        facts = {"old": layouts[0] or one, "new": layouts[1] or other}
        found.add("reply-form-changed", item, *where, impact, use, **facts)
    if old.from_each != new.from_each:
        repliers = {"old": _repliers(old), "new": _repliers(new)}
        found.add("repliers-changed", item, *where, Impact.LOUD, use, **repliers)
    if (old.request is None) != (new.request is None):
        told = ["none" if c.request is None else "fields" for c in (old, new)]
        paths = ((*old.path, "request"), (*new.path, "request"))
        impact = Impact.LOUD if new.request is None else Impact.SAFE
        sending = Use((Side.SENDING,), (old.group,))
        found.add("request-changed", item, *paths, impact, sending, old=told[0], new=told[1])


def _repliers(command: Command) -> Fact:
    return (Said("the nodes"), f" {listed(command.from_each)}") if command.from_each else Said("the node addressed")


def _form(command: Command) -> str:
    """The form as far as it decides what comes back: whose layout the fields are in does not."""
    for reply in command.replies:
        if isinstance(reply, OtherReply):
            return f"of {reply.of}"
        return "echo" if isinstance(reply, EchoReply) else "fields"
    return "none"


def _message(found: Found, both: Editions, old: Command, new: Command, one: Message, other: Message) -> None:
    direction = Said(one.direction.value)
    item, use = _item(old), Use((Side.of(one.direction),), (old.group,))

    def add(rule: str, impact: Impact, key: str, before: Fact, after: Fact, **facts: Fact) -> None:
        paths = (*one.path, key), (*other.path, key)
        found.add(rule, item, *paths, impact, use, old=before, new=after, **facts)

    own = [discriminators.code_sent(m) for m in (one, other)]
    if own != [old.code, new.code] and own[0] != own[1]:
        known = own[1] in one.accept
        add(
            "reply-code-changed",
            Impact.SAFE if known else Impact.LOUD,
            "code",
            discriminators.code(own[0]),
            discriminators.code(own[1]),
        )
    if one.accept != other.accept:
        add(
            "accept-changed", Impact.SAFE, "accept", *(listed(map(discriminators.code, m.accept)) for m in (one, other))
        )
    if one.address != other.address and one.id != other.id:
        add("address-of-command-changed", Impact.LOUD, "address", one.address, other.address, direction=direction)
    usual = [edition.bus.dlc for edition in (both.old, both.new)]
    if one.dlc != other.dlc and [one.dlc, other.dlc] == usual:
        facts: dict[str, Fact] = {"direction": Said("usual frame"), "old": str(one.dlc), "new": str(other.dlc)}
        found.add("dlc-changed", Item("bus", ""), ("bus", "dlc"), ("bus", "dlc"), Impact.LOUD, use, **facts)
    elif one.dlc != other.dlc:
        add("dlc-changed", Impact.LOUD, "dlc", str(one.dlc), str(other.dlc), direction=direction)
    if one.remote != other.remote:
        kinds = [Said("remote frame" if m.remote else "data frame") for m in (one, other)]
        add("frame-kind-changed", Impact.LOUD, "remote", *kinds, direction=direction)
