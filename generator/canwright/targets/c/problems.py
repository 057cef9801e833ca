"""Items of a spec that C cannot express; nothing is generated then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.edition import Edition
from ..base import NameProblem
from . import names, validity


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The problems of one edition."""
    yield from names.problems(edition)
    yield from validity.problems(edition)


def between(editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
    """Names that two editions would have: the later edition, and a sentence."""
    owners: dict[str, Edition] = {}
    for edition in editions if len(editions) > 1 else ():
        for name, _, _ in names.defined(edition):
            other = owners.setdefault(name, edition)
            if other is not edition:
                yield edition, f"{other.family} {other.name} would also have `{name}` in C"
                break
