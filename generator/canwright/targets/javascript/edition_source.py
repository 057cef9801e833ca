"""The tables and titles of an edition as JavaScript, which the modules and the frame explorer contain."""

from __future__ import annotations

from functools import cached_property

from ...diagnostics.unicode_safety import visible
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrames
from ..base import EditionInput, header
from . import text
from .tables import EditionTables
from .titles import titles


class EditionSpec:
    """The sources of one edition; each is printed once."""

    def __init__(self, specification: EditionInput) -> None:
        self.edition: Edition = specification.edition
        self.frames: GoldenFrames | None = specification.frames
        self.header = visible(header(self.edition))

    @cached_property
    def tables(self) -> str:
        """The tables that the runtime interprets."""
        return text.printed(EditionTables(self.edition).view())

    @cached_property
    def texts(self) -> str:
        """The titles in all languages."""
        return text.printed(titles(self.edition))
