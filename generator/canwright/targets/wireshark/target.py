"""The target `wireshark`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import EditionInput, Output, Target
from ..options import Options
from . import generate
from .family import preference
from .filters import filters


class WiresharkTarget(Target):
    """Generates dissectors for Wireshark."""

    title = "Wireshark"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """The names of fields in filters, and of preferences."""
        shared = filters([edition]).names
        yield from ((("parameters", p.name), preference(p.name)) for p in edition.parameters)
        for field in (f for message in edition.all_messages() for f in message.layout.fields if f.name in shared):
            yield field.path, f"{edition.family}.{shared[field.name]}"


TARGET = WiresharkTarget()
