"""The first page of an edition: commands in the order of the spec, and the entries of tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...model import formatting
from ...model.edition import Edition
from ...model.message import Command, Table
from ...model.metadata import Effect
from ...templating.markup import code, markdown
from . import tables
from .editions import Book
from .links import COMMANDS, command_page

Entries = tuple[Table, Sequence[str], Sequence[Sequence[str]]]
"""A table with the heads and the rows of its entries, in Markdown; empty columns are omitted."""


def overview(edition: Edition, book: Book) -> Mapping[str, Any]:
    """Variables of the template."""
    groups = edition.groups
    return {
        "lines": [_line(edition, forms, book) for forms in groups.values()],
        "entries": [entries for t in edition.tables if (entries := _entries(t, groups, book))[2]],
    }


def _line(edition: Edition, forms: Sequence[Command], book: Book) -> Sequence[str]:
    """The row of a command, in Markdown: code, name, reply, nodes that have it, effects; all its forms have one page."""
    first = forms[0]
    replies = {tables.reply_form(edition, form, book.labels, COMMANDS) for form in forms}
    return (
        "<br>".join(dict.fromkeys(code(tables.code_of(form)) for form in forms if form.code is not None)),
        f"[{markdown(first.spec_name)}]({COMMANDS}{first.spec_name}.md)<br>{markdown(first.spec_title[book.language])}",
        replies.pop() if len(replies) == 1 else book.labels["of_entry"],
        code(formatting.condition(first.only)) if all(form.only == first.only for form in forms) else "",
        _effects(_common(forms)),
    )


def _common(forms: Sequence[Command]) -> list[Effect]:
    """Effects that all forms of a command have."""
    return [effect for effect in forms[0].effects if all(effect in form.effects for form in forms)]


def _effects(effects: Sequence[Effect]) -> str:
    return ", ".join(code(effect.name) for effect in effects)


def _entries(table: Table, groups: Mapping[str, Sequence[Command]], book: Book) -> Entries:
    labels = book.labels
    using = {n: forms for n, forms in groups.items() if forms[0].entry and forms[0].entry.table == table.name}
    entries: dict[str, dict[str, Command]] = {}
    for n, forms in using.items():
        for form in forms:
            if form.entry:
                entries.setdefault(form.entry.name, {})[n] = form
    columns = [labels["index"], labels["entry"], labels["what"], *using, labels["only"], labels["effects"]]
    common = {n: _common(forms) for n, forms in using.items()}
    rows = []
    for name, of_entry in entries.items():
        first = next(iter(of_entry.values()))
        more = {e.name: e for n, form in of_entry.items() for e in form.effects if e not in common[n]}
        rows.append(
            (
                code(tables.index(first.request or first.reply)),
                code(name),
                markdown(first.entry.title[book.language]) if first.entry else "",
                *(_link(of_entry[n]) if n in of_entry else "" for n in using),
                code(formatting.condition(first.only)),
                _effects(list(more.values())),
            )
        )
    kept = [i for i in range(len(columns)) if i < 3 + len(using) or any(row[i] for row in rows)]
    heads = [code(c) if c in using else c for c in columns]
    return table, [heads[i] for i in kept], [[row[i] for i in kept] for row in rows]


def _link(form: Command) -> str:
    return f"[{code(tables.code_of(form))}]({COMMANDS}{command_page(form)})"
