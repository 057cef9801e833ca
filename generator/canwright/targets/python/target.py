"""The target `python`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, NameProblem, Output, Specification, Target, WorkedExchange
from . import generate, program, text
from .problems import problems


class PythonTarget(Target):
    """The target that generates Python packages."""

    title = "Python"

    def generate(self, specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Mapping[DocumentPath, str]:
        names: dict[DocumentPath, str] = {}
        for command in edition.commands:
            message = command.request or command.reply
            names |= {command.path: text.class_name(message.name)} if message else {}
        names |= {message.layout.path: text.class_name(message.name) for message in edition.all_messages()}
        for layout in (message.layout for message in edition.all_messages()):
            if len(edition.of_layout(layout)) > 1 and layout.fields:
                names[layout.path] = text.class_name(layout.name)
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            names[at] = text.attribute(parameter.name)
            names |= {(*at, "values", value.name): text.member_name(value.name) for value in parameter.values}
        for type_ in edition.types:
            key = "enum" if type_.enum else "flags"
            members = (*type_.enum, *type_.flags)
            names |= {(*type_.path, key, m.name): text.member_name(m.name) for m in members}
        used = {setting for command in edition.commands for setting in command.limited_by}
        names |= {("settings", s.name): f'"{s.name}"' for s in edition.settings if s in used}
        names |= {("effects", effect.name): f'"{effect.name}"' for effect in edition.effects}
        for message in edition.all_messages():
            names |= {field.path: text.attribute(field.name) for field in message.layout.fields if field.fixed is None}
        return names

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample:
        return CodeExample("python", program(edition, worked))


TARGET = PythonTarget()
