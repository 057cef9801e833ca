"""`generate` and `check`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from ..diagnostics.diagnostic import Diagnostic, Position, Severity
from ..output.paths import OutputError
from ..output.writer import Content, FileChanges, difference, write
from .common import FINDINGS, OUT_FOLDER, SPEC_FOLDER, FilePath, cache_option, findings_text, show, show_findings, stop
from .generation import Generation, GenerationCommand, generation_options
from .run_record import Printed
from .terminal import print_text


@click.command(cls=GenerationCommand)
@generation_options
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
@cache_option
def generate(generation: Generation, out: Path, force: bool) -> None:
    """Write the bindings and documents of the specs.

    Nothing is written if a spec has errors. Files of an earlier run that are no longer generated are removed;
    files that canwright did not generate are never changed.
    """
    try:
        content = generation.content()
        changes = write(out, content, force=force)
    except OutputError as error:
        stop(str(error))
    if generation.printer == "text":
        for path in changes.removed:
            print_text(f"removed {out.as_posix()}/{path}\n")
    show(_report(generation, _summary(generation, content, changes, out)))
    unchanged = FileChanges((), (), len(content.files))
    generation.save(out, content, _report(generation, _summary(generation, content, unchanged, out)))


def _summary(generation: Generation, content: Content, changes: FileChanges, out: Path) -> str:
    counts = (
        f"{', '.join(content.editions)}: {len(changes.written)} files written, {changes.unchanged} unchanged, "
        f"{len(changes.removed)} removed in {out.as_posix()}/"
    )
    return "\n".join([counts, *generation.notices()])


@click.command(cls=GenerationCommand)
@generation_options
@click.option(
    "--out", type=FilePath(file_okay=False, readable=False), help="Folder to compare with.  [default: generated]"
)
@click.option("--strict", is_flag=True, help="Exit 1 if there are warnings.")
@cache_option
def check(generation: Generation, out: Path | None, strict: bool) -> None:
    """Check the specs, and compare the output with them.

    Prints a unified diff and exits 1 if the output differs. Only the spec is checked with --spec but without --out, and in a
    folder with a spec but without spec/ and output.
    """
    warned = FINDINGS if generation.warnings and strict else 0
    is_new = not SPEC_FOLDER.exists() and not OUT_FOLDER.exists()
    if out is None and (generation.has_specs or is_new):
        show(_report(generation, f"{generation.editions}: OK"))
        sys.exit(warned)
    out = out or OUT_FOLDER
    try:
        content = generation.content()
        differences = list(difference(out, content))
    except OutputError as error:
        stop(str(error))
    if not differences:
        report = _report(generation, f"{generation.editions}: OK, and {out.as_posix()}/ is up to date")
        show(report)
        if not warned:
            generation.save(out, content, report)
        sys.exit(warned)
    if generation.printer == "text" and out.exists():
        for text in differences:
            print_text(text)
    differs = f"{len(differences)} files in {out.as_posix()}/ differ from the specs"
    if not out.exists():
        differs = f"there is no folder {out.as_posix()}/ to compare with the specs"
    place = Position(out.as_posix(), 1, 1, 1, "")
    stale = Diagnostic(Severity.ERROR, "stale-output", differs, place, "run `canwright generate`")
    show_findings([*generation.warnings, stale], generation.printer)
    sys.exit(FINDINGS)


def _report(generation: Generation, message: str) -> Printed:
    warnings, printer = generation.warnings, generation.printer
    if printer != "text":
        return findings_text(warnings, printer)
    return Printed(f"{message}\n", findings_text(warnings, printer).error if warnings else "")
