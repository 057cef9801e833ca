"""The number of combinations of choices and the size of what is generated are limited.

The size is an estimate in units of at most 70 microseconds. It is computed from the edition before anything is generated,
in time proportional to the spec. `resolve` limits the commands and fields before that.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Iterator
from enum import Enum
from functools import cache
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from ..model.layout import Field, Layout
from ..model.message import LISTED_NODES, Command, Message
from ..model.metadata import Effect, Setting
from ..model.types import Text, Type
from ..resolve.report import MAX_COMMANDS, MAX_FIELDS
from .rule import CheckInput, Finding, Findings

MAX_COMBINATIONS = 64
"""The maximum number of combinations of choices among names; each has its own files."""
MAX_SIZE = 140_000
"""The maximum size: at most about 10 seconds of processor time, and 300 MB."""
VARIABLE = "CANWRIGHT_MAX_SIZE"
"""The environment variable with another maximum, for specs of the user's own; a spec cannot set it."""

COMMAND, MESSAGE, FIELD, TYPE, VALUE, CASE, FRAME, CODE, ITEM = 12, 35, 10, 16, 3, 8, 5, 7, 2
"""The size of a command, a message, a defined field, a type, a named value, a scale or range for a choice, a golden
frame, an accepted code, and any other item."""
REPEATED = 0.7
"""The size of an element of a field in one message."""
LISTED_ID = 0.22
"""The size of a message for one node and one combination of choices."""
LISTED = 0.08
"""The size of an element of a field in one message, for one node and one combination of choices."""
NODE = 0.05
"""The size of a node that replies."""
PLACE = 0.4
"""The size of an erratum in one of the commands that it is about."""
CHARACTER = 0.01
"""The size of a character of a text in one place."""
VALUE_OF_LINE = 2 / 5
"""The size of a named value of an element, in relation to that of the element."""

PURPOSE = (
    f"A spec has at most {MAX_COMMANDS} commands, {MAX_FIELDS} fields, {MAX_COMBINATIONS} combinations of "
    f"choices and a size of {MAX_SIZE}, which is the sum of the sizes of its parts."
)


class Part(Enum):
    """The causes of the size: what they are, and how to reduce them."""

    MESSAGES = "commands, messages and fields", "split the protocol into several specs"
    IDS = "fields * nodes * choices", "limit `nodes` of the addresses to those of one bus, or merge choices"
    TYPES = "types and their named values", "list fewer values, or write a plain number"
    TEXTS = "texts", "shorten texts that occur in many commands, such as those of layouts, types and effects"
    FACTS = "errata, settings, effects and other facts", "list fewer of them"
    FRAMES = "golden frames", "keep frames that differ in more than their values"


class Size(NamedTuple):
    """The size of one item."""

    part: Part
    path: DocumentPath
    size: float


def check(subject: CheckInput) -> Findings:
    edition = subject.edition
    combinations = _combinations(edition)
    if combinations > MAX_COMBINATIONS:
        text = f"{combinations} combinations of choices exceed the maximum of {MAX_COMBINATIONS}"
        hint = "merge choices that depend on each other, or split the protocol"
        yield Finding(("parameters",), text, hint, key=True)
        return
    totals, largest = dict.fromkeys(Part, 0.0), dict.fromkeys(Part, Size(Part.FRAMES, (), 0))
    for item in (*_sizes(edition, combinations), *_sizes_of_frames(subject)):
        totals[item.part] += item.size
        largest[item.part] = max(largest[item.part], item, key=lambda size: size.size)
    total, most = sum(totals.values()), _maximum()
    if total > most:
        part = max(totals, key=lambda part: totals[part])
        what, hint = part.value
        text = f"the size of this spec is {total:.0f}, which exceeds the maximum of {most}"
        text += f"; {totals[part]:.0f} are due to {what}, most of them here"
        hint += f"; if you trust the spec, set the environment variable {VARIABLE}={math.ceil(total)}"
        yield Finding(largest[part].path, text, hint, key=True)


def _maximum() -> int:
    """The maximum size: that of the environment, if it is a number."""
    given = os.environ.get(VARIABLE, "")
    return int(given) if re.fullmatch(r"[0-9]{1,9}", given) else MAX_SIZE


def _combinations(edition: Edition) -> int:
    return math.prod(len(p.values) for p in edition.parameters if p.is_choice and not p.is_numeric)


