"""The target `columns`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import NameProblem, Output, Specification, Target
from . import generate
from .problems import problems
from .view import columns_of, tables_of


class ColumnsTarget(Target):
    """The target that generates columnar decoders."""

    title = "Columns"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        """Tables and columns."""
        tables = tables_of(edition)
        names = {layout.path: f'"{name}"' for layout, name in tables.items() if layout.shared}
        for layout in tables:
            names |= {field.path: f'"{columns.value}"' for field, columns in columns_of(layout).items()}
        return names


TARGET = ColumnsTarget()
