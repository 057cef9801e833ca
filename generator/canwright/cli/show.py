"""`show`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from .common import of_edition, read, spec_option, stop
from .terminal import print_text


@click.command()
@click.argument("command")
@spec_option
@click.option("--edition", help="The edition to show.  [default: all with this command]")
@click.option("--lang", type=click.Choice(["en", "zh"]), default="en", show_default=True, help="Language of the texts.")
def show(command: str, specs: Sequence[Path], edition: str | None, lang: str) -> None:
    """Show one COMMAND, by name, by code (0x10), or by the CAN id of a broadcast.

    Its frames in both directions, effects, limits and errata. Without --spec and without a folder spec/, the editions in
    the package are shown.

    Exit status: 0 if a command is found, 2 if not.
    """
    from .command_view import command_text, find

    specifications = of_edition(read(specs, packaged=True), edition)
    pairs, hint = find([item.edition for item in specifications], command)
    if not pairs:
        stop(f"there is no command `{command}`; {hint}")
    for i, (item, shown) in enumerate(pairs):
        if i:
            print_text("\n")
        print_text(command_text(item, shown, lang), styled=True)
