"""`generate` and `check`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from ..diagnostics.diagnostic import Diagnostic, Position, Severity
from ..output.paths import OutputError
from ..output.writer import Content, FileChanges, difference, write
from ..project.pipeline import generate as make
from ..targets.registry import target_names
from .common import (
    FINDINGS,
    OUT_FOLDER,
    FilePath,
    OfSpecs,
    cache_option,
    comments_option,
    findings_text,
    format_option,
    load,
    nodes_option,
    record_argument,
    set_option,
    show,
    show_findings,
    spec_option,
    stop,
    target_option,
)
from .run_record import Printed, RunRecord
from .settings import assignment, options
from .terminal import print_text


@click.command(cls=OfSpecs)
@spec_option
@target_option
@set_option
@nodes_option
@comments_option
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
@cache_option
@record_argument
def generate(
    record: RunRecord,
    specs: Sequence[Path],
    targets: Sequence[str],
    settings: Sequence[str],
    nodes: str,
    language: str,
    printer: str,
    out: Path,
    force: bool,
    no_cache: bool,
) -> None:
    """Write the bindings and documents of the specs.

    Nothing is written if a spec has errors. Files of an earlier run that are no longer generated are removed;
    files that canwright did not generate are never changed.
    """
    loaded = load(specs, printer, record)
    specifications = [one.specification for one in loaded]
    warnings = [warning for one in loaded for warning in one.warnings]
    set_parameters = assignment(specifications, settings)
    selected = options(specifications, targets, nodes, language)
    try:
        content = make(specifications, targets or target_names(), set_parameters, selected)
        changes = write(out, content, force=force)
    except OutputError as error:
        stop(str(error))
    if printer == "text":
        for path in changes.removed:
            print_text(f"removed {out.as_posix()}/{path}\n")
    show(_report(warnings, _summary(content, changes, out), printer))
    if not no_cache:
        unchanged = FileChanges((), (), len(content.files))
        record.save(out, content, _report(warnings, _summary(content, unchanged, out), printer))


def _summary(content: Content, changes: FileChanges, out: Path) -> str:
    return (
        f"{', '.join(content.editions)}: {len(changes.written)} files written, {changes.unchanged} unchanged, "
        f"{len(changes.removed)} removed in {out.as_posix()}/"
    )


@click.command(cls=OfSpecs)
@spec_option
@target_option
@set_option
@nodes_option
@comments_option
@format_option
@click.option(
    "--out", type=FilePath(file_okay=False, readable=False), help="Folder to compare with.  [default: generated]"
)
@click.option("--strict", is_flag=True, help="Exit 1 if there are warnings.")
@cache_option
@record_argument
def check(
    record: RunRecord,
    specs: Sequence[Path],
    targets: Sequence[str],
    settings: Sequence[str],
    nodes: str,
    language: str,
    printer: str,
    out: Path | None,
    strict: bool,
    no_cache: bool,
) -> None:
    """Check the specs, and compare the output with them.

    Prints a unified diff and exits 1 if the output differs. With --spec but without --out, only the spec is checked.
    """
    loaded = load(specs, printer, record)
    specifications = [one.specification for one in loaded]
    warnings = [warning for one in loaded for warning in one.warnings]
    names = ", ".join(f"{d.edition.family} {d.edition.name}" for d in specifications)
    set_parameters = assignment(specifications, settings)
    selected = options(specifications, targets, nodes, language)
    if specs and out is None:
        show(_report(warnings, f"{names}: OK", printer))
        sys.exit(FINDINGS if warnings and strict else 0)
    out = out or OUT_FOLDER
    try:
        content = make(specifications, targets or target_names(), set_parameters, selected)
        found = list(difference(out, content))
    except OutputError as error:
        stop(str(error))
    if not found:
        report = _report(warnings, f"{names}: OK, and {out.as_posix()}/ is up to date", printer)
        show(report)
        if warnings and strict:
            sys.exit(FINDINGS)
        if not no_cache:
            record.save(out, content, report)
        return
    if printer == "text":
        for text in found:
            print_text(text)
    differs = f"{len(found)} files in {out.as_posix()}/ differ from the specs"
    place = Position(out.as_posix(), 1, 1, 1, "")
    stale = Diagnostic(Severity.ERROR, "stale-output", differs, place, "run `canwright generate`")
    show_findings([*warnings, stale], printer)
    sys.exit(FINDINGS)


def _report(warnings: Sequence[Diagnostic], message: str, printer: str) -> Printed:
    if printer != "text":
        return findings_text(warnings, printer)
    return Printed(f"{message}\n", findings_text(warnings, printer).error if warnings else "")
