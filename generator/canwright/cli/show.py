"""`show`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from ..diagnostics.diagnostic import nearest
from .common import read, spec_option, stop


@click.command()
@click.argument("command")
@spec_option
@click.option("--edition", help="The edition to show it of.  [default: all that have it]")
@click.option("--lang", type=click.Choice(["en", "zh"]), default="en", show_default=True, help="Language of the texts.")
def show(command: str, specs: Sequence[Path], edition: str | None, lang: str) -> None:
    """Show one COMMAND, by name or by code (0x10).

    Its bytes in both directions, what it does, and what to take care of.
    """
    from .command_view import find, show_command

    described = read(specs)
    if edition is not None:
        names = [one.edition.name for one in described]
        described = [one for one in described if one.edition.name == edition]
        if not described:
            hint = nearest(edition, names) or "`canwright editions` lists them"
            stop(f"there is no edition `{edition}`; {hint}")
    found, hint = find(described, command)
    if not found:
        stop(f"there is no command `{command}`; {hint}")
    for i, (item, one) in enumerate(found):
        if i:
            click.echo()
        show_command(item, one, lang)
