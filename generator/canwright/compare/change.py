"""One change between two editions: what, where, and who is affected."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..model.message import Direction, Entry
from ..model.types import Assignment, Text

if TYPE_CHECKING:
    from .witnesses.witness import Witness


class Category(str, Enum):
    """What kind of thing changed."""

    WIRE = "wire"
    """Which bits are sent, and when."""
    VALUE = "value"
    """What the bits mean, and what a command does."""
    API = "api"
    """Names in the bindings."""
    DOC = "doc"
    """Texts, sections and errata."""


class Impact(str, Enum):
    """The effect of one change on a program of the old edition that communicates with a node of the new one."""

    SILENT = "silent"
    """The program keeps running, but reads or commands something else."""
    LOUD = "loud"
    """The program receives no reply or reports an error."""
    BUILD = "build"
    """The program runs as before, but must be adapted before it builds with the new bindings."""
    SAFE = "safe"
    """The program is not affected."""


def worst(impacts: Iterable[Impact]) -> Impact:
    """The worst of some impacts; safe without any."""
    return min(impacts, key=list(Impact).index, default=Impact.SAFE)


class Side(str, Enum):
    """What the host does when a change affects it."""

    SENDING = "sending"
    RECEIVING = "receiving"

    @classmethod
    def of(cls, direction: Direction) -> Side:
        """The side that a frame of a direction concerns."""
        return cls.SENDING if direction is Direction.REQUEST else cls.RECEIVING


class Keyword(str):
    """A word that belongs to the sentence, such as `none`, and is translated with it; names are not."""


SentenceArgument = str | Text | tuple["SentenceArgument", ...]
"""The value of a placeholder: text without a language, a text of the spec in its languages, or parts of both."""


def filled(fact: SentenceArgument, language: str, words: Mapping[str, str], escape: Callable[[str], str]) -> str:
    """An argument as text in a language."""
    if isinstance(fact, Keyword):
        return words.get(fact, fact)
    if isinstance(fact, tuple):
        return "".join(filled(part, language, words, escape) for part in fact)
    return fact if isinstance(fact, str) else escape(fact.get(language) or next(iter(fact.values()), ""))


def with_facts(
    sentence: str,
    facts: Mapping[str, SentenceArgument],
    language: str,
    words: Mapping[str, str],
    escape: Callable[[str], str],
) -> str:
    """A sentence as text in a language, with the facts that it names in braces."""
    return sentence.format_map({name: filled(fact, language, words, escape) for name, fact in facts.items()})


class ChangeRule(NamedTuple):
    """An id for people to look up, and the sentence, with names of facts in braces, that describes a change."""

    id: str
    category: Category
    purpose: str
    says: str
    without_witness: str = ""
    """The key of the reason why no frame can show a change of bits or of meaning."""

    @property
    def has_witnesses(self) -> bool:
        """Whether frames show the change, so that its impact is what they show."""
        return self.category in (Category.WIRE, Category.VALUE) and not self.without_witness


class Item(NamedTuple):
    """What a change belongs to, as `command dim`."""

    kind: str
    name: str

    @classmethod
    def of_entry(cls, entry: Entry) -> Item:
        return cls("entry", f"{entry.table}.{entry.name}")

    def __str__(self) -> str:
        return f"{self.kind} {self.name}" if self.name else self.kind


class Change(NamedTuple):
    """One change. `old` and `new` are its paths in the specs; `used_by` are the commands it affects.

    `verdicts` are the impacts on the sides that it affects. `cases` are the parameter values under which it applies, all
    if empty. `witnesses` are the frames that demonstrate it, the worst of each side first.
    `announced` is true for the removal of something that was deprecated long enough.
    """

    rule: ChangeRule
    item: Item
    facts: Mapping[str, SentenceArgument]
    old: DocumentPath | None
    new: DocumentPath | None
    verdicts: Mapping[Side, Impact]
    used_by: tuple[str, ...]
    cases: tuple[Assignment, ...] = ()
    witnesses: tuple[Witness, ...] = ()
    announced: bool = False

    @property
    def impact(self) -> Impact:
        """The worst impact on a side."""
        return worst(self.verdicts.values())

    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides that it affects."""
        return tuple(self.verdicts)

    def is_in(self, language: str) -> bool:
        """Whether it is no change of a text, or changes the text in this language."""
        new = self.facts.get("new")
        return self.rule.id not in ("title-changed", "text-changed") or not isinstance(new, Mapping) or language in new

    @property
    def differs_by_side(self) -> bool:
        """Whether its impacts on the sides differ."""
        return len(set(self.verdicts.values())) > 1

    def says(
        self,
        language: str = "en",
        sentence: str | None = None,
        words: Mapping[str, str] = MappingProxyType({}),
        escape: Callable[[str], str] = lambda text: text,
    ) -> str:
        """The sentence of the rule, or another one in `language` with its `words`, with the facts of this change.

        `escape` makes texts of the spec safe where the sentence goes; names and numbers are safe everywhere.
        """
        return with_facts(sentence or self.rule.says, self.facts, language, words, escape)
