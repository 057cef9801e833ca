"""From specs to the files of every target."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..model.types import Assignment
from ..output.writer import Content, Held
from ..targets import registry
from ..targets.base import Described


def generate(
    described: Sequence[Described], targets: Sequence[str], set_parameters: Assignment, held: Held | None = None
) -> Content:
    """Everything that `targets` make of the editions, in memory; writes nothing.

    Of files that `held` has just so, only the digests are kept.
    """
    made = [_made(target, described, set_parameters, held) for target in targets]
    editions = tuple(f"{d.edition.family} {d.edition.name}" for d in described)
    files = {path: data for one in made for path, data in one.files.items()}
    standing = {path: hashed for one in made for path, hashed in one.standing.items()}
    return Content(editions, tuple(targets), files, standing=standing)


class _Made(NamedTuple):
    """What a target makes: the files that are to be written, and the digests of those that stand there."""

    files: dict[str, bytes]
    standing: dict[str, str]


def _made(target: str, described: Sequence[Described], set_parameters: Assignment, held: Held | None) -> _Made:
    made = _Made({}, {})
    for output in registry.target(target).generate(described, set_parameters):
        path, data = f"{target}/{output.path}", output.text.encode("utf-8")
        hashed = held.standing(path, data) if held else None
        if hashed is None:
            made.files[path] = data
        else:
            made.standing[path] = hashed
    return made
