"""The meanings of a single frame as text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model.edition import Edition
from ..model.formatting import sent
from ..model.message import Direction
from ..model.types import Assignment
from ..recordings.explain import FieldMeaning, Meaning, meanings
from ..recordings.golden_text import golden_text
from ..recordings.neighbours import neighbours
from ..semantics.frame import CanFrame
from .decode_view import value_text

_COLUMNS = ("field", "position", "raw", "value")


def explanation(editions: Sequence[Edition], frame: CanFrame, assignment: Assignment) -> tuple[str, bool]:
    """All meanings of a frame, those of several editions once, and whether one of them has nothing unusual."""
    is_usual = False
    named: dict[str, list[Edition]] = {}
    refused: dict[str, list[Edition]] = {}
    for edition in editions:
        for meaning in meanings(edition, frame, assignment):
            if meaning.rejection is not None:
                refused.setdefault(f"no {meaning.direction.value}: {meaning.rejection.text}", []).append(edition)
            else:
                named.setdefault(meaning_text(meaning), []).append(edition)
                is_usual = is_usual or not meaning.unusual
    lines = [f"{sent(frame)}\n"]
    for text, having in named.items():
        head, _, table = text.partition("\n")
        lines.append(f"\n{head}\n  in {edition_names(having)}\n{table}")
    if refused:
        lines.append("\n")
    lines += [f"{text}\n  in {edition_names(having)}\n" for text, having in refused.items()]
    stated = list(neighbours(editions, [(frame.id, frame.extended, frame.remote)]))
    lines += ["\n", *(f"{line}\n" for line in stated)] if stated else []
    return "".join(lines), is_usual


def golden_entries(editions: Sequence[Edition], frame: CanFrame, assignment: Assignment) -> str:
    """All meanings of a frame as golden frames; empty if it has none under these parameters."""
    having_text: dict[str, list[Edition]] = {}
    for edition in editions:
        for meaning in meanings(edition, frame, assignment):
            text = meaning.message and golden_text(edition, meaning.message, frame, assignment)
            if text:
                having_text.setdefault(text, []).append(edition)
    return "".join(f"  # {edition_names(having)}\n{text}" for text, having in having_text.items())


def edition_names(editions: Sequence[Edition]) -> str:
    """`lamp v1, v2; pump v1`."""
    families: dict[str, list[str]] = {}
    for edition in editions:
        families.setdefault(edition.family, []).append(edition.name)
    return "; ".join(f"{family} {', '.join(dict.fromkeys(names))}" for family, names in families.items())


def meaning_text(meaning: Meaning) -> str:
    """A message, what is unusual about it, and below them the table of its fields."""
    assert meaning.message is not None
    way = "to" if meaning.direction is Direction.REQUEST else "from"
    node = "" if meaning.node is None else f" {way} node {meaning.node}"
    head = f"{meaning.direction.value} of {meaning.message.command}{node}"
    if meaning.unusual:
        head += f"; unusual: {'; '.join(meaning.unusual)}"
    return f"{head}\n{''.join(_table(meaning.fields))}"


def _table(fields: Sequence[FieldMeaning]) -> Iterator[str]:
    rows = [_COLUMNS, *map(_cells, fields)] if fields else []
    widths = [max(len(row[i]) for row in rows) for i in range(3)] if rows else []
    for row in rows:
        padded = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        yield "    " + "  ".join((*padded, row[3])).rstrip() + "\n"


def _cells(field: FieldMeaning) -> tuple[str, str, str, str]:
    values = (
        value_text(value, field.raw, field.type) + (f" ({parameters})" if parameters else "")
        for parameters, value in field.values
    )
    only = f" (only {field.only})" if field.only else ""
    return field.name, field.place, str(field.raw), ", ".join(values) + only
