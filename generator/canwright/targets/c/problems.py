"""What of a spec cannot be said in C. Nothing is generated from it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.edition import Edition
from ..base import NameProblem
from . import conversions, names, validity


def problems(edition: Edition) -> Iterator[NameProblem]:
    """Everything about one edition."""
    yield from names.problems(edition)
    yield from validity.problems(edition)
    yield from conversions.problems(edition)


def between(editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
    """Names that two editions would both have: the later edition, and what is wrong."""
    owners: dict[str, Edition] = {}
    for edition in editions if len(editions) > 1 else ():
        for name, _, _ in names.defined(edition):
            other = owners.setdefault(name, edition)
            if other is not edition:
                yield edition, f"{other.family} {other.name} would also have `{name}` in C"
                break
