"""The target `c`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, NameProblem, Output, Specification, Target, WorkedExchange
from . import generate, program
from .names import Names, layouts, member
from .problems import between, problems


class CTarget(Target):
    """The target that generates C headers."""

    title = "C"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        return between(editions)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        """Names without the prefix of family and edition; constants have `…_` instead."""
        in_c = Names(edition)
        names = {command.path: f"…_COMMAND_{command.short_name}".upper() for command in edition.commands}
        for layout in layouts(edition):
            if any(field.fixed is None for field in layout.fields):
                names.setdefault(layout.path, f"{in_c.short(layout.name)}_t")
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            names[at] = f".{parameter.name}"
            names |= {(*at, "values", v.name): f"…_{parameter.name}_{v.name}".upper() for v in parameter.values}
        for type_ in (t for t in edition.types if t.path[0] == "types"):
            key = "enum" if type_.enum else "flags"
            stem = in_c.type_stem(type_)
            names[type_.path] = f"…_{stem}_to_milli"
            members = (*type_.enum, *type_.flags)
            names |= {(*type_.path, key, m.name): f"…_{stem}_{m.name}".upper() for m in members}
        for message in edition.all_messages():
            names |= {field.path: member(field.name) for field in message.layout.fields if field.fixed is None}
        return names

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample:
        return CodeExample("c", program(edition, worked))


TARGET = CTarget()
