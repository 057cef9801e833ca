"""`site`."""

from __future__ import annotations

from pathlib import Path

import click

from .common import OUT_FOLDER, FilePath, stop


@click.command()
@click.option(
    "--docs", type=FilePath(file_okay=False), default=OUT_FOLDER / "docs", show_default=True, help="The pages."
)
@click.option(
    "--out", type=FilePath(file_okay=False), default=Path("site"), show_default=True, help="Folder of the site."
)
def site(docs: Path, out: Path) -> None:
    """Build the pages into a site: both languages, search, nothing fetched from elsewhere.

    Needs `pip install 'canwright[site]'`. A link that leads nowhere stops it.
    """
    from ..site import SiteError, build

    try:
        build(docs, out)
    except (SiteError, OSError) as error:
        stop(str(error))
    click.echo(f"{out.as_posix()}/index.html")
