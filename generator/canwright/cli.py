"""The command line."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import click

from . import __version__
from .diagnostics import SpecError
from .generate import TARGETS, generate as make
from .golden import GoldenFrames
from .load import all_described, spec_files
from .model import Assignment
from .output import Content, OutputError, difference, write
from .schema import EditionSpec, schema_text
from .targets import Described

SPEC_FOLDER = Path("spec")
OUT_FOLDER = Path("generated")

FINDINGS = 1
COULD_NOT_RUN = 2


class _Path(click.Path):
    def __init__(self, **arguments: bool) -> None:
        super().__init__(path_type=Path, **arguments)


spec_option = click.option(
    "--spec",
    "specs",
    multiple=True,
    type=_Path(exists=True, dir_okay=False),
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


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, "-V", "--version", message="canwright %(version)s")
def main() -> None:
    """Bindings and documents from one YAML description of a CAN protocol.

    \b
    Start here:
      canwright generate                              everything in spec/ into generated/
      canwright check                                 is generated/ what spec/ says?
      canwright show COMMAND                          one command, in the terminal
      canwright generate --spec my.yaml --out out     your own protocol, in any folder

    Exit status: 0 when all is well, 1 when there are findings, 2 when it could not run.
    """


@main.command()
@spec_option
@target_option
@set_option
@click.option("--out", type=_Path(file_okay=False), default=OUT_FOLDER, show_default=True, help="Folder to write to.")
@click.option("--force", is_flag=True, help="Overwrite files edited by hand, and drop editions not in this run.")
def generate(specs: Sequence[Path], targets: Sequence[str], settings: Sequence[str], out: Path, force: bool) -> None:
    """Write the bindings and documents of the specs.

    Nothing is written unless every spec is right. Files of an earlier run that are no longer generated are removed;
    files that canwright did not make are never touched.
    """
    content = _content(_read(specs), targets, settings)
    try:
        changes = write(out, content, force=force)
    except (OutputError, OSError) as error:
        _stop(str(error))
    for path in changes.removed:
        click.echo(f"removed {out.as_posix()}/{path}")
    click.echo(
        f"{', '.join(content.editions)}: {len(changes.written)} files written, {changes.unchanged} unchanged, "
        f"{len(changes.removed)} removed in {out.as_posix()}/"
    )


@main.command()
@spec_option
@target_option
@set_option
@click.option("--out", type=_Path(file_okay=False), help="Folder to compare with.  [default: generated]")
def check(specs: Sequence[Path], targets: Sequence[str], settings: Sequence[str], out: Path | None) -> None:
    """Check that the specs are right and that the output is what they say.

    Prints a unified diff and exits 1 where the output differs. With --spec and without --out, the spec alone is checked.
    """
    described = _read(specs)
    names = ", ".join(f"{d.edition.family} {d.edition.name}" for d in described)
    if specs and out is None:
        click.echo(f"{names}: right")
        return
    out = out or OUT_FOLDER
    try:
        found = list(difference(out, _content(described, targets, settings)))
    except (OutputError, OSError) as error:
        _stop(str(error))
    for text in found:
        click.echo(text, nl=False)
    if found:
        click.echo(f"{len(found)} files in {out.as_posix()}/ differ from the specs; run `canwright generate`", err=True)
        sys.exit(FINDINGS)
    click.echo(f"{names}: right, and {out.as_posix()}/ is what would be generated")


@main.command()
@click.argument("command")
@spec_option
@click.option("--lang", type=click.Choice(["en", "zh"]), default="en", show_default=True, help="Language of the texts.")
def show(command: str, specs: Sequence[Path], lang: str) -> None:
    """Show one COMMAND, by name or by code (0x10): bytes in both directions, what it does, what to mind."""
    from .show import find, show_command

    described = _read(specs)
    found, hint = find(described, command)
    if not found:
        _stop(f"there is no command `{command}`; {hint}")
    for item, one in found:
        show_command(item, one, lang)


@main.command()
@click.option("--docs", type=_Path(file_okay=False), default=OUT_FOLDER / "docs", show_default=True, help="The pages.")
@click.option("--out", type=_Path(file_okay=False), default=Path("site"), show_default=True, help="Folder of the site.")
def site(docs: Path, out: Path) -> None:
    """Build the pages into a site: both languages, search, nothing fetched from elsewhere.

    Needs `pip install 'canwright[site]'`. A link that leads nowhere stops it.
    """
    from .site import SiteError, build

    try:
        build(docs, out)
    except (SiteError, OSError) as error:
        _stop(str(error))
    click.echo(f"{out.as_posix()}/index.html")


@main.command()
@click.option("--frames", is_flag=True, help="The schema of golden frames instead.")
def schema(frames: bool) -> None:
    """Print the JSON Schema of the language, for editors and other tools."""
    click.echo(schema_text(GoldenFrames if frames else EditionSpec), nl=False)


def _read(specs: Sequence[Path]) -> list[Described]:
    files = list(specs) or spec_files(SPEC_FOLDER)
    if not files:
        _stop(f"there is no spec in {SPEC_FOLDER}/; name one with --spec my.yaml")
    try:
        return all_described(files)
    except SpecError as error:
        for finding in error.diagnostics:
            click.echo(str(finding), err=True)
        count = len(error.diagnostics)
        click.echo(f"{count} finding{'s' if count != 1 else ''}, nothing was written", err=True)
        sys.exit(FINDINGS)
    except OSError as error:
        _stop(str(error))


def _content(described: Sequence[Described], targets: Sequence[str], settings: Sequence[str]) -> Content:
    return make(described, targets or list(TARGETS), _assignment(described, settings))


def _assignment(described: Sequence[Described], settings: Sequence[str]) -> Assignment:
    """`--set` as an assignment, each name and value one that some edition knows."""
    known = {p.name: {v.name for v in p.values} for d in described for p in d.edition.parameters if p.is_choice}
    result = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        if value not in known.get(name, set()):
            wanted = "; ".join(f"{n}={'|'.join(sorted(v))}" for n, v in sorted(known.items()))
            _stop(f"--set {setting} is not a parameter and its value; there are: {wanted}")
        result[name] = value
    return result


def _stop(message: str) -> NoReturn:
    click.echo(f"canwright: {message}", err=True)
    sys.exit(COULD_NOT_RUN)
