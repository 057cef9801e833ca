"""What a rule is, and what it looks at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

from ..diagnostics import Severity
from ..doubts import Depth
from ..golden import GoldenFrames
from ..model import Edition, Path
from ..schema import EditionSpec


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

    The place is in the golden frames with `in_frames`; `unless_wrong` is what is told once nothing is wrong.
    """

    path: Path
    message: str
    hint: str = ""
    key: bool = False
    in_frames: bool = False
    unless_wrong: bool = False


Found = Iterator[Finding]


class Rule(NamedTuple):
    """An id for people to look up, what the rule wants, and how much it matters.

    `check` is None for what is found while a spec is read. A rule that needs the `whole` spec is given only the commands
    that are certain, up to the `depth` that it looks at them.
    """

    id: str
    purpose: str
    check: Callable[[Subject], Found] | None = None
    severity: Severity = Severity.ERROR
    whole: bool = False
    depth: Depth = Depth.VALUES
