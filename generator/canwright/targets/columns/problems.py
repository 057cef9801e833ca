"""Editions whose module would replace one that every package contains."""

from __future__ import annotations

from collections.abc import Iterator

from ...model.edition import Edition
from ..base import NameProblem
from .files import SHARED


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The name of the edition, if it is taken."""
    if f"{edition.identifier}.py" in SHARED:
        text = f"the columns package already contains a module `{edition.identifier}`"
        yield NameProblem(("edition",), text, f"choose another name, for example v-{edition.name}")
