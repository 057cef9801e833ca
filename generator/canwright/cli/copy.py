"""`copy`."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import click

from ..diagnostics.diagnostic import SpecError
from ..document.document import Document, read_document
from ..language.edition import EditionSpec, keys
from ..project.golden_file import as_yaml
from ..project.loader import frames_file, load
from ..project.references import UnknownEditionError, find
from ..templating.resources import SPECS
from .common import SPEC_FOLDER, show_findings, stop, write_new_files
from .terminal import print_text


@click.command()
@click.argument("old")
@click.argument("new", metavar="[NEW|FOLDER]", required=False)
@click.option("--date", help="Date of the new manual: 2023-03 or 2023-03-21.")
@click.option(
    "--no-frames", is_flag=True, help="Do not copy the golden frames, for an edition where most of them are wrong."
)
def copy(old: str, new: str | None, date: str | None, no_frames: bool) -> None:
    """Copy an edition with its golden frames: start a new one, or edit one of the package.

    If OLD is a file or an edition in spec/, the copy is the edition NEW in the same folder. Edit it where the new manual
    differs. Then `canwright diff OLD NEW` shows the changes, and `canwright check` the golden frames that contradict them.

    If OLD is an edition of the package, as `canwright editions` lists them where there is no folder spec/, its files are
    copied unchanged to FOLDER, by default spec/FAMILY. Existing files are never overwritten.
    """
    try:
        source = Path(find(old, SPEC_FOLDER).document.name)
        if not source.is_file():
            stop(f"`{old}` is not in a folder; give a file or an edition")
        if source.is_relative_to(SPECS) and not Path(old).is_file():
            if date is not None:
                stop(f"--date is for a new edition; copy `{old}` first, then copy that to a new edition")
            folder = Path(new) if new is not None else SPEC_FOLDER / source.parent.name
            target = folder / source.name
            _write(source, target, lambda file: file.read_text("utf-8"), frames=not no_frames)
            print_text(f"Now run: canwright check --spec {target.as_posix()}\n", error=True)
            return
        target = _new_edition(source, new, date, frames=not no_frames)
        load(target)
        reference = target.as_posix() if Path(old).is_file() else target.stem
        print_text(
            f"Edit it where the new manual differs, including its title; then run: canwright diff {old} {reference}\n",
            error=True,
        )
    except SpecError as error:
        show_findings(error.diagnostics, "text")
        stop(f"`{old}` has errors; correct them first")
    except (UnknownEditionError, OSError) as error:
        stop(str(error))


def _new_edition(source: Path, new: str | None, date: str | None, *, frames: bool) -> Path:
    """Copies an edition under a new name to the same folder."""
    if new is None:
        stop(f"give the name of the new edition: canwright copy {source.stem} NEW")
    fits("edition", new)
    if Path(new).suffix in (".yaml", ".yml"):
        stop(f"`{new}` is a file name; give the name of the edition: {Path(new).stem}")
    if date is not None:
        fits("date", date)
    target = source.with_name(f"{new}.yaml")
    _write(source, target, lambda file: _renamed(file, new, date if file == source else None), frames=frames)
    return target


def _write(source: Path, target: Path, text_of: Callable[[Path], str], *, frames: bool) -> None:
    """Writes the copy of a spec, and of its golden frames unless `frames` is False."""
    copies = {target: text_of(source)}
    if frames and frames_file(source).is_file():
        copies[frames_file(target)] = text_of(frames_file(source))
    write_new_files(copies)


def fits(key: str, value: str) -> None:
    """Stops unless `value` is valid for `key`."""
    pattern = keys(EditionSpec)[key].limits.pattern
    if not re.fullmatch(str(pattern), value):
        stop(f"`{value}` is not a valid {key}; it must match {pattern}")


def _renamed(file: Path, edition: str, date: str | None) -> str:
    """The text of a file with another edition, and another date if one is given."""
    document, content = read_document(file)
    lines = content.decode("utf-8").split("\n")
    if date is not None and ("date",) in document:
        _put(lines, document, "date", date)
    _put(lines, document, "edition", edition)
    if date is not None and ("date",) not in document:
        lines.insert(document.position(("edition",)).line, f"date: {as_yaml(date)}")
    return "\n".join(lines)


def _put(lines: list[str], document: Document, key: str, value: str) -> None:
    at = document.position((key,))
    line = lines[at.line - 1]
    lines[at.line - 1] = line[: at.column - 1] + as_yaml(value) + line[at.column - 1 + at.length :]
