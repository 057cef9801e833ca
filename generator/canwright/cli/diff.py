"""`diff` and `editions`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from ..diagnostics.diagnostic import SpecError
from ..project.accepted import AcceptedChange, Baseline, baseline_text, facts, read_baseline
from ..project.configuration import KINDS, kind_of_change
from ..project.references import STANDARD_INPUT, FolderChanges, UnknownEditionError, find, since
from . import COULD_NOT_RUN, printers
from .common import FINDINGS, SPEC_FOLDER, FilePath, configuration, or_packaged, read, show_findings, spec_option, stop
from .diff_report import FOR_PROGRAMS, REPORTS, Comparison, Policy, Report
from .terminal import print_data, print_text


@click.command()
@click.argument("references", nargs=-1, metavar="OLD NEW")
@click.option(
    "--against", metavar="REVISION", help="Compare all specs of a folder, by default spec/, with a git revision."
)
@click.option(
    "--format",
    "report_format",
    type=click.Choice(list(REPORTS)),
    default="text",
    show_default=True,
    help="The format of the report; `summary` is for a pull request.",
)
@click.option(
    "--fail-on",
    metavar="KIND,KIND",
    help=f"Exit 1 on changes of these kinds: {', '.join(KINDS)}.  [default: breaking]",
)
@click.option("--no-doc", is_flag=True, help="Omit changes of texts.")
@click.option(
    "--baseline", type=FilePath(dir_okay=False), help="A file of accepted changes, which are counted and do not fail."
)
@click.option(
    "--write-baseline", metavar="REASON", help="Accept the changes that fail, for a reason: add them to the file."
)
def diff(
    references: Sequence[str],
    against: str | None,
    report_format: str,
    fail_on: str | None,
    no_doc: bool,
    baseline: Path | None,
    write_baseline: str | None,
) -> None:
    """Show what changed from OLD to NEW, and who is affected.

    Each is a file, an edition of spec/ or of the package by its name, a file at a git revision, or - for standard input:

    \b
      canwright diff v1 v2
      canwright diff spec/lamp/v1.yaml my.yaml --fail-on wire,value
      canwright diff HEAD~1:spec/lamp/v1.yaml spec/lamp/v1.yaml
      canwright diff :spec/lamp/v1.yaml spec/lamp/v1.yaml       (the index of git)
      canwright diff --against main                             (all of spec/)

    Golden frames are ignored, so a new edition can be compared before they fit it.

    Categories: wire (bits), value (meaning of bits), api (names in the bindings), doc (texts). After a silent change, a
    program of the old edition keeps running, but reads or commands something else. After a loud one, it receives no
    reply or reports an error. Both are breaking if they are of wire or value: then the exit status is 1. Use
    --fail-on none to prevent it; canwright.toml contains the severity of rules.
    """
    settings, folder = configuration()
    try:
        kinds = [kind_of_change(kind.strip()) for kind in fail_on.split(",") if kind.strip()] if fail_on else None
    except ValueError as error:
        stop(f"--fail-on: {error}")
    if baseline is None and settings.diff.baseline is not None:
        baseline = folder / settings.diff.baseline
    if write_baseline is not None and (baseline is None or not write_baseline.strip()):
        stop("--write-baseline requires a reason, and --baseline FILE to write to")
    if baseline is not None and write_baseline is None and not baseline.exists():
        stop(f"there is no file {baseline.as_posix()}; write it with --write-baseline REASON")
    try:
        accepted = read_baseline(baseline) if baseline and baseline.exists() else Baseline()
        compared = _compared(references, against)
    except SpecError as error:
        show_findings(error.diagnostics, "text")
        sys.exit(COULD_NOT_RUN)
    except (UnknownEditionError, OSError) as error:
        stop(str(error))
    policy = Policy(settings.diff, settings.diff.fail_on if kinds is None else kinds, accepted.reasons, no_doc)
    report = Report(
        tuple(Comparison.of(old, new, policy) for old, new in compared.pairs), compared.added, compared.removed, against
    )
    if baseline and write_baseline is not None:
        _write(baseline, accepted, report, write_baseline.strip())
        return
    _print(report, report_format)
    stale = accepted.unused((comparison.title for comparison in report.comparisons), report.accepted)
    if stale:
        print_text(printers.text(stale) + "\n", error=True, styled=True)
    if any(comparison.failing for comparison in report.comparisons):
        sys.exit(FINDINGS)


def _print(report: Report, report_format: str) -> None:
    text = REPORTS[report_format](report)
    if report_format in FOR_PROGRAMS:
        print_data(text + "\n")
    else:
        print_text(text + "\n", styled=report_format == "text")


def _compared(references: Sequence[str], against: str | None) -> FolderChanges:
    """The editions to compare. Raises UnknownEditionError, SpecError and OSError."""
    if against is not None:
        if len(references) > 1:
            stop("--against compares one folder; give one folder, or none for spec/")
        return since(against, Path(*references) if references else SPEC_FOLDER)
    if len(references) != 2:
        stop("give OLD and NEW, or --against REVISION; `canwright diff --help` shows examples")
    if list(references).count(STANDARD_INPUT) > 1:
        stop("standard input contains one spec; give a file or a revision for the other one")
    old, new = (find(reference, SPEC_FOLDER, for_output=False) for reference in references)
    families = [item.specification.edition.family for item in (old, new)]
    if families[0] != families[1]:
        stop(f"`{families[0]}` and `{families[1]}` are different families; give two editions of one family")
    return FolderChanges(((old, new),), (), ())


def _write(file: Path, known: Baseline, report: Report, reason: str) -> None:
    """Adds the changes that fail to the accepted ones, and removes the unused entries of the compared editions."""
    titles = {comparison.title for comparison in report.comparisons}
    kept = [entry for entry in known.accepted if entry.editions not in titles or entry.identity in report.accepted]
    added = [
        AcceptedChange(
            editions=comparison.title, rule=change.rule.id, item=str(change.item), facts=facts(change), reason=reason
        )
        for comparison in report.comparisons
        for change in comparison.failing
    ]
    content = {entry.identity: entry for entry in (*kept, *added)}
    try:
        file.write_text(baseline_text(content.values()), "utf-8", newline="\n")
    except OSError as error:
        stop(str(error))
    print_text(f"wrote {file.as_posix()}: {len(content)} accepted\n")


@click.command()
@spec_option
def editions(specs: Sequence[Path]) -> None:
    """List the editions: family, name, date, commands, title.

    Without --spec and without a folder spec/, these are the editions in the package.
    """
    rows = [("family", "edition", "date", "commands", "title")]
    for item in read(or_packaged(specs)):
        edition = item.edition
        groups = dict.fromkeys(command.spec_name for command in edition.commands)
        title = next(iter(edition.title.values()), "")
        rows.append((edition.family, edition.name, edition.date, str(len(groups)), title))
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        print_text("  ".join([*cells, row[4]]).rstrip() + "\n")
