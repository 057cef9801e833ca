"""The target `c`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, CodeNames, EditionInput, NameProblem, Output, Target, WorkedExchange
from ..options import Options
from . import generate, program
from .code_names import code_names
from .exported import exported_names
from .problems import edition_collisions, problems


class CTarget(Target):
    """The target that generates C headers."""

    title = "C"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        return edition_collisions(editions)

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        return exported_names(edition)

    def code_names(self, edition: Edition) -> CodeNames:
        return code_names(edition)

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample:
        return program(edition, worked)


TARGET = CTarget()
