"""The target `python`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, CodeNames, EditionInput, NameProblem, Output, Target, WorkedExchange
from ..options import Options
from . import generate, program, text
from .code_names import code_names
from .fields import varying
from .messages import base_classes
from .problems import problems


class PythonTarget(Target):
    """The target that generates Python packages."""

    title = "Python"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return problems(edition)

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """Classes, properties, members and parameters, and the names of settings and effects in class attributes."""
        for command in edition.commands:
            if message := command.request or command.reply:
                yield command.path, text.class_name(message.name)
        yield from base_classes(edition)
        for message in edition.all_messages():
            yield message.path, text.class_name(message.name)
            for field in varying(message.layout.fields):
                yield from ((field.path, text.attribute(field.name) + ending) for ending in ("", "_raw"))
        for parameter in edition.parameters:
            at: DocumentPath = ("parameters", parameter.name)
            yield at, text.attribute(parameter.name)
            if parameter.is_choice and not parameter.is_numeric:
                yield at, text.class_name(parameter.name)
                yield from (((*at, "values", value.name), text.member_name(value.name)) for value in parameter.values)
        for type_ in (named for named in edition.types if not named.is_number):
            yield type_.path, text.class_name(type_.name)
            key = "enum" if type_.enum else "flags"
            yield from (((*type_.path, key, m.name), text.member_name(m.name)) for m in (*type_.enum, *type_.flags))
        used = {setting for command in edition.commands for setting in command.limited_by}
        yield from ((("settings", s.name), f'"{s.name}"') for s in edition.settings if s in used)
        yield from ((("effects", effect.name), f'"{effect.name}"') for effect in edition.effects)

    def code_names(self, edition: Edition) -> CodeNames:
        return code_names(edition)

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample:
        return program(edition, worked)


TARGET = PythonTarget()
