"""What a rule is, and what it looks at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import IntEnum
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath, Severity
from ..language.edition import EditionSpec
from ..model.edition import Edition
from ..model.golden_frames import GoldenFrames


class CheckInput(NamedTuple):
    """A spec as it is written, as it resolves, and its golden frames where it has any.

    A `partial` one lacks the commands that errors affect.
    """

    edition: Edition
    spec: EditionSpec
    frames: GoldenFrames | None
    partial: bool = False


class RelatedItem(NamedTuple):
    """Another item of the spec that a finding is about: its path and what it is.

    One that `may_be_missing` is not shown if the spec leaves it to its default.
    """

    path: DocumentPath
    item: str
    key: bool = False
    may_be_missing: bool = False


class Finding(NamedTuple):
    """Where, what is wrong, and what to do about it; the place is in the golden frames with `in_frames`.

    `related` are other items of the spec that the finding is about.
    """

    path: DocumentPath
    message: str
    hint: str = ""
    key: bool = False
    in_frames: bool = False
    related: tuple[RelatedItem, ...] = ()


Findings = Iterator[Finding]


class Phase(IntEnum):
    """When a rule is checked: what an earlier phase finds invalid is left out of what a later one checks."""

    SIZE = 0
    """Limits the work of the phases after it, which do not run if it has a finding."""
    PARTS = 1
    """Checks one thing of the spec, or where things stand."""
    CODES = 2
    """Compares names and codes of commands."""
    WHOLE = 3
    """Compares commands and addresses."""
    FRAMES = 4
    """Compares golden frames with a spec without errors."""
    COVERAGE = 5
    """Looks for what is missing or unused in a spec without errors."""


class Rule(NamedTuple):
    """An id for people to look up, what the rule wants, and how much it matters.

    `check` is None for findings of loading and resolving.
    """

    id: str
    purpose: str
    check: Callable[[CheckInput], Findings] | None = None
    severity: Severity = Severity.ERROR
    phase: Phase = Phase.PARTS
