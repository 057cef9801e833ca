"""The target `dbc`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import EVERYTHING, NameProblem, Options, Output, Specification, TargetWithOptions
from . import generate
from .comments import languages
from .exported import exported_names
from .files import stems
from .names import long_names


class DbcTarget(TargetWithOptions):
    """Generates DBC files."""

    title = "DBC"
    languages = tuple(languages())

    def generate(
        self, specifications: Sequence[Specification], set_parameters: Assignment, options: Options = EVERYTHING
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters, options)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return long_names(edition)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        owners: dict[str, Edition] = {}
        for edition in editions:
            for name in stems(edition):
                other = owners.setdefault(name.lower(), edition)
                if other is not edition:
                    yield edition, f"{other.family} {other.name} would also have the files `{name}-….dbc`"
                    break

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """The host, the first node of each address, signals, and names of values."""
        return exported_names(edition)


TARGET = DbcTarget()
