"""`generate` and `check`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from ..diagnostics.diagnostic import Diagnostic, Position, Severity
from ..output.paths import OutputError
from ..output.writer import difference, write
from ..project.pipeline import generate as make
from ..targets.registry import target_names
from .common import (
    FINDINGS,
    OUT_FOLDER,
    FilePath,
    OfSpecs,
    format_option,
    load,
    read,
    set_option,
    show_findings,
    spec_option,
    stop,
    target_option,
)
from .settings import assignment


@click.command(cls=OfSpecs)
@spec_option
@target_option
@set_option
@format_option
@click.option(
    "--out",
    type=FilePath(file_okay=False, readable=False),
    default=OUT_FOLDER,
    show_default=True,
    help="Folder to write to.",
)
@click.option(
    "--force", is_flag=True, help="Overwrite files edited by hand, and remove editions that are not in this run."
)
def generate(
    specs: Sequence[Path], targets: Sequence[str], settings: Sequence[str], printer: str, out: Path, force: bool
) -> None:
    """Write the bindings and documents of the specs.

    Nothing is written if a spec has errors. Files of an earlier run that are no longer generated are removed;
    files that canwright did not generate are never changed.
    """
    specifications = read(specs, printer)
    set_parameters = assignment(specifications, settings)
    try:
        content = make(specifications, targets or target_names(), set_parameters)
        changes = write(out, content, force=force)
    except OutputError as error:
        stop(str(error))
    for path in changes.removed:
        click.echo(f"removed {out.as_posix()}/{path}")
    click.echo(
        f"{', '.join(content.editions)}: {len(changes.written)} files written, {changes.unchanged} unchanged, "
        f"{len(changes.removed)} removed in {out.as_posix()}/"
    )


@click.command(cls=OfSpecs)
@spec_option
@target_option
@set_option
@format_option
@click.option(
    "--out", type=FilePath(file_okay=False, readable=False), help="Folder to compare with.  [default: generated]"
)
@click.option("--strict", is_flag=True, help="Exit 1 if there are warnings.")
def check(
    specs: Sequence[Path], targets: Sequence[str], settings: Sequence[str], printer: str, out: Path | None, strict: bool
) -> None:
    """Check the specs, and compare the output with them.

    Prints a unified diff and exits 1 if the output differs. With --spec but without --out, only the spec is checked.
    """
    loaded = load(specs, printer)
    specifications = [one.specification for one in loaded]
    warnings = [warning for one in loaded for warning in one.warnings]
    names = ", ".join(f"{d.edition.family} {d.edition.name}" for d in specifications)
    set_parameters = assignment(specifications, settings)
    if specs and out is None:
        _report(warnings, f"{names}: OK", printer, strict)
        return
    out = out or OUT_FOLDER
    try:
        found = list(difference(out, make(specifications, targets or target_names(), set_parameters)))
    except OutputError as error:
        stop(str(error))
    if not found:
        _report(warnings, f"{names}: OK, and {out.as_posix()}/ is up to date", printer, strict)
        return
    if printer == "text":
        for text in found:
            click.echo(text, nl=False)
    differs = f"{len(found)} files in {out.as_posix()}/ differ from the specs"
    place = Position(out.as_posix(), 1, 1, 1, "")
    stale = Diagnostic(Severity.ERROR, "stale-output", differs, place, "run `canwright generate`")
    show_findings([*warnings, stale], printer)
    sys.exit(FINDINGS)


def _report(warnings: Sequence[Diagnostic], message: str, printer: str, strict: bool) -> None:
    if warnings or printer != "text":
        show_findings(warnings, printer)
    if printer == "text":
        click.echo(message)
    if warnings and strict:
        sys.exit(FINDINGS)
