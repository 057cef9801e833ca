"""Name collisions: tables, columns and modules that would have the same name."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.layout import Layout
from ..base import NameProblem
from .files import SHARED
from .view import column, varying


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The collisions of one edition."""
    if f"{edition.identifier}.py" in SHARED:
        text = f"the columns package already contains a module `{edition.identifier}`"
        yield NameProblem(("edition",), text, f"choose another name, for example v-{edition.name}")
    layouts = list(dict.fromkeys(message.layout for message in edition.all_messages()))
    yield from _clashes((layout.name, f"the layout `{layout.name}`", layout.path) for layout in layouts)
    for layout in layouts:
        yield from _clashes(_columns(layout))


def _columns(layout: Layout) -> Iterator[tuple[str, str, DocumentPath]]:
    for field in varying(layout):
        for ending in ("", "_raw"):
            yield column(field) + ending, f"the field `{field.name}`", field.path


def _clashes(names: Iterator[tuple[str, str, DocumentPath]]) -> Iterator[NameProblem]:
    """Names of two items."""
    owners: dict[str, tuple[str, DocumentPath]] = {}
    for name, what, path in names:
        other, at = owners.setdefault(name, (what, path))
        if at != path:
            text = f"{what} and {other} would both be `{name}` in the columns package"
            yield NameProblem(path, text, "rename one of them", other=(at, other))
