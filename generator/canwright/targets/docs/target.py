"""The target `docs`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.edition import Edition
from ...model.types import Assignment
from ..base import EditionInput, Output, Target
from ..options import Options
from . import folders, generate

_PAGES = (".html", ".md")
"""Suffixes of pages, in the site and in the documents."""


class DocsTarget(Target):
    """Generates Markdown documents."""

    title = "Markdown"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        for edition, folder in folders(editions).items():
            if folder.lower().endswith(_PAGES):
                yield edition, f"the folder `{folder}` of this edition would have the name of a page of the documents"


TARGET = DocsTarget()
