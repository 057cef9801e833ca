"""Readers of DBC files, by other projects, with one interface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

Values = Mapping[str, float]


class Case(NamedTuple):
    """A golden frame, the values of its signals, and the names of all signals that a reader may return for it."""

    can_id: int
    extended: bool
    data: bytes
    values: Values
    names: frozenset[str]


class UnsupportedFileError(Exception):
    """A reader rejects a valid file because of a known defect of the reader."""


class Reader(ABC):
    """A reader of DBC files; `source` says where to get what it needs, `tolerance` is the relative error of its values."""

    name: str
    source: str
    tolerance = 1e-9

    @abstractmethod
    def is_installed(self) -> bool:
        """Whether everything is installed that the reader needs."""

    @abstractmethod
    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        """The signals of each frame by name; raises an exception of the reader if it cannot load the file.

        Raises UnsupportedFileError if that is a known defect.
        """
