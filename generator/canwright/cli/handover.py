"""`handover`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from ..output.paths import OutputError
from ..output.writer import Content, refuse_occupied, write
from ..targets.handover.target import PDF
from ..targets.options import Options
from ..targets.registry import target
from .common import FilePath, load, spec_option, stop
from .terminal import print_text

TARGET = "handover"


@click.command()
@spec_option
@click.option(
    "--out",
    type=FilePath(file_okay=False, readable=False),
    default=Path("handover"),
    show_default=True,
    help="Folder of the documents.",
)
@click.option("--pdf", is_flag=True, help="Also write a PDF of each edition and language.")
@click.option("--force", is_flag=True, help="Overwrite documents of an earlier run that were edited by hand.")
def handover(specs: Sequence[Path], out: Path, pdf: bool, force: bool) -> None:
    """Write documents to hand over: HTML, PDF, Excel, and the command matrix as CSV.

    Each edition and language has one HTML file. It needs no network, has contents and a search, and prints well. The
    command matrix has one row for each field, or several if its resolution depends on a parameter. The Excel file has
    sheets for commands, fields, types, errata and sources. A PDF needs the packages of the extra `pdf`. The folder must be new, empty, or that of an earlier run.
    """
    specifications = [item.specification for item in load(specs)]
    try:
        refuse_occupied(out, (TARGET,))
        files = {o.path: o.content for o in target(TARGET).generate(specifications, {}, Options({PDF: pdf}))}
        write(out, Content((), (TARGET,), files, alone=True), force=force)
    except OutputError as error:
        stop(str(error))
    print_text("".join(f"{out.as_posix()}/{name}\n" for name in sorted(files)))
