"""`schema`."""

from __future__ import annotations

import click

from ..document.builder import MAX_VALUES
from ..document.document import MAX_BYTES
from ..language.edition import EditionSpec, schema_text
from ..language.golden_frames import GoldenFramesSpec
from ..resolve.limits import MAX_COMMANDS, MAX_FIELDS
from ..rules.too_large import MAX_COMBINATIONS, MAX_SIZE
from .terminal import print_data

_LIMITS = {
    "megabytes": MAX_BYTES >> 20,
    "file_values": MAX_VALUES,
    "commands": MAX_COMMANDS,
    "fields": MAX_FIELDS,
    "combinations": MAX_COMBINATIONS,
    "size": MAX_SIZE,
}
"""The limits of a spec, for the guide."""


@click.command()
@click.option("--frames", is_flag=True, help="Print the schema of golden frames instead.")
@click.option("--page", is_flag=True, help="Print a guide to specs with every key, in Markdown, instead.")
def schema(frames: bool, page: bool) -> None:
    """Print the JSON Schema of the language, for editors."""
    if page:
        from ..language import reference

        print_data(reference.page(_LIMITS))
        return
    print_data(schema_text(GoldenFramesSpec if frames else EditionSpec))
