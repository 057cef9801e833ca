"""Collects changes: each once, with all the commands that it affects."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

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


@dataclass(frozen=True)
class AffectedUsers:
    """Where something is used: what the host does with it, and the commands."""

    sides: tuple[Side, ...] = ()
    commands: tuple[str, ...] = ()


UNUSED = AffectedUsers()
BOTH_SIDES = AffectedUsers(tuple(Side))


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

    def add(
        self,
        rule: str,
        item: Item,
        places: Places,
        use: AffectedUsers,
        impact: Impact | None = None,
        cases: tuple[Assignment, ...] = (),
        announced: bool = False,
        /,
        **facts: SentenceArgument,
    ) -> None:
        """Adds a change by `rule` of something at `places`, with an `impact` if the rule is one of bits without witnesses."""
        kind = CHANGES[rule]
        assert impact is None or kind.without_witness, rule
        old, new = self._original(places[0]), places[1]
        key = (rule, item, tuple((name, _frozen(fact)) for name, fact in facts.items()), old, new)
        known = self._changes.get(key)
        impact = impact or (Impact.BUILD if kind.category is Category.API else Impact.SAFE)
        verdicts = {} if kind.has_witnesses else dict.fromkeys(use.sides, impact)
        sharing = [c for of in use.commands for c in self._sharing[of]] if Side.RECEIVING in use.sides else []
        used_by = tuple(dict.fromkeys((*use.commands, *sharing)))
        change = Change(kind, item, facts, old, new, verdicts, used_by, cases, announced=announced)
        if known is not None:
            both = known.verdicts, verdicts
            verdicts = {s: worst(v[s] for v in both if s in v) for s in Side if any(s in v for v in both)}
            change = dataclasses.replace(
                change, verdicts=verdicts, used_by=tuple(dict.fromkeys((*known.used_by, *used_by)))
            )
        self._changes[key] = change

    def removed(
        self,
        rule: str,
        item: Item,
        places: Places,
        use: AffectedUsers,
        was: Deprecation | None,
        /,
        **facts: SentenceArgument,
    ) -> None:
        """Adds the removal of something, with its deprecation."""
        allowed = was is not None and was.allows_removal(self._new.name, self._new.date)
        facts["deprecation"] = _removal(was, allowed) if was else ""
        self.add(rule, item, places, use, None, (), allowed is True, **facts)

    def deprecation(
        self, item: Item, places: Places, name: str, old: Deprecation | None, new: Deprecation | None
    ) -> None:
        """Adds a change of since when, and until when, something is deprecated."""
        if old != new:
            kind = "added" if old is None else "removed" if new is None else "changed"
            facts = {key: _period(deprecation) for key, deprecation in (("old", old), ("new", new)) if deprecation}
            self.add(f"deprecation-{kind}", item, at(places, "deprecated"), UNUSED, name=name, **facts)

    def attributes(
        self,
        rows: Iterable[Attribute[T]],
        item: Item,
        places: Places,
        old: T,
        new: T,
        use: AffectedUsers,
        /,
        **facts: SentenceArgument,
    ) -> None:
        """Adds a change for each attribute that differs."""
        for row in rows:
            value = row.value or row.shown
            if value(old) != value(new):
                impact = row.impact(old, new) if callable(row.impact) else row.impact
                shown = {"old": row.shown(old), "new": row.shown(new)}
                self.add(row.rule, item, at(places, row.key), use, impact, **facts, **shown)

    def renamed(self, rule: str, item: Item, places: Places, use: AffectedUsers, /, **facts: SentenceArgument) -> None:
        """Adds a change of a name alone, where the name differs."""
        if facts["old"] == facts["new"]:
            return
        if "{names}" in CHANGES[rule].says:
            facts["names"] = self.names(*places) or f"`{facts['old']}` → `{facts['new']}`"
        self.add(rule, item, places, use, **facts)

    def names(self, old: DocumentPath, new: DocumentPath) -> str:
        """The exported names of an item in both editions, of every target where they differ."""
        return self._names.renamed(self._original(old), new)

    def _original(self, path: DocumentPath) -> DocumentPath:
        """Where the old edition has an item, given its path under new names."""
        for now, was in self.moved.items():
            if path[: len(now)] == now:
                path = (*was, *path[len(now) :])
        return path

    def section(self, item: Item, places: Places, old: str, new: str, use: AffectedUsers = UNUSED) -> None:
        """Adds a change of the section of the manual."""
        if old != new:
            facts = {"old": section(old), "new": section(new)}
            self.add("section-changed", item, at(places, "manual"), use, **facts)

    def text(self, rule: str, item: Item, places: Places, name: str, old: Text, new: Text) -> None:
        """Adds a change of a text in the languages in which it differs, of those that both have."""
        key = (rule, item, name, _frozen(old), _frozen(new))
        if (
            differing(old, new) and self._texts.setdefault(key, places) == places
        ):  # as the title of an entry and its field
            before, after = (shortened(text, differing(old, new)) for text in (old, new))
            self.add(rule, item, places, UNUSED, name=name, old=before, new=after)

    def title(self, item: Item, places: Places, name: str, old: Text, new: Text) -> None:
        """Adds a change of a title, unless none is written in either spec."""
        if not all(isinstance(title, ImpliedTitle) for title in (old, new)):
            self.text("title-changed", item, places, name, old, new)

    def texts(self, item: Item, places: Places, old: Titled, new: Titled) -> None:
        """Adds changes of a title and a description."""
        self.title(item, at(places, "title"), new.name, old.title, new.title)
        self.text("text-changed", item, at(places, "about"), new.name, old.about, new.about)

    def __iter__(self) -> Iterator[Change]:
        return iter(self._changes.values())


def paths(old: Located, new: Located) -> Places:
    """Where two things are."""
    return old.path, new.path


def at(places: Places, key: str) -> Places:
    """The places of a key inside others."""
    return (*places[0], key), (*places[1], key)


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


def shortened(text: Text, languages: Iterable[str], longest: int = 60) -> Mapping[str, str]:
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
