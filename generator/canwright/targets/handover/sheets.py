"""The sheets of the Excel file of an edition: commands, fields, types, errata and sources."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ...model import formatting
from ...model.edition import Edition
from ...model.types import Type
from ..base import EditionInput
from . import matrix
from .matrix import Cell
from .spreadsheets import Sheet

_COMMAND = (
    *("command", "title", "code", "id", "nodes", "answer", "reply_within_ms", "only", "effects", "limited_by"),
    *("about", "manual", "manual_name"),
)
_TYPE = (
    *("type", "title", "raw", "bits", "only", "raw_minimum", "raw_maximum", "resolution", "offset", "unit", "printed"),
    *("minimum", "maximum", "value", "name", "meaning"),
)
_ERRATUM = ("erratum", "manual", "manual_prints", "used", "why", "command", "concerns")
_SOURCE = ("source", "about", "frames")


def sheets(item: EditionInput, rows: Sequence[matrix.Row], shown: matrix.Shown) -> Sequence[Sheet]:
    """The sheets of an edition; `rows` is its command matrix."""
    edition, labels = item.edition, shown.labels
    contents: Mapping[str, tuple[Sequence[str], Sequence[Sequence[Cell]]]] = {
        "commands": (_COMMAND, list(_commands(edition, rows, shown))),
        "fields": (matrix.Row._fields, rows),
        "types": (_TYPE, [row for type_ in edition.types for row in _type(type_, shown)]),
        "errata": (_ERRATUM, list(errata(edition, shown))),
        "sources": (_SOURCE, list(sources(item, shown))),
    }
    return [
        Sheet(labels[f"sheet_{name}"], [labels[column] for column in columns], content)
        for name, (columns, content) in contents.items()
    ]


def _commands(edition: Edition, rows: Sequence[matrix.Row], shown: matrix.Shown) -> Iterator[Sequence[Cell]]:
    """One row for each command; id, nodes and the form of the reply as in the rows of its fields."""
    for command in edition.commands:
        own = [row for row in rows if row.command == command.name]
        answers = shown.list(dict.fromkeys(str(row.answer) for row in own))
        time = command.reply_within_ms or (edition.bus.reply_within_ms if command.replies else None)
        about = [command.about[shown.language], *(note[shown.language] for note in command.notes)]
        if not command.implemented:
            about.insert(0, shown.labels["not_implemented"])
        yield [
            *(command.name, command.title[shown.language], own[0].code, own[0].id, own[0].nodes, answers),
            *("" if time is None else time, shown.condition(command.only)),
            shown.list(effect.title[shown.language] for effect in command.effects),
            shown.list(setting.title[shown.language] for setting in command.limited_by),
            *("\n".join(filter(None, about)), shown.section(command.manual), command.manual_name),
        ]


def _type(type_: Type, shown: matrix.Shown) -> Iterator[Sequence[Cell]]:
    """One row for each member, or for each combination of parameter values with its own numbers."""
    start: Sequence[Cell] = [
        type_.name,
        type_.title[shown.language],
        formatting.raw_format(type_),
        Fraction(type_.width),
    ]
    for member in (*type_.enum, *type_.flags):
        texts = [member.title.get(shown.language, ""), member.about.get(shown.language, "")]
        yield [*start, *[""] * 9, Fraction(member.value), member.name, shown.list(filter(None, texts))]
    for numbers in matrix.numbers_of(shown.edition, type_) if type_.is_number else ():
        cells = shown.numbers(type_, numbers)
        about = type_.about[shown.language]
        yield [*start, shown.condition(numbers.only), *(cells.get(name, "") for name in _TYPE[5:13]), "", "", about]


def errata(edition: Edition, shown: matrix.Shown) -> Iterator[Sequence[Cell]]:
    for erratum in edition.errata:
        affected = [command.name for command in edition.commands if erratum in edition.errata_of(command)]
        texts = [text[shown.language] for text in (erratum.printed, erratum.used, erratum.why)]
        names = [", ".join(affected), ", ".join(erratum.where)]
        yield [erratum.id, shown.section(erratum.manual), *texts, *names]


def sources(item: EditionInput, shown: matrix.Shown) -> Iterator[Sequence[Cell]]:
    """The manual and the hash of the spec, then the sources of the golden frames."""
    edition, labels = item.edition, shown.labels
    yield [labels["family"], edition.family, ""]
    yield [labels["edition"], edition.name, ""]
    yield [labels["date"], edition.date, ""]
    yield [labels["manual"], edition.manual.get(shown.language, ""), ""]
    yield [labels["hash"], edition.hash, ""]
    frames = item.frames.reviewed if item.frames else None
    for name, text in frames.sources.items() if frames else ():
        entries = (*frames.frames, *frames.refused, *frames.exchanges) if frames else ()
        about = text if isinstance(text, str) else text.get(shown.language, "")
        yield [name, about, Fraction(sum(entry.source == name for entry in entries))]
