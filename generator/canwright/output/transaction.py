"""A change of many files that is made whole or not at all.

New files, and copies of those they replace, are staged in the output folder. The journal comes last: with it the change
is decided, and a run that is cut short after that is completed by the next one. What the file system refuses on the way
is undone.
"""

from __future__ import annotations

import itertools
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator

from .paths import (
    JOURNAL,
    MANIFEST,
    STAGING,
    Digest,
    OutputError,
    Record,
    content_of,
    digest,
    digest_of,
    edited,
    foreign,
    outside,
    record,
    refuse_in_the_way,
)


def _step_path(path: str) -> str:
    if path != MANIFEST and outside(path):
        raise ValueError(f"{path[:80]!r} is not a path inside the folder")
    return path


class Step(Record):
    """One file: what it was and what it becomes; None is no file."""

    old: Digest | None
    new: Digest | None


class Journal(Record):
    steps: dict[Annotated[str, AfterValidator(_step_path)], Step]


def stage(out: Path, files: Mapping[str, bytes | None]) -> None:
    """Decides the change to `files`, in their order; None removes one. `complete` carries it out."""
    steps = {}
    try:
        for path, data in files.items():
            there = content_of(out / path)
            if there is not None:
                _back_up(out, path)
            if data is not None:
                _save(_new(out, path), data)
            steps[path] = Step(old=None if there is None else digest(there), new=None if data is None else digest(data))
        journal = out / JOURNAL
        unfinished = journal.with_suffix(".tmp")
        _save(unfinished, Journal(steps=steps).json_bytes())
        unfinished.replace(journal)
    except BaseException:
        shutil.rmtree(out / STAGING, ignore_errors=True)
        raise


def complete(out: Path, *, force: bool) -> None:
    """Carries out a journal, if there is one; whatever else was staged was not decided and goes.

    Raises OutputError, with nothing changed, when a file was edited since, unless `force`. OSError leaves the old
    files, or at worst the journal for the next run.
    """
    refuse_in_the_way(out, JOURNAL)
    journal = record(
        out / JOURNAL,
        Journal,
        f"remove {(out / STAGING).as_posix()}, left by a run that was cut short, and run again",
    )
    if journal is not None:
        places = [(path, f"{STAGING}/new/{path}", f"{STAGING}/old/{path}") for path in journal.steps]
        refuse_in_the_way(out, *itertools.chain.from_iterable(places))
        left = [(path, step) for path, step in journal.steps.items() if _is_left(out, path, step, force)]
        try:
            for path, step in left:
                _do(out, path, step)
        except OSError:
            for path, step in reversed(journal.steps.items()):
                _undo(out, path, step)
            _clear(out)
            raise
    _clear(out)


def _is_left(out: Path, path: str, step: Step, force: bool) -> bool:
    """Whether a step has still to be done. One that was, and whose file was edited since, is left as it is."""
    there = digest_of(out / path)
    if there not in (None, step.old, step.new) and not force:
        raise foreign(out, path) if step.old is None else edited(out, path)
    is_staged = there == step.new or step.new is None or digest_of(_new(out, path)) == step.new
    if there in (None, step.old) and not is_staged:
        raise OutputError(
            f"{_new(out, path).as_posix()} is damaged: it is not what the run that was cut short had made; remove "
            f"{(out / STAGING).as_posix()} and run again"
        )
    return there != step.new and is_staged


def _do(out: Path, path: str, step: Step) -> None:
    file = out / path
    there = digest_of(file)
    if there is not None and digest_of(_old(out, path)) != there:
        _back_up(out, path)
    if step.new is None:
        file.unlink()
        _remove_empty(out, file.parent)
    else:
        file.parent.mkdir(parents=True, exist_ok=True)
        _new(out, path).replace(file)


def _undo(out: Path, path: str, step: Step) -> None:
    """Moves, for there may be no room to copy. At any moment the journal can still be carried out."""
    file, old, new = out / path, _old(out, path), _new(out, path)
    if digest_of(file) == step.new:
        if step.new is not None:
            file.replace(new)
        if old.is_file():
            file.parent.mkdir(parents=True, exist_ok=True)
            old.replace(file)
    _remove_empty(out, file.parent)


def _new(out: Path, path: str) -> Path:
    return out / STAGING / "new" / path


def _old(out: Path, path: str) -> Path:
    return out / STAGING / "old" / path


def _back_up(out: Path, path: str) -> None:
    old = _old(out, path)
    old.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(out / path, old)


def _save(file: Path, data: bytes) -> None:
    """Does not wait for the disk, which takes longer than all else: what was lost with the power shows by its digest."""
    file.parent.mkdir(parents=True, exist_ok=True)
    try:
        with file.open("wb") as stream:
            stream.write(data)
    except OSError as error:  # of a write, it does not tell which file
        raise OSError(error.errno, error.strerror, str(file)) from error


def _clear(out: Path) -> None:
    """The journal goes first: without it the rest is only rubbish."""
    (out / JOURNAL).unlink(missing_ok=True)
    if (out / STAGING).is_dir():
        shutil.rmtree(out / STAGING)


def _remove_empty(out: Path, folder: Path) -> None:
    """Up to `out`, as long as nothing is left in the folder."""
    while folder != out:
        try:
            folder.rmdir()
        except OSError:
            return
        folder = folder.parent
