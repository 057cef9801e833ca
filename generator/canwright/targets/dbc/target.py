"""The target `dbc`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import Described, NameProblem, Output, Target
from . import generate
from .names import long_names


class DbcTarget(Target):
    """Generates DBC files."""

    title = "DBC"

    def generate(self, described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
        return generate(described, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return long_names(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        """Signal names with `…_` in place of the prefix of direction and code."""
        names: dict[DocumentPath, str] = {("bus", "host"): edition.bus.host}
        for message in edition.all_messages():
            names |= {field.path: f"…_{field.name}" for field in message.layout.fields}
        return names


TARGET = DbcTarget()
