"""The target `handover`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.types import Assignment
from ..base import BinaryOutput, EditionInput, Output, Target
from ..options import Options
from . import generate


class HandoverTarget(Target):
    """Generates documents to hand over, which need packages that canwright does not install."""

    title = "Hand-over documents"
    is_default = False

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output | BinaryOutput]:
        return generate(specifications)


TARGET = HandoverTarget()
