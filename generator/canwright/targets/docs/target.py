"""The target `docs`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.edition import Edition
from ...model.types import Assignment
from ..base import Output, Specification, Target
from . import folders, generate

SITE = frozenset(
    {"404.html", "assets", "assurance", "en", "index.html", "new-edition", "pictures", "search"}
    | {"sitemap.xml", "sitemap.xml.gz", "support", "zh"}
    | {"quickstart", "which-edition", "bus-load", "dbc-import", "downloads", "glossary", "own-protocol", "benchmarks"}
)
"""Files and folders beside those of the editions, in the documents or in their site."""


class DocsTarget(Target):
    """Generates Markdown documents."""

    title = "Markdown"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        for edition, folder in folders(editions).items():
            if folder.lower() in SITE:
                yield edition, f"the folder `{folder}` of this edition is already part of the documentation site"


TARGET = DocsTarget()
