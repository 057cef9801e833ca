"""What a rule is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..model import Edition, Path

Found = Iterator[tuple[Path, str, str]]
"""Where, what is wrong, and what to do about it."""


@dataclass(frozen=True)
class Rule:
    """An id for people to look up, what the rule wants, and the check."""

    id: str
    purpose: str
    check: Callable[[Edition], Found]
