"""The target `javascript`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import NameProblem, Output, Specification, Target
from . import generate
from .problems import problems


class JavaScriptTarget(Target):
    """The target that generates npm packages."""

    title = "JavaScript"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        """Commands, fields, parameters and members of enums; in JavaScript all of them are texts and properties."""
        names: dict[DocumentPath, str] = {command.path: f'"{command.name}"' for command in edition.commands}
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            names[at] = parameter.name
            names |= {(*at, "values", value.name): f'"{value.name}"' for value in parameter.values}
        for type_ in edition.types:
            key = "enum" if type_.enum else "flags"
            names |= {(*type_.path, key, m.name): f'"{m.name}"' for m in (*type_.enum, *type_.flags)}
        for message in edition.all_messages():
            names |= {field.path: field.name for field in message.layout.fields if field.fixed is None}
        return names


TARGET = JavaScriptTarget()
