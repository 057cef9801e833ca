"""`schema`."""

from __future__ import annotations

import click

from ..language.edition import EditionSpec, schema_text
from ..language.golden_frames import GoldenFrames
from .terminal import print_data


@click.command()
@click.option("--frames", is_flag=True, help="Print the schema of golden frames instead.")
@click.option("--page", is_flag=True, help="Print a guide to specs with every key, in Markdown, instead.")
def schema(frames: bool, page: bool) -> None:
    """Print the JSON Schema of the language, for editors."""
    if page:
        from ..language import reference

        print_data(reference.page())
        return
    print_data(schema_text(GoldenFrames if frames else EditionSpec))
