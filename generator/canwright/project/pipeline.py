"""From specs to the files of every target."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.edition import Assignment
from ..output.writer import Content
from ..targets import Described, Target, c, dbc, docs, python

TARGETS: dict[str, Target] = {"c": c.generate, "python": python.generate, "dbc": dbc.generate, "docs": docs.generate}


def generate(described: Sequence[Described], targets: Sequence[str], set_parameters: Assignment) -> Content:
    """Everything that `targets` generate from the editions, in memory; writes nothing."""
    files = {
        f"{target}/{output.path}": output.text.encode("utf-8")
        for target in targets
        for output in TARGETS[target](described, set_parameters)
    }
    return Content(tuple(f"{d.edition.family} {d.edition.name}" for d in described), tuple(targets), files)
