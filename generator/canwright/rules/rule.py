"""What a rule is, and what it looks at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import IntEnum
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath, Severity
from ..language.edition import EditionSpec
from ..language.golden_frames import GoldenFrames
from ..model.edition import Edition
from ..resolve.doubts import Depth


class Subject(NamedTuple):
    """A spec that could be read: as it is written, as it resolves, and its golden frames where it has any.

    Where it is `partial`, something of it could not be read, or looked up.
    """

    edition: Edition
    spec: EditionSpec
    frames: GoldenFrames | None
    partial: bool = False


class Finding(NamedTuple):
    """Where, what is wrong, and what to do about it.

    The place is in the golden frames with `in_frames`; `unless_wrong` is what is told once nothing is wrong. `about` is
    what is in doubt by it, where that is more than what stands at its place.
    """

    path: DocumentPath
    message: str
    hint: str = ""
    key: bool = False
    in_frames: bool = False
    unless_wrong: bool = False
    about: DocumentPath | None = None


Findings = Iterator[Finding]


class Phase(IntEnum):
    """When a rule looks: what one finds amiss is left out of what later ones look at."""

    PARTS = 0
    """At one thing of the spec, or at where things stand."""
    WHOLE = 1
    """At commands and addresses side by side."""
    FRAMES = 2
    """At golden frames."""


class Rule(NamedTuple):
    """An id for people to look up, what the rule wants, and how much it matters.

    `check` is None for what is found while a spec is read. A rule that needs the `whole` spec is given only the commands
    that are certain, up to the `depth` that it looks at them.
    """

    id: str
    purpose: str
    check: Callable[[Subject], Findings] | None = None
    severity: Severity = Severity.ERROR
    whole: bool = False
    depth: Depth = Depth.VALUES
    of_frames: bool = False

    @property
    def phase(self) -> Phase:
        if self.of_frames:
            return Phase.FRAMES
        return Phase.WHOLE if self.whole and self.depth > Depth.FRAMES else Phase.PARTS
