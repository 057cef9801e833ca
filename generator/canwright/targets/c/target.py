"""The target `c`: the names that users of the headers write, and items of a spec that C cannot express."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ..base import CodeExample, CodeNames, EditionInput, ItemNames, NameProblem, Output, Target, WorkedExchange
from ..options import NO_OPTIONS, Options
from . import names, validity
from .names import SHARED, layouts, member
from .package import declared, files, program
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
        prefixes = edition_view(edition).prefix, edition_view(edition).PREFIX
        for path, name in _exported(edition):
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


def _exported(edition: Edition) -> Iterator[Exported]:
    """The members of structs, and the names in the header that are no part of other functions."""
    printed = declared(edition)
    yield from ((("parameters", parameter.name), f".{member(parameter.name)}") for parameter in edition.parameters)
    yield from ((f.path, member(f.name)) for layout in layouts(edition) for f in layout.fields if f.is_given)
    for name, _, path in names.defined(edition):
        if path and name in printed and not name.endswith(names.PARTS_OF_FUNCTIONS):
            yield path, name
    for message in edition.all_messages():
        if edition_view(edition).message(message).layout.has_values:
            yield message.path, f".{edition_view(edition).message(message).member}"


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
