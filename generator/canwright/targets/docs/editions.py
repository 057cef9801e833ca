"""Pages about several editions: changes from one to the next, and the commands of each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import Literal, NamedTuple

from ...compare import Category, Change, Impact
from ...compare.change import Item
from ...compare.verdicts import examples, reason_without_witness
from ...compare.witnesses.witness import REASONS
from ...model import formatting
from ...model.edition import Edition
from ...model.message import Command, Direction, KeyRole
from ...templating.markup import code, markdown, spaced
from .links import COMMANDS, command_page
from .tables import Labels, code_of, index as index_of

Wording = Mapping[Literal["sentences", "words", "witnesses", "reasons"], Mapping[str, str]]
"""Sentences of changes by rule, words inserted into them, and sentences about witnesses, in one language."""
ENGLISH: Wording = {"sentences": {}, "words": {}, "witnesses": {}, "reasons": REASONS}
"""The sentences of the comparison, unchanged."""


class Book(NamedTuple):
    """The documents in one language; `listed` are its editions with their folders, oldest first."""

    language: str
    labels: Labels
    wording: Wording
    listed: Sequence[tuple[str, Edition]]
    view: Mapping[str, object]
    """Variables of every template."""


class ChangeLine(NamedTuple):
    """A row of the page of changes, its cells in Markdown."""

    what: str
    change: str
    frames: str
    kind: str
    host: str


class Changes(NamedTuple):
    """Changes since the previous edition, by impact; texts and errata separately."""

    previous: Edition
    sections: tuple[tuple[Impact, tuple[ChangeLine, ...]], ...]
    documents: tuple[ChangeLine, ...]


SupportLine = tuple[str, Sequence[str]]
"""A command or an entry with its title, and one cell for each edition, in Markdown."""


class Support(NamedTuple):
    """Commands and entries of the editions of a family."""

    family: str
    editions: tuple[tuple[str, Edition], ...]
    commands: tuple[SupportLine, ...]
    entries: tuple[SupportLine, ...]


def in_order(editions: Iterable[Edition]) -> list[Edition]:
    """Editions by family and date, oldest first."""
    return sorted(editions, key=lambda e: (e.family, e.date, e.name))


def previous(edition: Edition, editions: Sequence[Edition]) -> Edition | None:
    """The previous edition of the same family, or None."""
    family = [e for e in in_order(editions) if e.family == edition.family]
    at = family.index(edition)
    return family[at - 1] if at else None


class FrontLine(NamedTuple):
    """A row of the front page, in Markdown: reply ids and codes unique to the edition, and whether it has a predecessor."""

    folder: str
    edition: Edition
    replies: str
    alone: str
    has_changes: bool


def front(editions: Sequence[tuple[str, Edition]]) -> Iterator[FrontLine]:
    """The rows of the front page. `editions` come with their folders."""
    for folder, edition in editions:
        family = [member for _, member in editions if member.family == edition.family and member is not edition]
        codes, of_family = _codes([edition]), _codes(family)
        yield FrontLine(
            folder,
            edition,
            ", ".join(
                dict.fromkeys(code(formatting.id_rule(message.id)) for message in edition.messages(Direction.REPLY))
            ),
            (", ".join(code(f"0x{c:02X}") for c in sorted(codes - of_family)) or "—") if family else "",
            previous(edition, [listed for _, listed in editions]) is not None,
        )


def _codes(editions: Iterable[Edition]) -> set[int]:
    return {c.code for edition in editions for c in edition.commands if c.code is not None}


def by_command(editions: Sequence[tuple[str, Edition]]) -> Mapping[tuple[str, str], list[tuple[str, Edition]]]:
    """Editions with their folders, by family and by the name of a command they have."""
    having: dict[tuple[str, str], list[tuple[str, Edition]]] = {}
    for folder, edition in editions:
        for command in edition.commands:
            listed = having.setdefault((edition.family, command.spec_name), [])
            if (folder, edition) not in listed:
                listed.append((folder, edition))
    return having


PLACES = {"section-changed", "erratum-moved"}
"""Changes of where a manual states something, which each page of the edition has; there are dozens when sections get other numbers."""


def changes(old: Edition, differences: Sequence[Change], book: Book) -> Changes:
    """The page of changes since `old` from the changes `differences`."""

    def line(change: Change) -> ChangeLine:
        return _change_line(change, book)

    def is_document(change: Change) -> bool:
        return change.rule.category is Category.DOC

    texts = [c for c in differences if is_document(c) and c.is_in(book.language) and c.rule.id not in PLACES]
    sections = (
        (impact, tuple(dict.fromkeys(line(c) for c in differences if c.impact is impact and not is_document(c))))
        for impact in Impact
    )
    return Changes(
        old,
        tuple((impact, lines) for impact, lines in sections if lines),
        tuple(dict.fromkeys(map(line, texts))),
    )


def _change_line(change: Change, book: Book) -> ChangeLine:
    labels, wording = book.labels, book.wording
    sentence = change.says(book.language, wording["sentences"].get(change.rule.id), wording["words"], markdown)
    host = labels["listed"].join(
        labels[f"host_{side.value}"] + (f": {labels[f'verdict_{impact.value}']}" if change.differs_by_side else "")
        for side, impact in change.verdicts.items()
    )
    return ChangeLine(
        f"{labels[f'item_{change.item.kind}']} {code(change.item.name)}".rstrip(),
        spaced(sentence),
        spaced(_frames(change, book)),
        labels[f"kind_{change.rule.category.value}"],
        host,
    )


def affecting(differences: Sequence[Change], commands: Sequence[Command]) -> list[Change]:
    """The changes that affect the forms of a command, other than those of texts.

    They are those of the command, of the one whose place it takes, and of its addresses and parameters.
    """
    path = ("commands", commands[0].spec_name)
    names = {
        path[1],
        *(str(c.old[1]) for c in differences if c.old and c.old != path[:1] and c.new and c.new[:2] == path),
    }
    messages = [m for c in commands for m in (c.request, *(reply.message for reply in c.replies)) if m]
    types = [field.type for message in messages for field in message.layout.fields]
    items = {Item("address", message.address) for message in messages}
    items |= {Item("parameter", name) for m in messages for name in (*m.parameters, *m.layout.parameters)}
    items |= {Item("parameter", name) for type_ in types for name in type_.numbers}
    return [
        change
        for change in differences
        if change.rule.category is not Category.DOC and (names & {*change.used_by} or change.item in items)
    ]


class Changed(NamedTuple):
    """Changes of one command since the previous edition, in Markdown; and the number of further ones."""

    previous: Edition
    lines: tuple[str, ...]
    further: int


MAX_CHANGES = 8
"""Most changes that are shown on the page of a command."""


def changed(old: Edition, changes: Sequence[Change], book: Book) -> Changed:
    """The `changes` of a command since `old`, those with the worst impact first."""
    lines = []
    for change in sorted(changes, key=lambda c: list(Impact).index(c.impact)):
        line = _change_line(change, book)
        verdict = book.labels[f"verdict_{change.impact.value}"]
        lines.append(f"**{verdict}** {line.what}{book.labels['colon']}{line.change}")
    distinct = tuple(dict.fromkeys(lines))
    return Changed(old, distinct[:MAX_CHANGES], len(distinct[MAX_CHANGES:]))


def _frames(change: Change, book: Book) -> str:
    """The witnesses of a change, one for each side, or why it has none."""
    wording, reason = book.wording, reason_without_witness(change)
    if reason:
        return wording["reasons"][reason]
    return "<br>".join(
        (f"[{witness.condition}] " if witness.assignment else "")
        + witness.says(book.language, wording["witnesses"].get(witness.sentence), wording["words"], markdown)
        for witness in examples(change)
    )


def support(book: Book, changed: Mapping[Edition, Set[str]]) -> Iterator[Support]:
    """A table for each family that has several editions.

    `changed` are the names in the spec of the commands that differ from the previous edition.
    """
    for family in dict.fromkeys(edition.family for _, edition in book.listed):
        own = tuple((folder, edition) for folder, edition in book.listed if edition.family == family)
        if len(own) > 1:
            yield Support(family, own, _commands(own, book, changed), _entries(own, book.language))


def _commands(
    editions: Sequence[tuple[str, Edition]], book: Book, changed: Mapping[Edition, Set[str]]
) -> tuple[SupportLine, ...]:
    rows: dict[tuple[bool, int, str], list[str]] = {}
    titles: dict[str, str] = {}
    for at, (folder, edition) in enumerate(editions):
        for command in edition.commands:
            key = (command.code is None, command.code or 0, command.spec_name)
            cells = rows.setdefault(key, ["—"] * len(editions))
            if cells[at] == "—":
                cells[at] = _cell(folder, command, book.labels)
                if command.spec_name in changed.get(edition, ()):
                    cells[at] += f" {book.labels['changed_mark']}"
                titles.setdefault(command.spec_name, command.spec_title[book.language])
    return tuple((f"{code(name)}<br>{markdown(titles[name])}", cells) for (_, _, name), cells in sorted(rows.items()))


def _cell(folder: str, command: Command, labels: Labels) -> str:
    text = f"[{code_of(command)}]({folder}/{COMMANDS}{command.spec_name}.md)"
    only = formatting.condition(command.only)
    text += f" {code(only)}" if only else ""
    return text if command.implemented else f"{text} {labels['unimplemented']}"


def _entries(editions: Sequence[tuple[str, Edition]], language: str) -> tuple[SupportLine, ...]:
    rows: dict[tuple[str, tuple[int, ...], str], list[str]] = {}
    titles: dict[tuple[str, str], str] = {}
    for at, (folder, edition) in enumerate(editions):
        for command in edition.commands:
            message = command.request or command.reply
            if command.entry is None or message is None:
                continue
            index = tuple(key.value for key in message.keys if key.role is KeyRole.INDEX)
            cells = rows.setdefault((command.entry.table, index, command.entry.name), ["—"] * len(editions))
            if cells[at] == "—":
                cells[at] = f"[{index_of(message)}]({folder}/{COMMANDS}{command_page(command)})"
                titles[command.entry.table, command.entry.name] = command.entry.title[language]
    return tuple(
        (f"{code(f'{table}.{name}')}<br>{markdown(titles[table, name])}", cells)
        for (table, _, name), cells in sorted(rows.items())
    )
