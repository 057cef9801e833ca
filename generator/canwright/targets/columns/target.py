"""The target `columns`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import EditionInput, NameProblem, Output, Target
from ..options import Options
from . import generate
from .problems import problems
from .view import columns_of, tables_of


class ColumnsTarget(Target):
    """The target that generates columnar decoders."""

    title = "Columns"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """Tables and columns."""
        for layout, table in tables_of(edition).items():
            yield layout.path, f'"{table}"'
            yield from ((field.path, f'"{name}"') for field, names in columns_of(layout).items() for name in names)


TARGET = ColumnsTarget()
