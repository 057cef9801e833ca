"""Changes of commands: which there are, their codes, frames, conditions and effects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from ..model.layout import Layout
from ..model.message import Command, Direction, Entry, Message, OtherReply, Reply, SharedReply
from ..model.metadata import Effect, EndsMotion, Level, Repeat
from . import discriminators, fields, forms, match
from .change import Impact, Item, Keyword, SentenceArgument, Side
from .collector import BOTH_SIDES, Attribute, Collector, Subject, given, listed, paths, scope
from .fields import Editions
from .forms import is_named, messages
from .match import Matched


def compare(collector: Collector, old: Edition, new: Edition, matched: Matched[Command]) -> None:
    """All changes of all commands, and of the layouts and types that they use."""
    layouts = [(a.layout, b.layout) for pair in matched.pairs for _, a, b in messages(*pair)]
    pairs = [(a.name, b.name) for a, b in layouts if a.shared and b.shared]
    types = [(a.name, b.name) for a, b in fields.type_pairs(layouts)]
    kept = _tables(collector, old, new)
    matched = Matched(
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
    command = _subject(collector, old, new).used(*BOTH_SIDES)
    command.at("table").add("table-of-command-changed", old=_table(old), new=_table(new))


def _table(command: Command) -> SentenceArgument:
    return (Keyword("the table"), f" `{command.entry.table}`") if command.entry else Keyword("no table")


def _subject(collector: Collector, old: Command, new: Command) -> Subject:
    """A command of both editions, or of one."""
    side = Side.SENDING if old.request else Side.RECEIVING
    return Subject(collector, Item("command", old.spec_name), paths(old, new), (side,), (old.spec_name,))


def _code(command: Command) -> str:
    return f" ({discriminators.code(command.code)})" if command.code is not None else ""


def _repurposed(collector: Collector, old: Command, new: Command) -> None:
    command = _subject(collector, old, new).used(*BOTH_SIDES)
    if old.entry and new.entry and old.spec_name == new.spec_name:
        entry = command.of(Item.of_entry(old.entry), old.entry, new.entry)
        facts = {"index": discriminators.index(old), "old": old.entry.name, "new": new.entry.name}
        entry.add("entry-repurposed", **facts)
    else:
        facts = {"code": _code(old), "old": old.spec_name, "new": new.spec_name}
        command.add("command-repurposed", **facts, meaning=new.spec_title)


def _removed(collector: Collector, command: Command, new: Edition) -> None:
    subject, parent, facts = _alone(collector, command, new)
    subject = subject.within(subject.places[0], parent).used(Side.SENDING)
    if subject.item.kind == "command":
        subject.removed("command-removed", command.deprecated, **facts)
    else:
        subject.add("entry-removed", **facts)


def _added(collector: Collector, command: Command, old: Edition) -> None:
    subject, parent, facts = _alone(collector, command, old)
    subject.within(parent, subject.places[1]).used().add(f"{subject.item.kind}-added", **facts)


def _alone(collector: Collector, command: Command, edition: Edition) -> tuple[Subject, DocumentPath, dict[str, str]]:
    """A command that the other edition lacks, or its entry alone, with the path where it would be, and facts."""
    subject, entry = _subject(collector, command, command), command.entry
    if entry is not None and edition.forms(command.spec_name):
        facts = {"name": entry.name, "index": discriminators.index(command)}
        return subject.of(Item.of_entry(entry), entry, entry), ("tables", entry.table), facts
    return subject, ("commands",), {"name": command.spec_name, "code": _code(command)}


def _command(collector: Collector, both: Editions, old: Command, new: Command) -> None:
    command = _subject(collector, old, new)
    if old.entry and new.entry and old.entry.name != new.entry.name:
        entry = command.of(Item.of_entry(old.entry), old.entry, new.entry)
        entry.renamed("entry-renamed", old.entry.name, new.entry.name)
    else:
        command.renamed("command-renamed", old.spec_name, new.spec_name)
    if old.spec_name == new.spec_name:
        command.renamed("short-name-changed", old.short_spec_name, new.short_spec_name)
    discriminators.compare(command, both, old, new)
    (own, of_entry), (new_own, new_of_entry) = _conditions(both, old, new)
    limits = _EXCEPTIONS if _limited_by(old) == _limited_by(new) else _LIMITS
    first = [next((mode.name for mode in edition.bus.modes), None) for edition in (both.old, both.new)]
    modes = () if [old.mode, new.mode] == first else (_MODE,)  # both in the usual mode, the first
    if old.entry and new.entry:
        _entry(command, both, old.entry, new.entry)
    command.attributes((*_OF_COMMAND, *modes, limits), old, new)
    command.attributes(_OF_CONDITIONS, own, new_own)
    if old.entry and new.entry:
        entry = command.of(Item.of_entry(old.entry), old.entry, new.entry)
        entry.attributes(_OF_CONDITIONS, of_entry, new_of_entry)
    command.deprecation(new.spec_name, old.deprecated, new.deprecated)
    _texts(command, old, new)
    _forms(command, both, old, new)
    _address(command, old, new)
    for direction, *frames in messages(old, new):
        used = command.used(Side.of(direction))
        is_other = _other_layout(used, both, frames[0], frames[1])
        _message(used, both, (old, new), *frames, is_other=is_other)
        if not is_other:
            _layout_name(used, both, old, *frames)
            fields.compare(used, both, *frames)


def _address(command: Subject, old: Command, new: Command) -> None:
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
        subject = command if follows else command.within(old_message.path, new_message.path)
        subject.used(*map(Side.of, directions)).at("address").add(
            "address-of-command-changed",
            direction=Keyword(" and ".join(d.value for d in directions)),
            old=old_message.address,
            new=new_message.address,
        )


def _layout_name(command: Subject, both: Editions, of: Command, old: Message, new: Message) -> None:
    """Adds the change of where the same fields of a message are defined, which names its type in the bindings."""
    old_layout, new_layout = old.layout, new.layout
    same_place = is_named(old_layout) == is_named(new_layout)
    renamed = same_place and (
        not is_named(old_layout) or both.layouts.get(old_layout.name, old_layout.name) == new_layout.name
    )
    keys = {*forms.constants(old), *forms.constants(new)}
    if renamed or match.content(old_layout, keys) != match.content(new_layout, keys):
        return
    subject, what = command.of(command.item, old, new), old.direction.value
    if of.entry is not None and "tables" in (old_layout.path[0], new_layout.path[0]):
        subject, what = command.of(Item.of_entry(of.entry), of.entry, of.entry), "entry"
    places = old_layout.path, new_layout.path
    names = command.collector.names(places) or f"`{old_layout.name}` → `{new_layout.name}`"
    facts = {"direction": Keyword(what), "old": _name_of(old_layout), "new": _name_of(new_layout)}
    subject.add("layout-of-command-changed", **facts, names=names)


def _name_of(layout: Layout) -> SentenceArgument:
    return ("`", layout.name, "`") if is_named(layout) else Keyword("fields of its own")


def _other_layout(command: Subject, both: Editions, old: Message, new: Message) -> bool:
    """Adds the change of the layout of a message to one that both editions have; whether there is one."""
    layouts = [old.layout, new.layout]
    if match.content(layouts[0]) == match.content(layouts[1]) or not _is_other_layout(both, *layouts):
        return False
    is_request = old.direction is Direction.REQUEST
    rule, key = ("request-changed", "request") if is_request else ("reply-form-changed", "reply")
    shown = [layout.name if is_named(layout) else forms.FIELDS for layout in layouts]
    command.at(key).add(rule, old=shown[0], new=shown[1])
    return True


def _is_other_layout(both: Editions, old: Layout, new: Layout) -> bool:
    was_there, is_there = new.name in {n.name for n in both.old.layouts}, old.name in {n.name for n in both.new.layouts}
    if is_named(old) and is_named(new):
        return old.name != new.name and (was_there or is_there)
    if is_named(new):
        return was_there
    return is_named(old) and is_there and not match.fields(old, new).pairs


def _entry(command: Subject, both: Editions, old: Entry, new: Entry) -> None:
    """Changes of the table and the entry that a form of a command is of."""
    before, after = both.old.table(old.table), both.new.table(new.table)
    table = command.of(Item("table", old.table), before, after)
    table.used(Side.SENDING).renamed("table-renamed", old.table, new.table)
    table.texts(before, after)
    table.section(before.manual, after.manual)
    entry = command.of(Item.of_entry(old), old, new)
    entry.texts(old, new)
    own = ["" if e.manual == t.manual else e.manual for e, t in ((old, before), (new, after))]
    entry.section(own[0], own[1])


def _limits(command: Command) -> SentenceArgument:
    settings = listed(s.name for s in command.not_limited_by)
    exceptions = (" (", Keyword("not by"), f" {settings})") if command.not_limited_by else ()
    return (listed(s.name for s in command.limited_by), *exceptions)


def _limited_by(command: Command) -> set[str]:
    return {setting.name for setting in command.limited_by}


def _implemented(old: Command, new: Command) -> Impact:
    return Impact.SILENT if new.implemented else Impact.LOUD


_ENDS_MOTION = {EndsMotion.STOP: "stop", EndsMotion.SWITCH_OFF: "switch off"}
_OF_COMMAND = (
    Attribute[Command](
        "implemented-changed", "implemented", lambda c: Keyword("yes" if c.implemented else "no"), impact=_implemented
    ),
    Attribute[Command]("reply-time-changed", "reply_within_ms", lambda c: given(c.reply_within_ms)),
    Attribute[Command](
        "repeat-changed",
        "repeat",
        lambda c: Keyword(c.repeat.value) if c.repeat else Keyword("as the effects state"),
        impact=lambda _, new: Impact.SILENT if new.repeat is Repeat.NEVER else Impact.SAFE,
    ),
    Attribute[Command](
        "ends-motion-changed",
        "ends_motion",
        lambda c: Keyword(_ENDS_MOTION[c.ends_motion]) if c.ends_motion else Keyword("no"),
        impact=Impact.SILENT,
    ),
)
_MODE = Attribute[Command]("mode-of-command-changed", "mode", lambda c: c.mode or Keyword("none"), impact=Impact.LOUD)
_LIMITS = Attribute[Command]("limits-changed", "limited_by", _limits, _limited_by, Impact.SILENT)
_EXCEPTIONS = Attribute[Command](
    "limits-changed", "not_limited_by", _limits, lambda c: {s.name for s in c.not_limited_by}
)


class _Conditions(NamedTuple):
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


def _texts(command: Subject, old: Command, new: Command) -> None:
    command.title(new.spec_name, old.spec_title, new.spec_title)
    command.text("text-changed", "about", old.spec_name, old.about, new.about)
    notes = [{lang: "\n".join(n[lang] for n in c.notes) for lang in c.title} for c in (old, new)]
    command.text("text-changed", "notes", old.spec_name, *notes)
    command.section(old.manual, new.manual)
    command.manual_name(old.manual_name, new.manual_name)


def _forms(command: Subject, both: Editions, old: Command, new: Command) -> None:
    """Adds the changes of the forms of request and reply."""
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
        shared = (r.message.layout for r in command.replies[:1] if isinstance(r, SharedReply))
        name = "".join(layout.name for layout in shared if is_named(layout))
        return name or (reply(command) if command is new else forms.reply_form(command, {}))

    command.used(Side.SENDING).attributes([Attribute[Command]("request-changed", "request", request)], old, new)
    if _is_gone_with_another(both, old, new):
        return
    command = command.used(Side.RECEIVING)
    if old.request and new.request and old.replies and new.replies:
        command.attributes(_others(both, old), old, new)
    if reply(old) == reply(new):
        command.at("reply").attributes([_REPLIERS], old, new)
    else:
        command.attributes([Attribute[Command]("reply-form-changed", "reply", shown_reply, reply)], old, new)


def _is_gone_with_another(both: Editions, old: Command, new: Command) -> bool:
    """Whether a command has no reply any more because that of another command, which it had, is gone."""
    names = {both.commands.get(r.of, r.of) for r in old.replies[:1] if isinstance(r, OtherReply)}
    return not new.replies and any(c.name in names and not c.replies for c in both.new.commands)


def _others(both: Editions, old: Command) -> tuple[Attribute[Command], ...]:
    """The replies of a command besides the first, by the names of the commands in the new edition."""

    def named(command: Command, replies: Sequence[Reply]) -> set[str]:
        names = both.commands if command is old else {}
        return {names.get(reply.message.command, reply.message.command) for reply in replies}

    def shown(replies: Sequence[Reply]) -> SentenceArgument:
        return listed(reply.message.command for reply in replies)

    return (
        Attribute[Command](
            "further-replies-changed",
            "further_replies",
            lambda c: shown(c.further_replies),
            lambda c: named(c, c.further_replies),
        ),
        Attribute[Command](
            "alternative-replies-changed",
            "alternative_replies",
            lambda c: shown(c.alternative_replies),
            lambda c: named(c, c.alternative_replies),
        ),
    )


def _repliers(command: Command) -> SentenceArgument:
    return (
        (Keyword("the nodes"), f" {listed(command.from_each)}") if command.from_each else Keyword("the node addressed")
    )


_REPLIERS = Attribute[Command]("repliers-changed", "from_each", _repliers)
_OF_MESSAGE = (
    Attribute[Message]("accept-changed", "accept", lambda m: listed(map(discriminators.code, m.accepted_codes))),
    Attribute[Message]("frame-kind-changed", "remote", lambda m: Keyword("remote frame" if m.remote else "data frame")),
)
_SENDING = (
    Attribute[Message]("frame-numbers-changed", "frames", lambda m: _frames(m), lambda m: m.sequence, Impact.LOUD),
    Attribute[Message]("sending-changed", "sent", lambda m: _occasions(m), impact=Impact.SILENT),
    Attribute[Message](
        "period-changed", "every_ms", lambda m: given(m.sending and m.sending.every_ms), impact=Impact.SILENT
    ),
    Attribute[Message](
        "timeout-changed", "timeout_ms", lambda m: given(m.sending and m.sending.timeout_ms), impact=Impact.SILENT
    ),
)
_REPLY_CODE = Attribute[Message](
    "reply-code-changed",
    "code",
    lambda m: discriminators.code(discriminators.code_sent(m)),
)
_DLC = Attribute[Message]("dlc-changed", "dlc", lambda m: str(m.dlc))


def _frames(message: Message) -> SentenceArgument:
    sequence = message.sequence
    if sequence is None:
        return Keyword("one frame")
    return (Keyword("the frames"), f" {sequence.numbers[0]}..{sequence.numbers[-1]} (`{sequence.field}`)")


def _occasions(message: Message) -> SentenceArgument:
    return listed(o.value for o in message.sending.occasions) if message.sending else Keyword("as usual")


def _message(
    command: Subject, both: Editions, commands: tuple[Command, Command], old: Message, new: Message, *, is_other: bool
) -> None:
    """Adds changes of a message besides its layout; those of one with another layout are part of that change."""
    rows, direction = list(_OF_MESSAGE), Keyword(old.direction.value)
    codes = [discriminators.code_sent(m) for m in (old, new)]
    if discriminators.same_kind(*commands) and codes != [c.code for c in commands]:
        rows.insert(0, _REPLY_CODE)
    if [old.dlc, new.dlc] == [edition.bus.dlc for edition in (both.old, both.new)]:
        bus = command._replace(item=Item("bus", ""), places=(("bus",), ("bus",)))
        bus.attributes([_DLC], old, new, direction=Keyword("usual frame"))
    else:
        rows.append(_DLC)
    if not is_other:
        command.of(command.item, old, new).attributes((*rows, *_SENDING), old, new, direction=direction)
