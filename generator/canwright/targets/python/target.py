"""The target `python`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import NameProblem, Output, Specification, Target
from . import generate, text
from .problems import problems


class PythonTarget(Target):
    """The target that generates Python packages."""

    title = "Python"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        names = {command.path: text.class_name(f"{command.name}_request") for command in edition.commands}
        for layout in (*edition.layouts, *(message.layout for message in edition.all_messages())):
            names.setdefault(layout.path, text.class_name(layout.name))
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            names[at] = text.attribute(parameter.name)
            names |= {(*at, "values", value.name): text.member_name(value.name) for value in parameter.values}
        for type_ in edition.types:
            key = "enum" if type_.enum else "flags"
            members = (*type_.enum, *type_.flags)
            names |= {(*type_.path, key, m.name): text.member_name(m.name) for m in members}
        names |= {("settings", setting.name): f'"{setting.name}"' for setting in edition.settings}
        names |= {("effects", effect.name): f'"{effect.name}"' for effect in edition.effects}
        for message in edition.all_messages():
            names |= {field.path: text.attribute(field.name) for field in message.layout.fields}
        return names


TARGET = PythonTarget()
