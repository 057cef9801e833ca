"""Name collisions: items of a spec that would have the same name in Python."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.layout import Layout
from ..base import NameProblem
from . import text
from .imports import NAMES
from .module import CONSTANTS


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The collisions of one edition."""
    yield from _clashes(_module_names(edition), "a name in every module")
    for layout in dict.fromkeys(m.layout for m in edition.all_messages()):
        yield from _clashes(_attributes(layout), "")
    for type_ in edition.types:
        key = "enum" if type_.enum else "flags"
        members = [
            (text.member_name(m.name), f"`{m.name}`", (*type_.path, key, m.name)) for m in type_.enum or type_.flags
        ]
        yield from _clashes(iter(members), "")
    for parameter in edition.parameters:
        at: DocumentPath = ("parameters", parameter.name, "values")
        values = [(text.member_name(v.name), f"`{v.name}`", (*at, v.name)) for v in parameter.values]
        if not parameter.is_numeric:
            yield from _clashes(iter(values), "")


def _clashes(names: Iterator[tuple[str, str, DocumentPath]], taken: str) -> Iterator[NameProblem]:
    """Names of two items, or of an item and a name in every module; `taken` describes that."""
    every: tuple[str, DocumentPath] = (taken, ())
    owners = dict.fromkeys((*NAMES, *CONSTANTS), every) if taken else {}
    for name, what, path in names:
        other, at = owners.setdefault(name, (what, path))
        if other != what:
            text = f"{what} and {other} would both be `{name}` in Python"
            yield NameProblem(path, text, "rename one of them", other=(at, other) if at else None)


def _module_names(edition: Edition) -> Iterator[tuple[str, str, DocumentPath]]:
    for parameter in edition.parameters:
        if parameter.is_choice and not parameter.is_numeric:
            yield text.class_name(parameter.name), f"the parameter `{parameter.name}`", ("parameters", parameter.name)
    for type_ in edition.types:
        what = f"the type `{type_.name}`"
        if type_.enum or type_.flags:
            yield text.class_name(type_.name), what, type_.path
        else:
            yield text.member_name(type_.name), what, type_.path
    for message in edition.all_messages():
        yield text.class_name(message.name), f"the {message.direction.value} of `{message.command}`", message.path
        if len(edition.of_layout(message.layout)) > 1 and message.layout.fields:
            yield text.class_name(message.layout.name), f"the layout `{message.layout.name}`", message.layout.path


def _attributes(layout: Layout) -> Iterator[tuple[str, str, DocumentPath]]:
    for field in layout.fields:
        for ending in ("", "_raw"):
            yield text.attribute(field.name) + ending, f"the field `{field.name}`", field.path
