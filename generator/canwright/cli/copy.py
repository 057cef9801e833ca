"""`copy`."""

from __future__ import annotations

import re
from pathlib import Path

import click

from ..diagnostics.diagnostic import SpecError
from ..document.document import Document, read_document
from ..language.edition import EditionSpec, keys
from ..project.loader import frames_file, load
from ..project.references import UnknownEditionError, find
from .common import SPEC_FOLDER, show_findings, stop
from .terminal import print_text


@click.command()
@click.argument("old")
@click.argument("new")
@click.option("--date", help="Date of the new manual: 2023-03 or 2023-03-21.")
@click.option(
    "--no-frames", is_flag=True, help="Do not copy the golden frames, for an edition where most of them are wrong."
)
def copy(old: str, new: str, date: str | None, no_frames: bool) -> None:
    """Start the edition NEW as a copy of OLD, with its golden frames.

    OLD is a file or an edition in spec/; the copy is written to the same folder. Edit it where the new manual differs.
    Then `canwright diff OLD NEW` shows the changes, and `canwright check` the golden frames that contradict them.
    """
    _fits("edition", new)
    if Path(new).suffix in (".yaml", ".yml"):
        stop(f"`{new}` is a file name; give the name of the edition: {Path(new).stem}")
    if date is not None:
        _fits("date", date)
    try:
        source = Path(find(old, SPEC_FOLDER).document.name)
        if not source.is_file():
            stop(f"`{old}` is not in a folder; give a file or an edition")
        target = source.with_name(f"{new}.yaml")
        copies = {target: _renamed(source, new, date)}
        if frames_file(source).is_file() and not no_frames:
            copies[frames_file(target)] = _renamed(frames_file(source), new, None)
        for file in copies:
            if file.exists():
                stop(f"{file.as_posix()} exists already; nothing was written, choose another name or remove it")
        for file, text in copies.items():
            file.write_text(text, "utf-8")
            print_text(f"wrote {file.as_posix()}\n")
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


def _fits(key: str, value: str) -> None:
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
        lines.insert(document.position(("edition",)).line, f"date: {date}")
    return "\n".join(lines)


def _put(lines: list[str], document: Document, key: str, value: str) -> None:
    at = document.position((key,))
    line = lines[at.line - 1]
    lines[at.line - 1] = line[: at.column - 1] + value + line[at.column - 1 + at.length :]
