"""Items of a spec that C cannot express; nothing is generated then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.edition import Edition
from ..base import NameProblem
from . import names, validity
from .files import SHARED

C_HEADERS = (
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic "
    "stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype"
)
POSIX_HEADERS = "endian fcntl poll pthread sched semaphore strings termios unistd"
HEADERS = frozenset((f"{C_HEADERS} {POSIX_HEADERS} arduino").split())
"""Headers that a header of the same name would replace; some file systems find `arduino.h` for `Arduino.h`."""


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The problems of one edition."""
    yield from _headers(edition)
    yield from names.problems(edition)
    yield from validity.problems(edition)


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


def edition_collisions(editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
    """Names that two editions would have: the later edition, and a sentence."""
    owners: dict[str, Edition] = {}
    for edition in editions if len(editions) > 1 else ():
        for name, _, _ in names.defined(edition):
            other = owners.setdefault(name, edition)
            if other is not edition:
                yield edition, f"{other.family} {other.name} would also have `{name}` in C"
                break
