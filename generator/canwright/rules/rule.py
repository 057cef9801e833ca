"""What a rule is, and what it looks at."""

from __future__ import annotations

from collections.abc import Iterator
from enum import IntEnum
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

from ..diagnostics.diagnostic import DocumentPath, Severity
from ..language.edition import EditionSpec
from ..model.edition import Edition

if TYPE_CHECKING:
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
    """An id for people to look up, when it is checked, and how much it matters.

    The module of that name is imported when it is first used: few runs need all phases.
    """

    id: str
    phase: Phase
    severity: Severity = Severity.ERROR

    @property
    def purpose(self) -> str:
        """What the rule wants: `PURPOSE` of its module, or the first lines of its docstring."""
        module = self._module
        text: str = getattr(module, "PURPOSE", "") or (module.__doc__ or "").partition("\n\n")[0]
        return text

    def check(self, subject: CheckInput) -> Findings:
        findings: Findings = self._module.check(subject)
        return findings

    @property
    def _module(self) -> ModuleType:
        return import_module(f".{self.id.replace('-', '_')}", __package__)
