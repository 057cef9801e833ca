"""What the commands of the command line share: options, reading specs, leaving."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import click

from ..diagnostics import SpecError
from ..generate import TARGETS
from ..load import all_described, spec_files
from ..targets import Described

SPEC_FOLDER = Path("spec")
OUT_FOLDER = Path("generated")

FINDINGS = 1
COULD_NOT_RUN = 2


class FilePath(click.Path):
    def __init__(self, **arguments: bool) -> None:
        super().__init__(path_type=Path, **arguments)


spec_option = click.option(
    "--spec",
    "specs",
    multiple=True,
    type=FilePath(exists=True, dir_okay=False),
    help="A spec to read; may be given several times.  [default: spec/*/*.yaml]",
)
target_option = click.option(
    "--target",
    "targets",
    multiple=True,
    type=click.Choice(list(TARGETS)),
    help="A target; may be given several times.  [default: all]",
)
set_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="Fix a parameter in the DBC files, for example --set size=12.",
)


def read(specs: Sequence[Path]) -> list[Described]:
    files = list(specs) or spec_files(SPEC_FOLDER)
    if not files:
        stop(f"there is no spec in {SPEC_FOLDER}/; name one with --spec my.yaml")
    try:
        return all_described(files)
    except SpecError as error:
        for finding in error.diagnostics:
            click.echo(str(finding), err=True)
        count = len(error.diagnostics)
        click.echo(f"{count} finding{'s' if count != 1 else ''}, nothing was written", err=True)
        sys.exit(FINDINGS)
    except OSError as error:
        stop(str(error))


def stop(message: str) -> NoReturn:
    click.echo(f"canwright: {message}", err=True)
    sys.exit(COULD_NOT_RUN)
