"""Changes of commands: which there are, their codes, frames, conditions and effects."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from ..model.layout import Layout
from ..model.message import Command, Direction, Entry, Message, OtherReply, SharedReply
from ..model.metadata import Effect, Level
from . import discriminators, fields, forms, match
from .change import Impact, Item, Keyword, SentenceArgument, Side
from .collector import AffectedUsers, Attribute, Collector, Places, at, given, listed, paths, scope
from .fields import Editions
from .forms import is_named, messages


def compare(collector: Collector, old: Edition, new: Edition) -> None:
    """All changes of all commands, and of the layouts and types that they use."""
    matched = match.commands(old, new)
    layouts = [(a.layout, b.layout) for pair in matched.pairs for _, a, b in messages(*pair)]
    pairs = [(a.name, b.name) for a, b in layouts if a.shared and b.shared]
    types = [(a.name, b.name) for a, b in fields.type_pairs(layouts)]
    kept = _tables(collector, old, new)
    matched = dataclasses.replace(
        matched,
        pairs=tuple((a, b) for a, b in matched.pairs if a.spec_name not in kept and b.spec_name not in kept),
        removed=tuple(c for c in matched.removed if c.spec_name not in kept),
        added=tuple(c for c in matched.added if c.spec_name not in kept),
    )
    repurposed = matched.also(lambda a, b: match.code_of(a) == match.code_of(b))
    both = Editions(
        old,
        new,
        match.renamed(types, old.types, new.types),
        match.renamed(pairs, old.layouts, new.layouts),
        {earlier.name: later.name for earlier, later in repurposed.pairs},
    )
    for earlier, later in repurposed.pairs[len(matched.pairs) :]:
        _repurposed(collector, earlier, later)
    for earlier in repurposed.removed:
        _removed(collector, earlier, new)
    for later in repurposed.added:
        _added(collector, later, old)
    for earlier, later in matched.pairs:
        _command(collector, both, earlier, later)


def _tables(collector: Collector, old: Edition, new: Edition) -> set[str]:
    """The commands that use another table, or one in one edition alone: all their forms are others."""
    before, after = ({c.spec_name: c for c in edition.commands} for edition in (old, new))
    kept = {name for name in before.keys() & after.keys() if _is_other_table(before[name], after[name], new)}
    for name in before:
        if name in kept:
            _other_table(collector, before[name], after[name])
    return kept


def _is_other_table(old: Command, new: Command, edition: Edition) -> bool:
    """Whether a command uses a table in one edition alone, or another table although the edition still has the old one."""
    if old.entry is None or new.entry is None:
        return old.entry is not new.entry
    return old.entry.table != new.entry.table and any(table.name == old.entry.table for table in edition.tables)


def _other_table(collector: Collector, old: Command, new: Command) -> None:
    facts = {"old": _table(old), "new": _table(new)}
    use = AffectedUsers(tuple(Side), (old.spec_name,))
    collector.add("table-of-command-changed", _item(old), at(paths(old, new), "table"), use, **facts)


def _table(command: Command) -> SentenceArgument:
    return (Keyword("the table"), f" `{command.entry.table}`") if command.entry else Keyword("no table")


def _item(command: Command) -> Item:
    return Item("command", command.spec_name)


def _code(command: Command) -> str:
    return f" ({discriminators.code(command.code)})" if command.code is not None else ""


def _repurposed(collector: Collector, old: Command, new: Command) -> None:
    use = AffectedUsers(tuple(Side), (old.spec_name,))
    if old.entry and new.entry and old.spec_name == new.spec_name:
        facts = {"index": discriminators.index(old), "old": old.entry.name, "new": new.entry.name}
        places = paths(old.entry, new.entry)
        collector.add("entry-repurposed", Item.of_entry(old.entry), places, use, **facts)
        return
    facts = {"code": _code(old), "old": old.spec_name, "new": new.spec_name}
    collector.add("command-repurposed", _item(old), paths(old, new), use, **facts, meaning=new.spec_title)


def _removed(collector: Collector, command: Command, new: Edition) -> None:
    kind, item, path, parent, facts = _subject(command, new)
    use, places = AffectedUsers((Side.SENDING,), (command.spec_name,)), (path, parent)
    if kind == "command":
        collector.removed("command-removed", item, places, use, command.deprecated, **facts)
    else:
        collector.add("entry-removed", item, places, use, **facts)


def _added(collector: Collector, command: Command, old: Edition) -> None:
    kind, item, path, parent, facts = _subject(command, old)
    collector.add(f"{kind}-added", item, (parent, path), AffectedUsers((), (command.spec_name,)), **facts)


def _subject(command: Command, edition: Edition) -> tuple[str, Item, DocumentPath, DocumentPath, dict[str, str]]:
    """Kind, item, path, parent and facts of a command that the other edition lacks, or of its entry alone."""
    entry = command.entry
    if entry is not None and edition.forms(command.spec_name):
        facts = {"name": entry.name, "index": discriminators.index(command)}
        return "entry", Item.of_entry(entry), entry.path, ("tables", entry.table), facts
    facts = {"name": command.spec_name, "code": _code(command)}
    return "command", _item(command), command.path, ("commands",), facts


def _command(collector: Collector, both: Editions, old: Command, new: Command) -> None:
    use = AffectedUsers((Side.SENDING if old.request else Side.RECEIVING,), (old.spec_name,))
    if old.entry and new.entry and old.entry.name != new.entry.name:
        names = {"old": old.entry.name, "new": new.entry.name}
        collector.renamed("entry-renamed", Item.of_entry(old.entry), paths(old.entry, new.entry), use, **names)
    else:
        collector.renamed("command-renamed", _item(old), paths(old, new), use, old=old.spec_name, new=new.spec_name)
    if old.spec_name == new.spec_name:
        collector.renamed(
            "short-name-changed", _item(old), paths(old, new), use, old=old.short_spec_name, new=new.short_spec_name
        )
    discriminators.compare(collector, both, old, new)
    if old.entry and new.entry:
        _entry(collector, both, old, new, old.entry, new.entry)
    (own, of_entry), (new_own, new_of_entry) = _conditions(both, old, new)
    limits = _EXCEPTIONS if _limited_by(old) == _limited_by(new) else _LIMITS
    first = [next((mode.name for mode in edition.bus.modes), None) for edition in (both.old, both.new)]
    modes = () if [old.mode, new.mode] == first else (_MODE,)  # both in the usual mode, the first
    collector.attributes((*_OF_COMMAND, *modes, limits), _item(old), paths(old, new), old, new, use)
    collector.attributes(_OF_CONDITIONS, _item(old), paths(old, new), own, new_own, use)
    if old.entry and new.entry:
        collector.attributes(
            _OF_CONDITIONS, Item.of_entry(old.entry), paths(old.entry, new.entry), of_entry, new_of_entry, use
        )
    collector.deprecation(_item(old), paths(old, new), new.spec_name, old.deprecated, new.deprecated)
    _texts(collector, old, new)
    _forms(collector, both, old, new)
    _address(collector, old, new)
    for direction, old_message, new_message in messages(old, new):
        used = AffectedUsers((Side.of(direction),), (old.spec_name,))
        is_other = _other_layout(collector, both, old, new, direction, used)
        _message(collector, both, old, new, old_message, new_message, used, is_other=is_other)
        if not is_other:
            _layout_name(collector, both, old, old_message, new_message, used)
            fields.compare(collector, both, old.spec_name, old_message, new_message, used)


def _address(collector: Collector, old: Command, new: Command) -> None:
    """Adds a change of the address of each message, or one of the command if both follow its address."""
    moved = [
        frames
        for frames in forms.own_messages(old, new)
        if frames[1].id != frames[2].id and frames[1].address != frames[2].address
    ]
    follows = all((a.address, b.address) == (old.address, new.address) for _, a, b in moved)
    for group in [moved] if moved and follows else [[frames] for frames in moved]:
        old_message, new_message = group[0][1:]
        directions = [direction for direction, _, _ in group]
        facts = {
            "direction": Keyword(" and ".join(d.value for d in directions)),
            "old": old_message.address,
            "new": new_message.address,
        }
        places = paths(old, new) if follows else paths(old_message, new_message)
        use = AffectedUsers(tuple(map(Side.of, directions)), (old.spec_name,))
        collector.add("address-of-command-changed", _item(old), at(places, "address"), use, **facts)


def _layout_name(
    collector: Collector, both: Editions, command: Command, old: Message, new: Message, use: AffectedUsers
) -> None:
    """Adds the change of where the same fields of a message are defined, which names its type in the bindings."""
    old_layout, new_layout = old.layout, new.layout
    same_place = is_named(old_layout) == is_named(new_layout)
    renamed = same_place and (
        not is_named(old_layout) or both.layouts.get(old_layout.name, old_layout.name) == new_layout.name
    )
    keys = fields.constant_keys(old) | fields.constant_keys(new)
    if renamed or match.content(old_layout, keys) != match.content(new_layout, keys):
        return
    of_entry = command.entry is not None and "tables" in (old_layout.path[0], new_layout.path[0])
    item = Item.of_entry(command.entry) if of_entry and command.entry else _item(command)
    places = (command.entry.path, command.entry.path) if of_entry and command.entry else paths(old, new)
    what = Keyword("entry" if of_entry else old.direction.value)
    facts = {"direction": what, "old": _name_of(old_layout), "new": _name_of(new_layout)}
    names = collector.names(old_layout.path, new_layout.path) or f"`{old_layout.name}` → `{new_layout.name}`"
    collector.add("layout-of-command-changed", item, places, use, **facts, names=names)


def _name_of(layout: Layout) -> SentenceArgument:
    return ("`", layout.name, "`") if is_named(layout) else Keyword("fields of its own")


def _other_layout(
    collector: Collector, both: Editions, old: Command, new: Command, direction: Direction, use: AffectedUsers
) -> bool:
    """Adds the change of the layout of a message to one that both editions have; whether there is one."""
    layouts = [message.layout for c in (old, new) if (message := c.message(direction)) is not None]
    if match.content(layouts[0]) == match.content(layouts[1]) or not _is_other_layout(both, *layouts):
        return False
    rule, key = ("request-changed", "request") if direction is Direction.REQUEST else ("reply-form-changed", "reply")
    shown = [layout.name if is_named(layout) else forms.FIELDS for layout in layouts]
    collector.add(rule, _item(old), at(paths(old, new), key), use, old=shown[0], new=shown[1])
    return True


def _is_other_layout(both: Editions, old: Layout, new: Layout) -> bool:
    was_there, is_there = new.name in {n.name for n in both.old.layouts}, old.name in {n.name for n in both.new.layouts}
    if is_named(old) and is_named(new):
        return old.name != new.name and (was_there or is_there)
    if is_named(new):
        return was_there
    return is_named(old) and is_there and not match.fields(old, new).pairs


def _entry(
    collector: Collector, both: Editions, old: Command, new: Command, old_entry: Entry, new_entry: Entry
) -> None:
    """Changes of the table and the entry that a form of a command is of."""
    before, after = both.old.table(old_entry.table), both.new.table(new_entry.table)
    table, item = Item("table", old_entry.table), Item.of_entry(old_entry)
    use = AffectedUsers((), (old.spec_name,))
    names = {"old": old_entry.table, "new": new_entry.table}
    places = old_entry.path[:2], new_entry.path[:2]
    collector.renamed("table-renamed", table, places, AffectedUsers((Side.SENDING,), (old.spec_name,)), **names)
    collector.texts(table, paths(before, after), before, after)
    collector.section(table, paths(before, after), before.manual, after.manual, use)
    collector.texts(item, paths(old_entry, new_entry), old_entry, new_entry)
    own = ["" if e.manual == t.manual else e.manual for e, t in ((old_entry, before), (new_entry, after))]
    collector.section(item, paths(old_entry, new_entry), own[0], own[1], use)


def _limits(command: Command) -> SentenceArgument:
    settings = listed(s.name for s in command.not_limited_by)
    exceptions = (" (", Keyword("not by"), f" {settings})") if command.not_limited_by else ()
    return (listed(s.name for s in command.limited_by), *exceptions)


def _limited_by(command: Command) -> set[str]:
    return {setting.name for setting in command.limited_by}


def _implemented(old: Command, new: Command) -> Impact:
    return Impact.SILENT if new.implemented else Impact.LOUD


_OF_COMMAND = (
    Attribute[Command](
        "implemented-changed", "implemented", lambda c: Keyword("yes" if c.implemented else "no"), impact=_implemented
    ),
    Attribute[Command]("reply-time-changed", "reply_within_ms", lambda c: given(c.reply_within_ms)),
)
_MODE = Attribute[Command]("mode-of-command-changed", "mode", lambda c: c.mode or Keyword("none"), impact=Impact.LOUD)
_LIMITS = Attribute[Command]("limits-changed", "limited_by", _limits, _limited_by, Impact.SILENT)
_EXCEPTIONS = Attribute[Command](
    "limits-changed", "not_limited_by", _limits, lambda c: {s.name for s in c.not_limited_by}
)


@dataclass(frozen=True)
class _Conditions:
    """Which nodes have a command or an entry, and its effects."""

    only: Mapping[str, tuple[str, ...]]
    effects: tuple[Effect, ...]


def _effects(old: _Conditions, new: _Conditions) -> Impact:
    before, after = ({e.name for e in c.effects} for c in (old, new))
    differing = [e for e in (*old.effects, *new.effects) if (e.name in before) != (e.name in after)]
    return Impact.SILENT if any(e.level is not Level.NOTE for e in differing) else Impact.SAFE


_OF_CONDITIONS = (
    Attribute[_Conditions]("availability-changed", "only", lambda c: scope(c.only), lambda c: c.only),
    Attribute[_Conditions](
        "effects-changed",
        "effects",
        lambda c: listed(e.name for e in c.effects),
        lambda c: {e.name for e in c.effects},
        _effects,
    ),
)


def _conditions(both: Editions, old: Command, new: Command) -> Iterator[tuple[_Conditions, _Conditions]]:
    """The conditions of a command in each edition: what all its entries have in common in both, and the rest."""
    forms = [edition.forms(command.spec_name) for edition, command in ((both.old, old), (both.new, new))]
    effects = {e.name for c in (*forms[0], *forms[1]) for e in c.effects}
    parameters = {p for c in (*forms[0], *forms[1]) for p in c.only}
    alike = {name for name in effects if all(_alike([name in {e.name for e in c.effects} for c in f]) for f in forms)}
    alike_only = {p for p in parameters if all(_alike([c.only.get(p) for c in f]) for f in forms)}
    for command in (old, new):
        common = {p: v for p, v in command.only.items() if p in alike_only}
        rest = {p: v for p, v in command.only.items() if p not in alike_only}
        yield (
            _Conditions(common, tuple(e for e in command.effects if e.name in alike)),
            _Conditions(rest, tuple(e for e in command.effects if e.name not in alike)),
        )


def _alike(values: list[object]) -> bool:
    return all(value == values[0] for value in values)


def _texts(collector: Collector, old: Command, new: Command) -> None:
    item, places = _item(old), paths(old, new)
    collector.title(item, at(places, "title"), new.spec_name, old.spec_title, new.spec_title)
    collector.text("text-changed", item, at(places, "about"), old.spec_name, old.about, new.about)
    notes = [{lang: "\n".join(n[lang] for n in c.notes) for lang in c.title} for c in (old, new)]
    collector.text("text-changed", item, at(places, "notes"), old.spec_name, *notes)
    collector.section(item, places, old.manual, new.manual, AffectedUsers((), (old.spec_name,)))


def _forms(collector: Collector, both: Editions, old: Command, new: Command) -> None:
    """Adds the changes of the forms of request and reply."""
    receiving, sending = (AffectedUsers((side,), (old.spec_name,)) for side in (Side.RECEIVING, Side.SENDING))
    emptied = {
        direction
        for direction, old_message, new_message in forms.own_messages(old, new)
        if forms.is_emptied(old_message, new_message)
    }

    def request(command: Command) -> str:
        if command is new and Direction.REQUEST in emptied:
            return forms.NO_FIELDS
        return forms.NONE if command.request is None else forms.FIELDS

    def reply(command: Command) -> str:
        if command is new and Direction.REPLY in emptied:
            return forms.NO_FIELDS
        return forms.reply_form(command, both.commands if command is old else {})

    def shown_reply(command: Command) -> str:
        shared = (r.message.layout for r in command.replies if isinstance(r, SharedReply))
        name = "".join(layout.name for layout in shared if is_named(layout))
        return name or (reply(command) if command is new else forms.reply_form(command, {}))

    collector.attributes(
        [Attribute[Command]("request-changed", "request", request)], _item(old), paths(old, new), old, new, sending
    )
    if _is_gone_with_another(both, old, new):
        return
    if reply(old) == reply(new):
        places = at(paths(old, new), "reply")
        collector.attributes([_REPLIERS], _item(old), places, old, new, receiving)
    else:
        form = Attribute[Command]("reply-form-changed", "reply", shown_reply, reply)
        collector.attributes([form], _item(old), paths(old, new), old, new, receiving)


def _is_gone_with_another(both: Editions, old: Command, new: Command) -> bool:
    """Whether a command has no reply any more because that of another command, which it had, is gone."""
    names = {both.commands.get(r.of, r.of) for r in old.replies if isinstance(r, OtherReply)}
    return not new.replies and any(c.name in names and not c.replies for c in both.new.commands)


def _repliers(command: Command) -> SentenceArgument:
    return (
        (Keyword("the nodes"), f" {listed(command.from_each)}") if command.from_each else Keyword("the node addressed")
    )


_REPLIERS = Attribute[Command]("repliers-changed", "from_each", _repliers)
_OF_MESSAGE = (
    Attribute[Message]("accept-changed", "accept", lambda m: listed(map(discriminators.code, m.accepted_codes))),
    Attribute[Message]("frame-kind-changed", "remote", lambda m: Keyword("remote frame" if m.remote else "data frame")),
)
_REPLY_CODE = Attribute[Message](
    "reply-code-changed",
    "code",
    lambda m: discriminators.code(discriminators.code_sent(m)),
)
_DLC = Attribute[Message]("dlc-changed", "dlc", lambda m: str(m.dlc))


def _message(
    collector: Collector,
    both: Editions,
    old: Command,
    new: Command,
    old_message: Message,
    new_message: Message,
    use: AffectedUsers,
    *,
    is_other: bool,
) -> None:
    """Adds changes of a message besides its layout; those of one with another layout are part of that change."""
    rows = list(_OF_MESSAGE)
    if discriminators.same_kind(old, new) and [discriminators.code_sent(m) for m in (old_message, new_message)] != [
        old.code,
        new.code,
    ]:
        rows.insert(0, _REPLY_CODE)
    item, places, direction = _item(old), paths(old_message, new_message), Keyword(old_message.direction.value)
    if [old_message.dlc, new_message.dlc] == [edition.bus.dlc for edition in (both.old, both.new)]:
        item_of_bus: tuple[Item, Places] = Item("bus", ""), (("bus",), ("bus",))
        collector.attributes([_DLC], *item_of_bus, old_message, new_message, use, direction=Keyword("usual frame"))
    else:
        rows.append(_DLC)
    if not is_other:
        collector.attributes(rows, item, places, old_message, new_message, use, direction=direction)
