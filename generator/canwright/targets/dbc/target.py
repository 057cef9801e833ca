"""The target `dbc`."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.message import Direction
from ...model.types import Assignment
from ..base import CodeExample, EditionInput, NameProblem, Output, Target, WorkedExchange
from ..options import Options
from . import generate
from .files import reply_file, stems
from .names import exported_names, long_names
from .selection import COMMENTS, NODES


class DbcTarget(Target):
    """Generates DBC files."""

    title = "DBC"
    options = (NODES, COMMENTS)

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        return generate(specifications, set_parameters, options)

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        return long_names(edition)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        owners: dict[str, Edition] = {}
        for edition in editions:
            for name in stems(edition):
                owner = owners.setdefault(name.lower(), edition)
                if owner is not edition:
                    yield edition, f"{owner.family} {owner.name} would also have the files `{name}-….dbc`"
                    break

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """The host, the first node of each address, signals, and names of values."""
        return exported_names(edition)

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample | None:
        frame, command = worked.reply, worked.command
        if frame is None or frame.remote or command.entry is not None or _has_several_lengths(edition):
            return None  # a terminal cannot decode tables and frames of several lengths in one line
        file = reply_file(edition, worked.parameters)
        digits = 8 if frame.extended else 3
        line = f"can0 {frame.id:0{digits}X} [{len(frame.data)}] {frame.data.hex(' ').upper()}"
        text = f"echo '{line}' | cantools decode --single-line {file}.dbc"
        return CodeExample("sh", text) if file else None


@functools.lru_cache(maxsize=4)
def _has_several_lengths(edition: Edition) -> bool:
    """Whether replies have different numbers of data bytes."""
    return len({message.dlc for message in edition.messages(Direction.REPLY)}) > 1


TARGET = DbcTarget()
