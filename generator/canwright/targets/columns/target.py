"""The target `columns`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import NameProblem, Output, Specification, Target
from . import generate
from .problems import problems
from .view import column


class ColumnsTarget(Target):
    """The target that generates columnar decoders."""

    title = "Columns"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        """Tables and columns."""
        names = {layout.path: f'"{layout.name}"' for layout in edition.layouts}
        for message in edition.all_messages():
            names |= {field.path: f'"{column(field)}"' for field in message.layout.fields if field.fixed is None}
        return names


TARGET = ColumnsTarget()
