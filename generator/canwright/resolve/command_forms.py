"""Forms of a command: one, or one for each entry of its table."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.layout import Layout
from ..model.message import Key


@dataclass(frozen=True)
class CommandForm:
    """A command, or its variant for one entry of a table."""

    command: str
    entry: str | None
    layout: Layout | None
    keys: tuple[Key, ...]
    kind: str | None = None
    dlc: int | None = None

    @property
    def name(self) -> str:
        return self.command if self.entry is None else f"{self.command}_{self.entry}"
