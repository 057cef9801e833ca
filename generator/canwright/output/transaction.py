"""A change of many files that is made completely or not at all.

New files are staged in the output folder. The journal, which is the new manifest, is written last and decides the
change. The next run completes a run that was interrupted after that. If the file system rejects a step, all steps are
undone.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

from .manifest import Manifest, damaged, read_manifest
from .paths import JOURNAL, MANIFEST, STAGING, conflict, digest_of, is_interrupted, refuse_obstacles

_NEW = f"{STAGING}/new"
_OLD = f"{STAGING}/old"


def removed_files(out: Path, old: Manifest, new: Manifest) -> list[str]:
    """Files that are no longer generated. A link in place of one was made by the user."""
    obsolete = [path for path in old.files if path not in new.files]
    return [path for path in obsolete if (out / path).is_file() and not (out / path).is_symlink()]


def stage(out: Path, files: Mapping[str, bytes], manifest: Manifest) -> None:
    """Decides to write `files` and to remove those that are not in the new manifest. `complete` carries it out."""
    try:
        for folder in (STAGING, *sorted({f"{_NEW}/{path}".rpartition("/")[0] for path in files})):
            (out / folder).mkdir(parents=True, exist_ok=True)
        for path, data in files.items():
            _save(out / f"{_NEW}/{path}", data)
        journal = out / JOURNAL
        unfinished = journal.with_suffix(".tmp")
        _save(unfinished, manifest.json_bytes())
        unfinished.replace(journal)
    except BaseException:
        shutil.rmtree(out / STAGING, ignore_errors=True)
        raise


def complete(out: Path, *, force: bool) -> None:
    """Carries out a decided change, if there is one, and removes the staged files.

    Raises OutputError, with nothing changed, where a file was edited since, unless `force`. After an OSError the old
    files are back; where that is impossible too, the journal remains for the next run.
    """
    refuse_obstacles(out, JOURNAL)
    if is_interrupted(out):
        old, new = read_manifest(out), read_manifest(out, JOURNAL)
        refuse_obstacles(out, *(f"{folder}/{path}" for path in new.files for folder in (_NEW, _OLD)))
        written = [path for path in new.files if _is_pending(out, path, old, new, force=force)]
        removed = removed_files(out, old, new)
        refuse_obstacles(out, *written, *removed)
        for path in removed:
            if digest_of(out / path) != old.files[path] and not force:
                raise conflict(out, path, generated=True)
        try:
            for path in written:
                _keep(out / path, out / f"{_OLD}/{path}")
                _move(out / f"{_NEW}/{path}", out / path)
            for path in removed:
                _move(out / path, out / f"{_OLD}/{path}")
                _remove_empty(out, (out / path).parent)
            (out / JOURNAL).replace(out / MANIFEST)
        except OSError:
            _undo(out, old, new)
            _clear(out)
            raise
    _clear(out)


def _is_pending(out: Path, path: str, old: Manifest, new: Manifest, *, force: bool) -> bool:
    """Whether a staged file has not been moved to its path yet."""
    staged = digest_of(f"{out}/{_NEW}/{path}")
    before, after = old.files.get(path), new.files[path]
    if staged is None and before == after:
        return False
    present = digest_of(f"{out}/{path}")
    if present not in (None, before, after) and not force:
        raise conflict(out, path, generated=before is not None)
    if staged != after and (staged is not None or present in (None, before)):
        raise damaged(out, f"{_NEW}/{path}", "it is not the file that was staged")
    return staged is not None


def _undo(out: Path, old: Manifest, new: Manifest) -> None:
    """Moves the old files back, since there may be no space to copy. The journal can be completed at any moment."""
    for path in {**old.files, **new.files}:
        file, new_file, old_file = out / path, out / f"{_NEW}/{path}", out / f"{_OLD}/{path}"
        if old_file.is_file() or old.files.get(path) != new.files.get(path):
            if path in new.files and not new_file.exists():
                _move(file, new_file)
            _move(old_file, file)
            _remove_empty(out, file.parent)


def _move(file: Path, to: Path) -> None:
    """Moves a file; does nothing without one."""
    if file.is_file():
        _make_folder(to.parent)
        file.replace(to)


def _keep(file: Path, to: Path) -> None:
    """Gives a file a second name, so that it is never absent; moves it where the file system has no hard links."""
    if file.is_file() and not to.exists():
        _make_folder(to.parent)
        try:
            os.link(file, to)
        except OSError:
            file.replace(to)


def _save(file: Path, data: bytes) -> None:
    """Writes without waiting for the disk, for speed; the digest reveals files that a power cut destroyed."""
    try:
        file.write_bytes(data)
    except OSError as error:  # the error of a write does not name the file
        raise OSError(error.errno, error.strerror, str(file)) from error


def _make_folder(folder: Path) -> None:
    if not folder.is_dir():
        folder.mkdir(parents=True)


def _clear(out: Path) -> None:
    """Removes the staged files, the journal first: without it the others are ignored."""
    (out / JOURNAL).unlink(missing_ok=True)
    if (out / STAGING).is_dir():
        shutil.rmtree(out / STAGING)


def _remove_empty(out: Path, folder: Path) -> None:
    """Removes a folder and its parents below `out` if they are empty."""
    while folder != out:
        try:
            folder.rmdir()
        except OSError:
            return
        folder = folder.parent
