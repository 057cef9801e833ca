"""Collects changes: each once, with all the commands that it affects."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.deprecation import Deprecation
from ..model.edition import Edition
from ..model.types import Assignment, ImpliedTitle, Text
from .catalogue import CHANGES
from .change import Category, Change, Impact, Item, Keyword, SentenceArgument, Side, worst
from .exported_names import ExportedNames

T = TypeVar("T")

Places = tuple[DocumentPath, DocumentPath]
"""The path of something in the old and in the new edition."""
BOTH_SIDES = tuple(Side)


@dataclass(frozen=True)
class Attribute(Generic[T]):
    """An attribute that is compared by itself: the rule of its change, its key in a spec, and how it is shown.

    `value` is what is compared, where that is not what is shown. `impact` is that of a change without witnesses.
    """

    rule: str
    key: str
    shown: Callable[[T], SentenceArgument]
    value: Callable[[T], object] | None = None
    impact: Impact | Callable[[T, T], Impact] | None = None


class Located(Protocol):
    """Something with a path in a spec."""

    @property
    def path(self) -> DocumentPath: ...


class Titled(Protocol):
    """Something with texts for people."""

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> Text: ...
    @property
    def about(self) -> Text: ...


class Collector:
    """Collects changes. One that is found again for another command is the same change."""

    def __init__(self, names: ExportedNames, old: Edition, new: Edition) -> None:
        self._names = names
        self._old, self._new = old, new
        self._sharing: dict[str, list[str]] = defaultdict(list)
        """The commands whose reply is that of a command."""
        for command in old.commands:
            if command.reply is not None and command.reply.command != command.name:
                self._sharing[old.command(command.reply.command).spec_name].append(command.spec_name)
        self._changes: dict[object, Change] = {}
        self._texts: dict[object, Places] = {}
        self.moved: dict[DocumentPath, DocumentPath] = {}
        """Where the old edition has what is compared under a new name."""

    def empty_copy(self) -> Collector:
        """An empty collector, for changes that are parts of one."""
        return Collector(self._names, self._old, self._new)

    def add(self, change: Change) -> None:
        """Adds a change, or the sides and commands that it affects, too."""
        change = change._replace(old=self._original(change.old or ()))
        facts = tuple((name, _frozen(fact)) for name, fact in change.facts.items())
        key = (change.rule.id, change.item, facts, change.old, change.new)
        known = self._changes.get(key, change)
        verdicts = {
            side: worst(of[side] for of in (known.verdicts, change.verdicts) if side in of)
            for side in Side
            if side in known.verdicts or side in change.verdicts
        }
        used_by = tuple(dict.fromkeys((*known.used_by, *change.used_by)))
        self._changes[key] = change._replace(verdicts=verdicts, used_by=used_by)

    def with_sharing(self, commands: Iterable[str]) -> tuple[str, ...]:
        """Some commands, and those whose replies are theirs."""
        commands = tuple(commands)
        return tuple(dict.fromkeys((*commands, *(sharing for name in commands for sharing in self._sharing[name]))))

    def allows_removal(self, deprecation: Deprecation) -> bool | None:
        """Whether the new edition may lack what is deprecated; None if its dates do not decide that."""
        return deprecation.allows_removal(self._new.name, self._new.date)

    def is_first(self, text: object, places: Places) -> bool:
        """Whether a change of a text was not found elsewhere, as that of the title of an entry and its field."""
        return self._texts.setdefault(text, places) == places

    def names(self, places: Places) -> str:
        """The exported names of an item in both editions, of every target where they differ."""
        return self._names.renamed(self._original(places[0]), places[1])

    def _original(self, path: DocumentPath) -> DocumentPath:
        """Where the old edition has an item, given its path under new names."""
        for now, was in self.moved.items():
            if path[: len(now)] == now:
                path = (*was, *path[len(now) :])
        return path

    def __iter__(self) -> Iterator[Change]:
        return iter(self._changes.values())


class Subject(NamedTuple):
    """What is compared: its item, its path in each edition, and where it is used: by which sides, in which commands."""

    collector: Collector
    item: Item
    places: Places
    sides: tuple[Side, ...] = ()
    commands: tuple[str, ...] = ()

    def at(self, key: str) -> Subject:
        """A key inside it."""
        return self.within((*self.places[0], key), (*self.places[1], key))

    def within(self, old: DocumentPath, new: DocumentPath) -> Subject:
        """A part of it, or what it belongs to, at other paths."""
        return self._replace(places=(old, new))

    def of(self, item: Item, old: Located, new: Located) -> Subject:
        """Another item that is used in the same places."""
        return self._replace(item=item, places=(old.path, new.path))

    def used(self, *sides: Side) -> Subject:
        """As this, where these sides use it."""
        return self._replace(sides=sides)

    def add(
        self,
        rule: str,
        impact: Impact | None = None,
        cases: tuple[Assignment, ...] = (),
        announced: bool = False,
        /,
        **facts: SentenceArgument,
    ) -> None:
        """Adds a change, with an `impact` if the rule is one of bits without witnesses."""
        kind = CHANGES[rule]
        assert impact is None or kind.without_witness, rule
        impact = impact or (Impact.BUILD if kind.category is Category.API else Impact.SAFE)
        verdicts = {} if kind.has_witnesses else dict.fromkeys(self.sides, impact)
        used_by = self.collector.with_sharing(self.commands) if Side.RECEIVING in self.sides else self.commands
        self.collector.add(Change(kind, self.item, facts, *self.places, verdicts, used_by, cases, announced=announced))

    def removed(self, rule: str, was: Deprecation | None, /, **facts: SentenceArgument) -> None:
        """Adds its removal, with its deprecation."""
        allowed = self.collector.allows_removal(was) if was is not None else None
        facts["deprecation"] = _removal(was, allowed) if was else ""
        self.add(rule, None, (), allowed is True, **facts)

    def attributes(self, rows: Iterable[Attribute[T]], old: T, new: T, /, **facts: SentenceArgument) -> None:
        """Adds a change for each attribute that differs."""
        for row in rows:
            value = row.value or row.shown
            if value(old) != value(new):
                impact = row.impact(old, new) if callable(row.impact) else row.impact
                self.at(row.key).add(row.rule, impact, **facts, old=row.shown(old), new=row.shown(new))

    def renamed(self, rule: str, old: str, new: str, /, **facts: SentenceArgument) -> None:
        """Adds a change of a name alone, where the name differs."""
        if old != new:
            if "{names}" in CHANGES[rule].says:
                facts["names"] = self.collector.names(self.places) or f"`{old}` → `{new}`"
            self.add(rule, **facts, old=old, new=new)

    def deprecation(self, name: str, old: Deprecation | None, new: Deprecation | None) -> None:
        """Adds a change of since when, and until when, it is deprecated."""
        if old != new:
            kind = "added" if old is None else "removed" if new is None else "changed"
            facts = {key: _period(deprecation) for key, deprecation in (("old", old), ("new", new)) if deprecation}
            self._unused.at("deprecated").add(f"deprecation-{kind}", name=name, **facts)

    def section(self, old: str, new: str) -> None:
        """Adds a change of the section of the manual."""
        if old != new:
            self.used().at("manual").add("section-changed", old=section(old), new=section(new))

    def manual_name(self, old: str, new: str) -> None:
        """Adds a change of the name in the manual."""
        if old != new:
            self._unused.at("manual_name").add("manual-name-changed", old=section(old), new=section(new))

    def text(self, rule: str, key: str, name: str, old: Text, new: Text) -> None:
        """Adds a change of the text at a key, in the languages in which it differs, of those that both have."""
        languages, subject = differing(old, new), self._unused.at(key)
        text = (rule, self.item, name, _frozen(old), _frozen(new))
        if languages and self.collector.is_first(text, subject.places):
            subject.add(rule, name=name, old=shortened(old, languages), new=shortened(new, languages))

    def title(self, name: str, old: Text, new: Text) -> None:
        """Adds a change of a title, unless none is written in either spec."""
        if not all(isinstance(title, ImpliedTitle) for title in (old, new)):
            self.text("title-changed", "title", name, old, new)

    def texts(self, old: Titled, new: Titled) -> None:
        """Adds changes of a title and a description."""
        self.title(new.name, old.title, new.title)
        self.text("text-changed", "about", new.name, old.about, new.about)

    @property
    def _unused(self) -> Subject:
        """As this, for texts, which affect no command."""
        return self._replace(sides=(), commands=())


def paths(old: Located, new: Located) -> Places:
    """Where two things are."""
    return old.path, new.path


def _frozen(fact: SentenceArgument) -> object:
    if isinstance(fact, tuple):
        return tuple(map(_frozen, fact))
    return fact if isinstance(fact, str) else tuple(fact.items())


def _period(deprecation: Deprecation) -> SentenceArgument:
    until: tuple[SentenceArgument, ...] = (", ", Keyword("until"), f" {deprecation.until}") if deprecation.until else ()
    return (Keyword("since"), f" {deprecation.since}", *until)


def _removal(deprecation: Deprecation, allowed: bool | None) -> SentenceArgument:
    """How a removal agrees with the deprecation, in parentheses."""
    kind = {True: "as announced", False: "earlier than announced", None: "perhaps earlier than announced"}[allowed]
    return (" ", Keyword(kind), " (", Keyword("deprecated"), " ", _period(deprecation), ")")


def section(manual: str) -> SentenceArgument:
    """A section of the manual, as its writer calls it."""
    return {"en": manual} if manual else Keyword("none")


def differing(old: Text, new: Text) -> list[str]:
    """The languages that both have and in which a text is another one."""
    return [language for language in old if language in new and old[language] != new[language]]


def shortened(text: Text, languages: Iterable[str], longest: int = 100) -> Mapping[str, str]:
    """A text that fits a line, in some languages."""
    texts = {language: text[language] for language in languages}
    return {k: t if len(t) <= longest else t[: longest - 1].rstrip() + "…" for k, t in texts.items()}


def listed(names: Iterable[object]) -> str:
    """`a, b`, or `none`."""
    return ", ".join(map(str, names)) or Keyword("none")


def scope(only: Mapping[str, tuple[str, ...]]) -> str:
    """The parameter values that have something, or `all`."""
    return formatting.condition(only) or Keyword("all")


def given(value: object | None) -> str:
    """A value, or `not given`."""
    return Keyword("not given") if value is None else str(value)
