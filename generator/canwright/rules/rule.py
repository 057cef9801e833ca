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
    """A spec as it is written, as it resolves, and its golden frames if it has any."""

    edition: Edition
    spec: EditionSpec
    frames: GoldenFrames | None


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
    """The order of rules: those of a phase run if the phases before it have no error."""

    SIZE = 0
    """Limits the work of the phases after it."""
    PARTS = 1
    """Checks single items of the spec, names and codes."""
    WHOLE = 2
    """Compares the frames of commands and addresses."""
    NAMES = 3
    """Compares names with those that targets can use. This and the following phases are for output."""
    FRAMES = 4
    """Compares golden frames with the spec."""
    COVERAGE = 5
    """Looks for what is missing or unused."""


class Rule(NamedTuple):
    """An id for people to look up, what the rule wants, and how much it matters.

    `check` is None for findings of loading and resolving.
    """

    id: str
    purpose: str
    check: Callable[[CheckInput], Findings] | None = None
    severity: Severity = Severity.ERROR
    phase: Phase = Phase.PARTS
