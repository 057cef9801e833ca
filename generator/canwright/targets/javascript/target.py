"""The target `javascript`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import EditionInput, NameProblem, Output, Target
from ..options import Options
from . import generate
from .problems import problems


class JavaScriptTarget(Target):
    """The target that generates npm packages."""

    title = "JavaScript"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """Commands, fields, parameters and members; in JavaScript all of them are texts and properties."""
        yield from ((command.path, f'"{command.name}"') for command in edition.commands)
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            yield at, parameter.name
            yield from (((*at, "values", value.name), f'"{value.name}"') for value in parameter.values)
        for message in edition.all_messages():
            for field in (field for field in message.layout.fields if field.role.is_value):
                yield field.path, field.name
                key = "enum" if field.type.enum else "flags"
                members = (*field.type.enum, *field.type.flags)
                yield from (((*field.type.path, key, member.name), f'"{member.name}"') for member in members)


TARGET = JavaScriptTarget()
