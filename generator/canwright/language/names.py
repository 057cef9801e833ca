"""Names in a file: where they are defined, and where they are referred to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath


class Definition(NamedTuple):
    """The definition of a name; `owner` is the definition of which it is a part, such as the parameter of a value."""

    path: DocumentPath
    kind: str
    name: str
    owner: str


class Reference(NamedTuple):
    """A reference to a definition; with `key`, a key of a mapping refers to it."""

    path: DocumentPath
    kind: str
    name: str
    owner: str
    key: bool
    words: tuple[str, ...]
    """Words that are valid instead of a name."""


@dataclass
class Names:
    """The definitions and references of a file, in their order."""

    definitions: list[Definition] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)
