"""`diff` and `editions`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from ..compare import Category, Impact
from ..diagnostics.diagnostic import SpecError
from ..project.loader import Loaded
from ..project.references import UnknownEditionError, find
from . import COULD_NOT_RUN
from .common import FINDINGS, SPEC_FOLDER, load, show_findings, spec_option, stop
from .diff_report import REPORTS, Comparison

FAILS = (*(c.value for c in Category), Impact.SILENT.value, Impact.LOUD.value)


@click.command()
@click.argument("old")
@click.argument("new")
@click.option(
    "--format",
    "report",
    type=click.Choice(list(REPORTS)),
    default="text",
    show_default=True,
    help="The format of the report.",
)
@click.option(
    "--fail-on", metavar="KIND,KIND", default="", help=f"Exit 1 on changes of these kinds: {', '.join(FAILS)}."
)
def diff(old: str, new: str, report: str, fail_on: str) -> None:
    """Show what changed from OLD to NEW, and who is affected.

    Both are a file, an edition of spec/ by its name, or a revision of a file in git:

    \b
      canwright diff v1 v2
      canwright diff spec/lamp/v1.yaml my.yaml --fail-on wire,value
      canwright diff HEAD~1:spec/lamp/v1.yaml spec/lamp/v1.yaml

    Golden frames are ignored, so a new edition can be compared before they fit it.

    Categories: wire (bits), value (meaning of bits), api (names in the bindings), doc (texts). After a silent change, a
    program of the old edition keeps running, but reads or commands something else. After a loud one, it receives no
    reply or reports an error.
    """
    kinds = [kind.strip() for kind in fail_on.split(",") if kind.strip()]
    for kind in kinds:
        if kind not in FAILS:
            stop(f"--fail-on has no kind `{kind}`; use one of: {', '.join(FAILS)}")
    before, after = _find(old), _find(new)
    families = [one.specification.edition.family for one in (before, after)]
    if families[0] != families[1]:
        stop(f"`{families[0]}` and `{families[1]}` are different families; give two editions of one family")
    found = Comparison.of(before, after)
    click.echo(REPORTS[report](found))
    if any({c.rule.category.value, c.impact.value} & set(kinds) for c in found.changes):
        sys.exit(FINDINGS)


def _find(reference: str) -> Loaded:
    try:
        return find(reference, SPEC_FOLDER, golden=False)
    except SpecError as error:
        show_findings(error.diagnostics, "text")
        sys.exit(COULD_NOT_RUN)
    except (UnknownEditionError, OSError) as error:
        stop(str(error))


@click.command()
@spec_option
def editions(specs: Sequence[Path]) -> None:
    """List the editions: family, name, date, commands, title."""
    rows = [("family", "edition", "date", "commands", "title")]
    for one in load(specs):
        edition = one.specification.edition
        groups = dict.fromkeys(command.group for command in edition.commands)
        title = next(iter(edition.title.values()), "")
        rows.append((edition.family, edition.name, edition.date, str(len(groups)), title))
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    for row in rows:
        click.echo("  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[4]]).rstrip())
