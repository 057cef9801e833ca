"""`show`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from .common import read, spec_option, stop


@click.command()
@click.argument("command")
@spec_option
@click.option("--lang", type=click.Choice(["en", "zh"]), default="en", show_default=True, help="Language of the texts.")
def show(command: str, specs: Sequence[Path], lang: str) -> None:
    """Show one COMMAND, by name or by code (0x10): bytes in both directions, what it does, what to mind."""
    from ..show import find, show_command

    described = read(specs)
    found, hint = find(described, command)
    if not found:
        stop(f"there is no command `{command}`; {hint}")
    for item, one in found:
        show_command(item, one, lang)
