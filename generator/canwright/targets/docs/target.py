"""The target `docs`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.types import Assignment
from ..base import Output, Specification, Target
from . import generate


class DocsTarget(Target):
    """Generates Markdown documents."""

    title = "Markdown"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)


TARGET = DocsTarget()
