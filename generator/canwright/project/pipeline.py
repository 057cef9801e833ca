"""Generation of the files of every target."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.types import Assignment
from ..output.writer import Content
from ..targets import registry
from ..targets.base import Specification


def generate(specifications: Sequence[Specification], targets: Sequence[str], set_parameters: Assignment) -> Content:
    """The files that `targets` generate from the editions, in memory. Raises TargetError."""
    files = {
        f"{target}/{output.path}": output.text.encode("utf-8")
        for target in targets
        for output in registry.target(target).generate(specifications, set_parameters)
    }
    return Content(tuple(f"{d.edition.family} {d.edition.name}" for d in specifications), tuple(targets), files)
