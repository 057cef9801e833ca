"""From specs to the files of every target."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from .model import Assignment
from .output import Content
from .processes import side_by_side
from .targets import Described, Target, c, dbc, docs, python

TARGETS: dict[str, Target] = {"c": c.generate, "python": python.generate, "dbc": dbc.generate, "docs": docs.generate}

LONGEST = ("dbc", "docs", "c", "python")
"""Those that take longest come first: the first is made by this process, and need not be sent to it."""


def generate(described: Sequence[Described], targets: Sequence[str], set_parameters: Assignment) -> Content:
    """Everything that `targets` make of the editions, in memory; writes nothing."""
    order = sorted(targets, key=LONGEST.index)
    made = side_by_side([partial(_files, target, described, set_parameters) for target in order])
    files = {path: data for outputs in made for path, data in outputs.items()}
    editions = tuple(f"{d.edition.family} {d.edition.name}" for d in described)
    return Content(editions, tuple(targets), files)


def _files(target: str, described: Sequence[Described], set_parameters: Assignment) -> dict[str, bytes]:
    made = TARGETS[target](described, set_parameters)
    return {f"{target}/{output.path}": output.text.encode("utf-8") for output in made}
