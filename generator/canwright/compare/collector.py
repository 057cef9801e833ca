"""The changes that were found, each once, with all the commands that it reaches."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.types import Text
from .catalogue import CHANGES
from .change import Change, Fact, Impact, Item, Said, Side
from .exported_names import ExportedNames

_ORDER = list(Impact)


@dataclass(frozen=True)
class Use:
    """Where something is used: what the host does with it, and the commands."""

    sides: tuple[Side, ...] = ()
    commands: tuple[str, ...] = ()


BOTH_SIDES = Use(tuple(Side))


class Titled(Protocol):
    """What people read of a thing."""

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> Text: ...
    @property
    def about(self) -> Text: ...


class Found:
    """Collects changes. One that is found again for another command is the same change."""

    def __init__(self, names: ExportedNames) -> None:
        self._names = names
        self._changes: dict[object, Change] = {}
        self.moved: dict[DocumentPath, DocumentPath] = {}
        """Where the old edition has what is compared under a new name."""

    def add(
        self,
        rule: str,
        item: Item,
        old: DocumentPath | None,
        new: DocumentPath | None,
        impact: Impact,
        use: Use,
        /,
        **facts: Fact,
    ) -> None:
        """A change by `rule`; `old` and `new` are where it stands."""
        old = None if old is None else self._original(old)
        told = tuple((name, _frozen(fact)) for name, fact in facts.items())
        key = (rule, item, told, old, new)
        known = self._changes.get(key)
        change = Change(CHANGES[rule], item, facts, old, new, impact, use.sides, use.commands)
        if known is not None:
            worst = min(known.impact, impact, key=_ORDER.index)
            hit = [*(known.sides if known.impact is worst else ()), *(use.sides if impact is worst else ())]
            sides = tuple(side for side in Side if side in hit)
            used_by = tuple(dict.fromkeys((*known.used_by, *use.commands)))
            change = dataclasses.replace(change, impact=worst, sides=sides, used_by=used_by)
        self._changes[key] = change

    def renamed(self, rule: str, item: Item, old: DocumentPath, new: DocumentPath, use: Use, /, **facts: Fact) -> None:
        """A change of a name alone."""
        if "{names}" in CHANGES[rule].says:
            facts["names"] = self._names.renamed(self._original(old), new) or f"`{facts['old']}` → `{facts['new']}`"
        self.add(rule, item, old, new, Impact.BUILD, use, **facts)

    def _original(self, path: DocumentPath) -> DocumentPath:
        """Where the old edition has an item, given its path under new names."""
        for now, was in self.moved.items():
            if path[: len(now)] == now:
                path = (*was, *path[len(now) :])
        return path

    def section(self, item: Item, places: tuple[DocumentPath, DocumentPath], old: str, new: str, use: Use) -> None:
        """A change of the section of the manual."""
        if old != new:
            facts = {"old": section(old), "new": section(new)}
            paths = [(*place, "manual") for place in places]
            self.add("section-changed", item, paths[0], paths[1], Impact.SAFE, use, **facts)

    def text(
        self, rule: str, item: Item, places: tuple[DocumentPath, DocumentPath], name: str, old: Text, new: Text
    ) -> None:
        """A change of a text, in any language that both have."""
        if differ(old, new):
            self.add(rule, item, *places, Impact.SAFE, Use(), name=name, old=shortened(old), new=shortened(new))

    def title(
        self, item: Item, places: tuple[DocumentPath, DocumentPath], names: tuple[str, str], old: Text, new: Text
    ) -> None:
        """A change of a title, unless both only say the names."""
        if not all(set(t.values()) == {formatting.spoken(name)} for name, t in zip(names, (old, new), strict=True)):
            self.text("title-changed", item, places, names[1], old, new)

    def texts(self, item: Item, places: tuple[DocumentPath, DocumentPath], old: Titled, new: Titled) -> None:
        """Changes of what is said of a thing: its title, and more."""
        at = [tuple((*place, key) for place in places) for key in ("title", "about")]
        self.title(item, (at[0][0], at[0][1]), (old.name, new.name), old.title, new.title)
        self.text("text-changed", item, (at[1][0], at[1][1]), new.name, old.about, new.about)

    def __iter__(self) -> Iterator[Change]:
        return iter(self._changes.values())


def _frozen(fact: Fact) -> object:
    if isinstance(fact, tuple):
        return tuple(map(_frozen, fact))
    return fact if isinstance(fact, str) else tuple(fact.items())


def section(manual: str) -> Fact:
    """A section of the manual, as its writer calls it."""
    return {"en": manual} if manual else Said("none")


def differ(old: Text, new: Text) -> bool:
    """Whether a text is another one in a language that both have."""
    return any(old[language] != new[language] for language in old.keys() & new.keys())


def shortened(text: Text, longest: int = 60) -> Mapping[str, str]:
    """A text that fits a line."""
    return {k: t if len(t) <= longest else t[: longest - 1].rstrip() + "…" for k, t in text.items()}


def listed(names: Iterable[object]) -> str:
    """`a, b`, or `none`."""
    return ", ".join(map(str, names)) or Said("none")
