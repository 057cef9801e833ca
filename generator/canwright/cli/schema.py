"""`schema`."""

from __future__ import annotations

import click

from ..golden import GoldenFrames
from ..schema import EditionSpec, schema_text


@click.command()
@click.option("--frames", is_flag=True, help="The schema of golden frames instead.")
def schema(frames: bool) -> None:
    """Print the JSON Schema of the language, for editors."""
    click.echo(schema_text(GoldenFrames if frames else EditionSpec), nl=False)
