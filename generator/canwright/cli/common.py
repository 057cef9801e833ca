"""Shared by all commands: options, reading specs, errors and exit status."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import click

from ..diagnostics.diagnostic import Diagnostic, Severity, SpecError, near, nearest
from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..model.formatting import counted
from ..output.new_files import write_new
from ..project.configuration import Configuration, candidates, configuration_file, read_configuration
from ..project.loader import Loaded, all_loaded, frames_file, project_specs, spec_files, specs_below
from ..targets.base import EditionInput
from ..templating.resources import SPECS
from . import COULD_NOT_RUN
from .printers import PRINTERS
from .run_record import Printed, RunRecord
from .terminal import print_data, print_text

SPEC_FOLDER = Path("spec")
OUT_FOLDER = Path("generated")

FINDINGS = 1


class FilePath(click.Path):
    def __init__(self, **arguments: bool) -> None:
        super().__init__(path_type=Path, **arguments)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("The path is empty; `.` is the current folder.", param, ctx)
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            file = Path(str(value))
            siblings = sorted(file.parent.glob("*")) if file.parent.is_dir() and not file.exists() else []
            stems = {f.stem: f.name for f in sorted(siblings, key=lambda f: f.suffix == file.suffix)}
            match = stems.get(near(file.stem, stems) or "")
            self.fail(
                f"{visible(error.message)}{f' Did you mean {visible((file.parent / match).as_posix())}?' if match else ''}",
                param,
                ctx,
            )


class OutputPath(FilePath):
    """The name of a file whose ending selects its format."""

    def __init__(self, formats: Sequence[str]) -> None:
        super().__init__(dir_okay=False)
        self.formats = formats

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        path: Path = super().convert(value, param, ctx)
        if path.suffix not in self.formats:
            self.fail(f"{visible(path.name)} must end in {', '.join(self.formats)}", param, ctx)
        return path


class OfSpecs(click.Command):
    """A command without arguments; a spec is given by an option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            if type(error) is not click.UsageError:
                raise
            raise click.UsageError(f"{error.message.rstrip('.')}; give a spec as --spec my.yaml", ctx) from None


def _specs(ctx: click.Context, param: click.Parameter, given: Sequence[Path]) -> list[Path]:
    """The specs that are given, and all specs in the folders that are given."""
    files: list[Path] = []
    for path in given:
        specs = specs_below(path) if path.is_dir() else [path]
        if not specs:
            raise click.BadParameter(
                f"The folder '{visible(path.as_posix())}' has no spec; expected *.yaml or */*.yaml.", ctx, param
            )
        files += specs
    return files


spec_option = click.option(
    "--spec",
    "specs",
    multiple=True,
    type=FilePath(exists=True),
    callback=_specs,
    help="A spec, or a folder of specs, to read; may be given several times.  [default: spec/*/*.yaml, or without them "
    "the specs in the current folder]",
)
format_option = click.option(
    "--format",
    "printer",
    type=click.Choice(list(PRINTERS)),
    default="text",
    show_default=True,
    help="The format of findings.",
)
cache_option = click.option(
    "--no-cache",
    is_flag=True,
    help="Generate everything, even if the cache folder of the user records that nothing changed.",
)


def configuration() -> tuple[Configuration, Path]:
    """The configuration of the project and its folder. Errors are printed and exit the command."""
    try:
        file = configuration_file()
        return (read_configuration(file), file.parent) if file else (Configuration(), Path())
    except SpecError as error:
        show_findings(error.diagnostics, "text")
        sys.exit(COULD_NOT_RUN)
    except OSError as error:
        stop(str(error))


def read(specs: Sequence[Path], printer: str = "text", *, packaged: bool = False) -> list[EditionInput]:
    """The editions of the given specs, or of all specs, without golden frames. Errors are printed and exit the command.

    If `packaged`, the editions in the package are the default where there is no spec.
    """
    return [item.specification for item in load(or_packaged(specs) if packaged else specs, printer, for_output=False)]


def of_edition(specifications: Sequence[EditionInput], name: str | None) -> Sequence[EditionInput]:
    """Those of the edition with this name, `v1` or `lamp/v1`, or all without one. Stops if there is none."""
    if name is None:
        return specifications
    chosen = [item for item in specifications if name in (item.edition.name, full_name(item.edition))]
    if not chosen:
        known = [item.edition.name for item in specifications]
        stop(f"there is no edition `{name}`; {nearest(name, known) or 'run `canwright editions` for a list'}")
    return chosen


def full_name(edition: Edition) -> str:
    """The name of an edition with its family, which is unique: `lamp/v1`."""
    return f"{edition.family}/{edition.name}"


def or_packaged(specs: Sequence[Path]) -> Sequence[Path]:
    """The given specs; without any, and without a folder of specs, those in the package."""
    return specs or project_specs(Path(), SPEC_FOLDER) or spec_files(SPECS)


def load(
    specs: Sequence[Path], printer: str = "text", record: RunRecord | None = None, *, for_output: bool = True
) -> list[Loaded]:
    """The given specs, or all specs, with their warnings and documents. Errors are printed and exit the command."""
    files = list({os.path.realpath(file): file for file in specs}.values())
    try:
        files = files or project_specs(Path(), SPEC_FOLDER)
    except OSError as error:
        stop(str(error))
    if not files:
        stop(
            f"no spec found in {SPEC_FOLDER}/ or here; change to its folder, give one as --spec my.yaml, or `canwright init`"
        )
    if record:
        record.watch([*(file for spec in specs or files for file in (spec, frames_file(spec))), *candidates()])
    settings = configuration()[0].check
    try:
        loaded = all_loaded(files, for_output=for_output)
    except SpecError as error:
        show_findings(settings.applied(error.diagnostics), printer)
        sys.exit(FINDINGS)
    except OSError as error:
        stop(str(error))
    loaded = [item._replace(warnings=settings.applied(item.warnings)) for item in loaded]
    findings = [finding for item in loaded for finding in item.warnings]
    if record and any(finding.severity is Severity.ERROR for finding in findings):
        show_findings(findings, printer)
        sys.exit(FINDINGS)
    return loaded


def show_findings(findings: Sequence[Diagnostic], printer: str) -> None:
    """Prints findings: as text on standard error with their count, in any other format on standard output."""
    show(findings_text(findings, printer))


def findings_text(findings: Sequence[Diagnostic], printer: str) -> Printed:
    """What `show_findings` prints."""
    listed = PRINTERS[printer](findings) + "\n"
    if printer != "text":
        return Printed(listed)
    counts = Counter(finding.severity.value for finding in findings)
    total = " and ".join(counted(count, kind) for kind, count in sorted(counts.items()))
    return Printed("", f"{listed}{total}; `canwright explain RULE` explains a rule\n")


def show(printed: Printed) -> None:
    """Prints on standard error, then on standard output; in colour on a terminal."""
    print_text(printed.error, error=True, styled=True)
    print_data(printed.out)


def write_new_files(files: Mapping[Path, str]) -> None:
    """Writes files and prints their names; stops if one of them exists. Raises OSError, with nothing written."""
    existing = next((file for file in files if file.exists()), None)
    try:
        if existing is None:
            write_new(files)
    except FileExistsError as error:
        existing = Path(error.filename)
    if existing is not None:
        stop(f"{existing.as_posix()} exists already; nothing was written, choose another name or remove it")
    for file in files:
        print_text(f"wrote {file.as_posix()}\n")


def stop(message: str) -> NoReturn:
    print_text(f"canwright: {message}\n", error=True)
    sys.exit(COULD_NOT_RUN)
