"""The limit of commands, checked before they are resolved."""

from __future__ import annotations

from ..diagnostics.diagnostic import SpecError
from ..document.document import Document
from ..language.edition import EditionSpec

MOST_COMMANDS = 5000
"""The maximum number of commands; a command with a table counts once for each entry."""


def check_commands(document: Document, spec: EditionSpec) -> None:
    """Raises SpecError for too many commands."""
    entries = {name: len(table.entries) for name, table in spec.tables.items()}
    count = sum(entries.get(command.table or "", 1) for command in spec.commands.values())
    if count > MOST_COMMANDS:
        text = f"{count} commands, with one for each table entry, exceed the maximum of {MOST_COMMANDS}"
        raise SpecError([document.finding(("commands",), "too-large", text, "split the protocol", key=True)])
