"""`site`."""

from __future__ import annotations

from pathlib import Path

import click

from ..output.paths import OutputError
from .common import OUT_FOLDER, FilePath, stop
from .terminal import print_text


@click.command()
@click.option(
    "--docs",
    type=FilePath(file_okay=False),
    default=OUT_FOLDER / "docs",
    show_default=True,
    help="Folder of the pages.",
)
@click.option(
    "--out",
    type=FilePath(file_okay=False, readable=False),
    default=Path("site"),
    show_default=True,
    help="Folder of the site.",
)
@click.option(
    "--handover",
    type=FilePath(file_okay=False),
    default=Path("handover"),
    show_default=True,
    help="Folder of `canwright handover`, whose documents the site offers; ignored if it does not exist.",
)
@click.option("--force", is_flag=True, help="Overwrite pages of an earlier site that were edited by hand.")
def site(docs: Path, out: Path, handover: Path, force: bool) -> None:
    """Build the pages into a website with search, in every language.

    Nothing is downloaded. A broken link is an error. The folder must be new, empty, or an earlier site; files that
    canwright did not generate are never changed.
    """
    from ..project.site import SiteError, build

    try:
        build(docs, out, handover, force=force)
    except (SiteError, OutputError, OSError) as error:
        stop(str(error))
    print_text(f"{out.as_posix()}/index.html\n")
