"""The number of combinations of choices and of generated lines is limited; `resolve` limits the commands."""

from __future__ import annotations

import math

from ..model.edition import Edition
from ..model.message import Message
from .rule import Finding, Findings, Subject

MOST_COMBINATIONS = 64
"""The maximum number of combinations of choices among names; each has its own files."""
MOST_LINES = 2_500_000
"""The maximum number of messages and fields, once for each node and each combination of choices."""


def check(subject: Subject) -> Findings:
    edition = subject.edition
    choices = [p for p in edition.parameters if p.is_choice and not p.is_numeric]
    combinations = math.prod(len(p.values) for p in choices)
    if combinations > MOST_COMBINATIONS:
        text = f"{combinations} combinations of choices exceed the maximum of {MOST_COMBINATIONS}"
        hint = "merge choices that depend on each other, or split the protocol"
        yield Finding(("parameters",), text, hint, key=True)
    lines = combinations * sum(map(_lines, edition.all_messages()))
    if lines > MOST_LINES:
        text = f"fields * nodes * choices are {lines}, which exceeds the maximum of {MOST_LINES}"
        yield Finding(_longest(edition).path, text, "limit `nodes` of the addresses to those of one bus", key=True)


def _lines(message: Message) -> int:
    elements = sum(len(field.elements) for field in message.layout.fields)
    return (1 + elements) * len(message.id.nodes or (0,))


def _longest(edition: Edition) -> Message:
    return max(edition.all_messages(), key=_lines)
