"""Where pages are: the only place that knows their paths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from urllib.parse import quote, urlencode

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame
from ...model.layout import Field
from ...model.message import Command, Direction, Message

COMMANDS = "commands/"
"""The folder of the command pages, from the folder of their edition."""
PICTURES = "pictures"
"""The folder of the pictures, which all languages share, beside those of the languages."""


def command_page(command: Command) -> str:
    """The page of a command in the folder of command pages; an entry of a table is a section of it."""
    return f"{command.spec_name}.md" + (f"#{entry_anchor(command)}" if command.entry else "")


def entry_anchor(command: Command) -> str:
    """The anchor of the section of an entry."""
    return f"entries.{command.entry.name}" if command.entry else ""


def field_anchor(command: Command, direction: Direction, field: Field) -> str:
    """The anchor of the row of a field in the page of a command."""
    return ".".join(filter(None, (entry_anchor(command), direction.value, field.name)))


def command_link(edition: Edition, name: str) -> str:
    """The page of the command with a name."""
    return command_page(edition.command(name))


def explorer_link(edition: str, frame: GoldenFrame, message: Message) -> str:
    """The frame explorer with a frame of a message and its parameters, from the page of a command.

    The site has a copy of the explorer, or removes the link.
    """
    state = {"frame": formatting.sent(frame), "edition": edition}
    state |= {"direction": message.direction.value, "command": message.command}
    state |= {f"parameter.{name}": value for name, value in formatting.parameter_values(frame.parameters).items()}
    return f"../../../../javascript/explorer/index.html#{urlencode(state, quote_via=quote)}"


def pages_of(edition: Edition, names: Sequence[str]) -> Mapping[str, str]:
    """Titles and pages of commands by name; a command with a table is one item where all its entries are listed."""
    pages: dict[str, str] = {}
    listed = set(names)
    for command in (edition.command(name) for name in names):
        if command.entry is None or listed.issuperset(form.name for form in edition.forms(command.spec_name)):
            pages[command.spec_name] = f"{command.spec_name}.md"
        else:
            pages[command.name] = command_page(command)
    return pages
