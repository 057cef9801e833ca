"""The target `docs`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.types import Assignment
from ..base import Described, Output, Target
from . import generate


class DocsTarget(Target):
    """Generates Markdown documents."""

    title = "Markdown"

    def generate(self, described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
        return generate(described, set_parameters)


TARGET = DocsTarget()
