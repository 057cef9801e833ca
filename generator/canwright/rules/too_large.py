"""What a spec describes can be written: so many commands, files and lines, and not a multiple that nobody can use."""

from __future__ import annotations

import math

from ..language.edition import EditionSpec
from ..model.edition import Edition
from ..model.message import Message
from .rule import Finding, Found, Subject

MOST_COMMANDS = 5000
"""Commands, each entry of a table counted for each command that has the table."""
MOST_COMBINATIONS = 64
"""Combinations of choices among names; each has files of its own."""
MOST_LINES = 2_500_000
"""Messages and fields, once for each node and for each combination of choices."""


def commands(spec: EditionSpec) -> Found:
    """Whether there are too many commands; before they are resolved."""
    entries = {name: len(table.entries) for name, table in spec.tables.items()}
    count = sum(entries.get(command.table or "", 1) for command in spec.commands.values())
    if count > MOST_COMMANDS:
        text = f"there are {count} commands, with one for each entry of their tables, more than {MOST_COMMANDS}"
        yield Finding(("commands",), text, "split the protocol", key=True)


def check(subject: Subject) -> Found:
    edition = subject.edition
    choices = [p for p in edition.parameters if p.is_choice and not p.is_numeric]
    combinations = math.prod(len(p.values) for p in choices)
    if combinations > MOST_COMBINATIONS:
        text = f"the choices make {combinations} combinations, more than {MOST_COMBINATIONS}"
        hint = "each combination has files of its own; join choices that go together, or split the protocol"
        yield Finding(("parameters",), text, hint, key=True)
    lines = combinations * sum(map(_lines, edition.all_messages()))
    if lines > MOST_LINES:
        text = f"fields, times nodes, times choices are {lines}, more than {MOST_LINES}"
        yield Finding(_longest(edition).path, text, "give addresses the nodes that one bus can have", key=True)


def _lines(message: Message) -> int:
    elements = sum(len(field.elements) for field in message.layout.fields)
    return (1 + elements) * len(message.id.nodes or (0,))


def _longest(edition: Edition) -> Message:
    return max(edition.all_messages(), key=_lines)
