"""The target `c`: the names that users of the headers write, and items of a spec that C cannot express."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, CodeNames, EditionInput, ItemNames, NameProblem, Output, Target, WorkedExchange
from ..options import NO_OPTIONS, Options
from . import names, validity
from .names import SHARED, Names, layouts, member, parameter_names
from .package import files, program
from .types import TypeView
from .view import edition_view

Exported = tuple[DocumentPath, str]

C_HEADERS = (
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic "
    "stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype"
)
POSIX_HEADERS = "endian fcntl poll pthread sched semaphore strings termios unistd"
HEADERS = frozenset((f"{C_HEADERS} {POSIX_HEADERS} arduino").split())
"""Headers that a header of the same name would replace; some file systems find `arduino.h` for `Arduino.h`."""


class CTarget(Target):
    """The target that generates C headers."""

    title = "C"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
    ) -> Iterator[Output]:
        """Parameters are not fixed; they are arguments of functions."""
        return files(specifications)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        yield from _headers(edition)
        yield from names.problems(edition)
        yield from validity.problems(edition)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        owners: dict[str, Edition] = {}
        for edition in editions if len(editions) > 1 else ():
            for name, _, _ in names.defined(edition):
                owner = owners.setdefault(name, edition)
                if owner is not edition:
                    yield edition, f"{owner.family} {owner.name} would also have `{name}` in C"
                    break

    def exported_names(self, edition: Edition) -> Iterator[Exported]:
        """The name of a declaration before those of its functions; `…_` stands for the prefix of family and edition."""
        names = Names(edition)
        prefixes = names.lower(""), names.upper("")
        for path, name in _names(names, edition):
            yield path, f"…_{name[len(prefixes[0]) :]}" if name.startswith(prefixes) else name

    def code_names(self, edition: Edition) -> CodeNames:
        """Raw integers stand for the members of types."""
        view, messages = edition_view(edition), edition.all_messages()
        names = view.names
        return CodeNames(
            language="c",
            source=f"{edition.family}/{edition.identifier}.h",
            parameters_type=names.lower("parameters_t"),
            frame=view.frame,
            messages={message: names.lower(message.name) for message in messages},
            needs_parameters=frozenset(m for m in messages if view.message(m).takes_parameters),
            fields={field.name: member(field.name) for m in messages for field in m.layout.fields},
            parameters={
                p: ItemNames(member(p.name), "", {v.name: names.upper(p.name, v.name) for v in p.values})
                for p in edition.parameters
            },
            types={},
        )

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample:
        return program(edition, worked)


def _names(names: Names, edition: Edition) -> Iterator[Exported]:
    for parameter in edition.parameters:
        yield ("parameters", parameter.name), f".{member(parameter.name)}"
        yield from ((path, name) for name, _, path in parameter_names(names, parameter))
    yield from ((("effects", effect.name), names.upper("effect", effect.name)) for effect in edition.effects)
    view = edition_view(edition)
    for address in view.addresses:
        yield from ((address.path, macro.name) for macro in address.nodes)
        for rule in address.rules:
            reader = rule.node_function if rule.has_nodes else rule.check_function
            functions = (rule.id_function, reader) if rule.can_fail else (rule.id_macro,)
            yield from ((address.path, function) for function in functions)
    for type_ in (t for t in view.of_type if t.path[0] == "types"):
        stem = names.type_stem(type_)
        by_key = type_.members_by_key.items()
        members = {names.upper(stem, m.name): (*type_.path, key, m.name) for key, named in by_key for m in named}
        yield from ((members.get(name, type_.path), name) for name in _type(view.of_type[type_]))
    for layout in layouts(edition):
        varying = [field for field in layout.fields if field.is_given]
        if varying:
            yield layout.path, names.lower(layout.name, "t")
        for field in varying:
            yield field.path, member(field.name)
            yield field.path, names.upper("field", field.name)
    for command in edition.commands:
        yield command.path, names.command(command.name)
        if command.code is not None:
            yield command.path, names.upper(command.name, "code")
    for message in edition.all_messages():
        yield from ((message.path, fact.name) for fact in names.facts(message))
        if any(field.is_given for field in message.layout.fields):
            yield message.path, names.lower(message.name, "t")
            yield message.path, f".{member(names.short(message.command))}"
        yield from ((message.path, names.lower(message.name, ending)) for ending in ("encode", "decode"))


def _type(view: TypeView) -> Iterator[str]:
    """The functions of a type and its macros."""
    yield from (f"{view.name}_{way}_{unit}" for unit in view.conversions for way in ("to", "from"))
    functions = (("name", view.names), ("first_flag", view.is_flags), ("valid", view.valid))
    yield from (f"{view.name}_{ending}" for ending, exists in functions if exists)
    yield from (macro.name for macro in view.macros)


def _headers(edition: Edition) -> Iterator[NameProblem]:
    """Headers in place of those of the C library, of Arduino, or of those that every family has; a reserved namespace."""
    family, file = edition.family, edition.identifier
    if family in HEADERS:
        text = f"the header `{family}.h` for Arduino would replace a header of the C library or of Arduino"
        yield NameProblem(("family",), text, f"choose another name, for example {family}_protocol")
    if family == "std":
        text = "names in the C++ namespace `std` are reserved for the standard library"
        yield NameProblem(("family",), text, f"choose another name, for example {family}_protocol")
    if f"{file.lower()}.h" in SHARED:
        text = f"the C library already contains a header `{file.lower()}.h`"
        yield NameProblem(("edition",), text, f"choose another name, for example v-{edition.name}")


TARGET = CTarget()
