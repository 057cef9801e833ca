"""What of a spec cannot be said in C. Nothing is generated from it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Edition
from . import conversions, names, validity
from .names import Problem


def problems(edition: Edition) -> Iterator[Problem]:
    """Everything about one edition."""
    yield from names.problems(edition)
    yield from validity.problems(edition)
    yield from conversions.problems(edition)


def check(editions: Sequence[Edition]) -> None:
    """Raises ValueError for the first problem of an edition, or between two."""
    owners: dict[str, str] = {}
    for edition in editions:
        here = f"{edition.family} {edition.name}"
        for path, text, hint in problems(edition):
            raise ValueError(f"{here}, {'.'.join(map(str, path))}: {text}; {hint}")
        for name, _, _ in names.defined(edition):
            if owners.setdefault(name, here) != here:
                raise ValueError(f"{here} and {owners[name]} would both have `{name}` in C; rename one edition")
