"""All or nothing: compare with what is there, write, and remove what is no longer generated.

A manifest in the output folder lists the files that canwright generated, with their digests. Only those are ever replaced
or removed, and none that was edited since, unless forced.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

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
"""Seconds to wait for another run in the same folder; one writes in less than that."""


@dataclass(frozen=True)
class Content:
    """What a run generates: its editions, its targets, and every file by its path below the output folder.

    A target has a folder of its name there, or, `alone`, all of the output folder.
    """

    editions: tuple[str, ...]
    targets: tuple[str, ...]
    files: Mapping[str, bytes]
    alone: bool = False

    def manifest_after(self, manifest: Manifest) -> Manifest:
        """The manifest of a folder once this is there; other targets stay as they are."""
        kept = {
            path: digest
            for path, digest in manifest.files.items()
            if not self.alone and path.partition("/")[0] not in self.targets
        }
        files = {**kept, **{path: digest(data) for path, data in self.files.items()}}
        editions = {**manifest.editions, **{target: list(self.editions) for target in self.targets}}
        return Manifest(editions=dict(sorted(editions.items())), files=dict(sorted(files.items())))


@dataclass(frozen=True)
class Changes:
    """What a run changes, or has changed, in a folder."""

    written: tuple[str, ...]
    removed: tuple[str, ...]
    unchanged: int


def write(out: Path, content: Content, *, force: bool = False, patience: float = PATIENCE) -> Changes:
    """Makes the files of `content.targets` below `out` exactly those of `content`.

    Raises OutputError, with nothing changed, when a file that canwright did not generate or that was edited by hand is
    in the way, or when an edition would be dropped, unless `force`; and even with `force`, when a link is in the way,
    a folder for one target alone has other files, another run is writing, or the file system rejects a step.
    """
    with file_system_errors(out, "write"):
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
    """The unified diff from what is there to what would be generated, file by file; empty when they are the same.

    Writes nothing: an interrupted run is reported, not completed.
    """
    with file_system_errors(out, "read"):
        _refuse_unsafe(out, content)
        old = read_manifest(out)
        changes = _changes(out, content, old, content.manifest_after(old))
        if is_interrupted(out):
            yield f"Only in {out.as_posix()}: {JOURNAL}, of an interrupted run\n"
        for path in sorted((*changes.written, *changes.removed)):
            there = (content_of(out / path) or b"").decode("utf-8", "replace")
            wanted = content.files.get(path, b"").decode("utf-8")
            names = (f"{out.as_posix()}/{path}", f"{path} as generated")
            lines = difflib.unified_diff(there.splitlines(True), wanted.splitlines(True), *names)
            yield "".join(line if line.endswith("\n") else line + "\n" for line in lines)


def refuse_occupied(out: Path, targets: Sequence[str]) -> None:
    """Raises OutputError where a folder has files other than those of an earlier run of exactly these targets."""
    with file_system_errors(out, "read"):
        there = sorted(file.name for file in out.iterdir() if file.name != LOCK) if out.is_dir() else []
        if not there or is_interrupted(out) or list(read_manifest(out).editions) == list(targets):
            return
    named = ", ".join(there[:3]) + (", …" if len(there) > 3 else "")
    raise OutputError(
        f"{out.as_posix()} has files that are not of an earlier {'/'.join(targets)} ({visible(named)}); name a new or "
        "empty folder with --out, or move them away"
    )


def _changes(out: Path, content: Content, old: Manifest, new: Manifest) -> Changes:
    """Raises OutputError where a link, or something other than a file, is in the way."""
    removed = removed_files(out, old, new)
    refuse_obstacles(out, *content.files, *removed)
    written = [path for path, data in content.files.items() if content_of(out / path) != data]
    return Changes(tuple(sorted(written)), tuple(sorted(removed)), len(content.files) - len(written))


def _refuse_unsafe(out: Path, content: Content) -> None:
    for path in content.files:
        if not is_safe(path):
            raise OutputError(f"{path!r} would be written outside {out.as_posix()}; change the name that it comes from")


def _refuse_dropped(out: Path, content: Content, manifest: Manifest) -> None:
    for target in content.targets:
        dropped = [e for e in manifest.editions.get(target, ()) if e not in content.editions]
        if dropped:
            raise OutputError(
                f"{(out / target).as_posix()} also contains {', '.join(dropped)}, which this run would remove; "
                "name those specs too, choose another --out, or remove them with --force"
            )


def _refuse_edited(out: Path, manifest: Manifest, changes: Changes) -> None:
    for path in (*changes.written, *changes.removed):
        there = content_of(out / path)
        if there is not None and digest(there) != manifest.files.get(path):
            raise conflict(out, path, generated=path in manifest.files)