def _sizes(edition: Edition, combinations: int) -> Iterator[Size]:
    elements, listed, texts = cache(_elements), cache(_listed), cache(_texts_of_layout)
    for message in edition.all_messages():
        yield Size(Part.MESSAGES, message.path, MESSAGE + CODE * len(message.accepted_codes) + elements(message.layout))
        yield Size(Part.IDS, message.path, _ids(message, combinations) * listed(message.layout))
        yield Size(Part.TEXTS, message.path, texts(message.layout))
    for layout in {**dict.fromkeys(edition.layouts), **{m.layout: None for m in edition.all_messages()}}:
        yield Size(Part.MESSAGES, layout.path, ITEM + FIELD * len(layout.fields))
    for command in edition.commands:
        yield Size(Part.MESSAGES, command.path, COMMAND + NODE * len(command.from_each))
        yield Size(Part.TEXTS, command.path, _texts_of_command(command))
        facts = (command.effects, command.limited_by, command.not_limited_by, command.notes)
        yield Size(Part.FACTS, command.path, ITEM * (sum(map(len, facts)) + _exemptions(command)))
    yield from (Size(Part.TYPES, type_.path, _type(type_)) for type_ in edition.types)
    for erratum_number, erratum in enumerate(edition.errata):
        places = PLACE * len(edition.commands) * erratum.where.count("commands")
        yield Size(Part.FACTS, ("errata", erratum_number), ITEM * (2 + len(erratum.where)) + places)
    for key, items in (
        ("settings", edition.settings),
        ("effects", edition.effects),
        ("states", edition.states),
        ("parameters", edition.parameters),
    ):
        yield from (Size(Part.FACTS, (key, item.name), ITEM) for item in items)
    yield from (Size(Part.FACTS, ("parameters", p.name), ITEM * len(p.values)) for p in edition.parameters)
    yield from (Size(Part.FACTS, ("bus", "neighbours", n.name), ITEM) for n in edition.bus.neighbours)
    yield from (
        Size(Part.FACTS, ("bus", "modes", m.name), ITEM * (1 + len(m.bit_rates_kbps))) for m in edition.bus.modes
    )


def _sizes_of_frames(subject: CheckInput) -> Iterator[Size]:
    frames = subject.frames
    number = len(frames.frames) + len(frames.refused) + len(frames.exchanges) if frames else 0
    yield Size(Part.FRAMES, ("commands",), FRAME * number)


def _elements(layout: Layout) -> float:
    return REPEATED * sum(len(field.elements) for field in layout.fields)


def _listed(layout: Layout) -> float:
    return LISTED_ID + LISTED * sum(
        len(field.elements) * (1 + VALUE_OF_LINE * _values(field.type)) for field in layout.fields
    )


def _ids(message: Message, combinations: int) -> int:
    """How often an output lists a message."""
    nodes = min(len(message.id.nodes), LISTED_NODES) + 1 if message.id.nodes else 1
    return nodes * combinations * max(1, len(message.identifying_codes))


def _type(type_: Type) -> float:
    cases = len(type_.linear.cases) + len(type_.raw_range.cases)
    return TYPE + VALUE * _values(type_) + CASE * cases


def _values(type_: Type) -> int:
    return len(type_.enum) + len(type_.flags) + len(type_.no_values) + len(type_.names)


def _exemptions(command: Command) -> int:
    return sum(len(field.type.exemptions) for field in command.request.layout.fields) if command.request else 0


def _texts_of_layout(layout: Layout) -> float:
    return _characters((layout.title, layout.about, *(t for f in layout.fields for t in _texts_of_field(f))))


def _texts_of_field(field: Field) -> tuple[Text, ...]:
    return field.title, field.about, field.type.title, field.type.about


def _texts_of_command(command: Command) -> float:
    facts: tuple[Effect | Setting, ...] = (*command.effects, *command.limited_by, *command.not_limited_by)
    texts = [command.title, command.about, *command.notes]
    texts += [text for fact in facts for text in (fact.title, fact.about)]
    texts += [command.entry.title, command.entry.about] if command.entry else []
    return _characters(texts)


def _characters(texts: Iterable[Text]) -> float:
    return CHARACTER * sum(len(written) for text in texts for written in text.values())
