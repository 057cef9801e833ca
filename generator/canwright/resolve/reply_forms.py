"""What a command is where it has a table: one form for each entry; and what comes back from one."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.edition import Key, Layout, Message, ReplyForm


@dataclass(frozen=True)
class Form:
    """A command, or what one entry of a table makes of it."""

    command: str
    entry: str | None
    layout: Layout | None
    keys: tuple[Key, ...]
    kind: str | None = None
    dlc: int | None = None

    @property
    def name(self) -> str:
        return self.command if self.entry is None else f"{self.command}_{self.entry}"


@dataclass(frozen=True)
class Reply:
    """What a command gets back."""

    message: Message | None
    form: ReplyForm
    of: str | None = None
    from_each: tuple[int, ...] = ()
