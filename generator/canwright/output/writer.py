"""Writes the files of a run, or compares them with the output folder; removes files that are no longer generated.

A manifest in the output folder lists the generated files with their digests. Only those are replaced or removed, and
files that were edited since only if forced.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..diagnostics.unicode_safety import visible
from .lock import locked
from .manifest import Manifest, read_manifest
from .paths import (
    JOURNAL,
    LOCK,
    OutputError,
    conflict,
    content_of,
    digest,
    file_system_errors,
    is_interrupted,
    is_safe,
    refuse_obstacles,
)
from .transaction import complete, removed_files, stage

PATIENCE = 5.0
"""Seconds to wait for another run in the same folder; a run writes in less time."""


class Content(NamedTuple):
    """The output of a run: its editions, its targets, and every file by its path below the output folder.

    Each target has a folder of its name there; a target that is `alone` has the whole output folder.
    """

    editions: tuple[str, ...]
    targets: tuple[str, ...]
    files: Mapping[str, bytes]
    alone: bool = False

    def manifest_after(self, manifest: Manifest) -> Manifest:
        """The manifest of a folder after this content is written; other targets stay the same."""
        kept = {
            path: written
            for path, written in manifest.files.items()
            if not self.alone and path.partition("/")[0] not in self.targets
        }
        files = {**kept, **{path: digest(data) for path, data in self.files.items()}}
        editions = {**manifest.editions, **{target: list(self.editions) for target in self.targets}}
        return Manifest(editions=dict(sorted(editions.items())), files=dict(sorted(files.items())))


class FileChanges(NamedTuple):
    """The files of a folder that a run changes."""

    written: tuple[str, ...]
    removed: tuple[str, ...]
    unchanged: int


def write(out: Path, content: Content, *, force: bool = False, patience: float = PATIENCE) -> FileChanges:
    """Makes the files of `content.targets` below `out` exactly those of `content`.

    Raises OutputError, with nothing changed, when a file that canwright did not generate or that was edited by hand is
    in the way, or when an edition would be dropped, unless `force`; and even with `force`, when a link is in the way,
    a folder for one target alone has other files, another run is writing, or the file system rejects a step.
    """
    with file_system_errors(out, "write"):
        resolved = Path(os.path.realpath(out))
        if resolved == Path(resolved.anchor):
            raise OutputError(f"{out.as_posix()} is the root of the file system; choose another folder with --out")
        _refuse_unsafe(out, content)
        refuse_obstacles(out, LOCK)
        out.mkdir(parents=True, exist_ok=True)
        with locked(out, patience):
            complete(out, force=force)
            if content.alone:
                refuse_occupied(out, content.targets)
            old = read_manifest(out)
            new = content.manifest_after(old)
            changes = _changes(out, content, old, new)
            if not force:
                _refuse_dropped(out, content, old)
                _refuse_edited(out, old, changes)
            if changes.written or changes.removed or new != old:
                stage(out, {path: content.files[path] for path in changes.written}, new)
                complete(out, force=force)
            return changes


def difference(out: Path, content: Content) -> Iterator[str]:
    """The unified diff from the output folder to the generated content, by file; empty if they are the same.

    Writes nothing: an interrupted run is reported, not completed.
    """
    with file_system_errors(out, "read"):
        _refuse_unsafe(out, content)
        old = read_manifest(out)
        changes = _changes(out, content, old, content.manifest_after(old))
        if is_interrupted(out):
            yield f"Only in {out.as_posix()}: {JOURNAL}, left by an interrupted run\n"
        for path in sorted((*changes.written, *changes.removed)):
            present, wanted = content_of(out / path) or b"", content.files.get(path, b"")
            names = (f"{out.as_posix()}/{path}", f"{path} as generated")
            if b"\0" in wanted:
                yield f"Binary files {names[0]} and {names[1]} differ\n"
                continue
            old_lines, new_lines = (data.decode("utf-8", "replace").splitlines(True) for data in (present, wanted))
            lines = difflib.unified_diff(old_lines, new_lines, *names)
            yield "".join(line if line.endswith("\n") else line + "\n" for line in lines)


def refuse_occupied(out: Path, targets: Sequence[str]) -> None:
    """Raises OutputError if a folder has files other than those of an earlier run of exactly these targets."""
    with file_system_errors(out, "read"):
        present = sorted(file.name for file in out.iterdir() if file.name != LOCK) if out.is_dir() else []
        if not present or is_interrupted(out) or list(read_manifest(out).editions) == list(targets):
            return
    named = ", ".join(present[:3]) + (", …" if len(present) > 3 else "")
    raise OutputError(
        f"{out.as_posix()} contains files that no earlier run for {'/'.join(targets)} generated ({visible(named)}); "
        "choose a new or empty folder with --out, or move them away"
    )


def _changes(out: Path, content: Content, old: Manifest, new: Manifest) -> FileChanges:
    """The changes of a run. Raises OutputError if a link, or something other than a file, is in the way."""
    removed = removed_files(out, old, new)
    refuse_obstacles(out, *content.files, *removed)
    written = [path for path, data in content.files.items() if content_of(out / path) != data]
    return FileChanges(tuple(sorted(written)), tuple(sorted(removed)), len(content.files) - len(written))


def _refuse_unsafe(out: Path, content: Content) -> None:
    for path in content.files:
        if not is_safe(path):
            raise OutputError(
                f"{path!r} would be written outside {out.as_posix()}; change the name that the path is derived from"
            )


def _refuse_dropped(out: Path, content: Content, manifest: Manifest) -> None:
    for target in content.targets:
        dropped = [e for e in manifest.editions.get(target, ()) if e not in content.editions]
        if dropped:
            raise OutputError(
                f"{(out / target).as_posix()} also contains {', '.join(dropped)}, which this run would remove; "
                "name those specs too, choose another --out, or remove them with --force"
            )


def _refuse_edited(out: Path, manifest: Manifest, changes: FileChanges) -> None:
    for path in (*changes.written, *changes.removed):
        present = content_of(out / path)
        if present is not None and digest(present) != manifest.files.get(path):
            raise conflict(out, path, generated=path in manifest.files)
