"""All or nothing: compare with what is there, write, and remove what is no longer generated.

A manifest in the output folder says which files canwright made and what was in them. Only those are ever replaced or
removed, and none that was edited since, unless forced.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from ..diagnostics.unicode_safety import visible
from .lock import locked
from .paths import (
    JOURNAL,
    LOCK,
    MANIFEST,
    Digest,
    GeneratedPath,
    Name,
    OutputError,
    Record,
    Way,
    content_of,
    digest,
    edited,
    foreign,
    outside,
    record,
    refuse_in_the_way,
    told,
)
from .transaction import complete, stage

PATIENCE = 5.0
"""Seconds to wait for another run in the same folder; one writes in less than that."""


@dataclass(frozen=True)
class Content:
    """What a run makes: its editions, its targets, and every file by its path below the output folder.

    A target has a folder of its name there, or, `alone`, all of the output folder. Files that stand there already may be
    in `standing`, by their digests, instead.
    """

    editions: tuple[str, ...]
    targets: tuple[str, ...]
    files: Mapping[str, bytes]
    alone: bool = False
    standing: Mapping[str, str] = field(default_factory=dict)

    def __contains__(self, path: str) -> bool:
        return path in self.files or path in self.standing

    def replaces(self, path: str) -> bool:
        """Whether a file of an earlier run goes when it is not made again."""
        return self.alone or path.partition("/")[0] in self.targets


@dataclass(frozen=True)
class Changes:
    """What writing does, or did, to the files of a folder."""

    written: tuple[str, ...]
    removed: tuple[str, ...]
    unchanged: int


class _Manifest(Record):
    """What earlier runs made: hash by path, and the editions of each target."""

    editions: dict[Name, list[Name]]
    files: dict[GeneratedPath, Digest]

    @classmethod
    def read(cls, out: Path) -> _Manifest:
        refuse_in_the_way(out, MANIFEST)
        remedy = "restore it from version control, or generate into an empty folder"
        return record(out / MANIFEST, cls, remedy) or cls(editions={}, files={})

    def after(self, content: Content) -> _Manifest:
        """The manifest once `content` is there; other targets stay as they are."""
        kept = {path: hashed for path, hashed in self.files.items() if not content.replaces(path)}
        files = {**kept, **content.standing, **{path: digest(data) for path, data in content.files.items()}}
        editions = {**self.editions, **{target: list(content.editions) for target in content.targets}}
        return _Manifest(editions=dict(sorted(editions.items())), files=dict(sorted(files.items())))


class Held:
    """What earlier runs made in a folder: digests by path."""

    def __init__(self, out: Path, files: Mapping[str, str]) -> None:
        self.files = files
        self._out = out
        self._way = Way(out)

    def standing(self, path: str, data: bytes) -> str | None:
        """The digest of `data` where an earlier run made just that, it is still there, and no link leads to it."""
        hashed = self.files.get(path)
        if hashed == digest(data):
            with suppress(OSError, OutputError):
                self._way.refuse(path)
                return hashed if (self._out / path).read_bytes() == data else None
        return None


def held(out: Path) -> Held:
    """What is known of a folder before something is made for it. Raises OutputError when that cannot be told.

    What a run that was cut short has left will be completed first, so nothing is known then.
    """
    with told(out, "read"):
        return Held(out, {} if (out / JOURNAL).exists() else _Manifest.read(out).files)


def write(out: Path, content: Content, *, force: bool = False, patience: float = PATIENCE) -> Changes:
    """Makes the files of `content.targets` below `out` exactly those of `content`.

    Raises OutputError, with nothing changed, when a file that canwright did not make or that was edited by hand is in
    the way, or when an edition would be dropped, unless `force`; and whatever `force` says, when a link is in the way,
    a folder that has to be the target's alone is occupied, another run is at work or has changed what was standing, or
    the file system refuses.
    """
    with told(out, "write"):
        _refuse_outside(out, content)
        refuse_in_the_way(out, MANIFEST, LOCK)
        out.mkdir(parents=True, exist_ok=True)
        with locked(out, patience):
            complete(out, force=force)
            if content.alone:
                refuse_occupied(out, content.targets)
            manifest = _Manifest.read(out)
            _refuse_overtaken(out, content, manifest)
            changes = _changes(out, content, manifest)
            if not force:
                _refuse_dropped(out, content, manifest)
                _refuse_edited(out, manifest, changes)
            after = manifest.after(content).json_bytes()
            if changes.written or changes.removed or after != content_of(out / MANIFEST):
                files = {path: content.files[path] for path in changes.written}
                stage(out, {**dict.fromkeys(changes.removed), **files, MANIFEST: after})
                complete(out, force=force)
            return changes


def difference(out: Path, content: Content) -> Iterator[str]:
    """The unified diff from what is there to what would be generated, file by file; nothing when they are the same.

    Writes nothing: what a run that was cut short has left is told, not completed.
    """
    with told(out, "read"):
        _refuse_outside(out, content)
        changes = _changes(out, content, _Manifest.read(out))
        if (out / JOURNAL).exists():
            yield f"Only in {out.as_posix()}: {JOURNAL}, of a run that was cut short\n"
        for path in sorted((*changes.written, *changes.removed)):
            there = (content_of(out / path) or b"").decode("utf-8", "replace")
            wanted = content.files.get(path, b"").decode("utf-8")
            names = (f"{out.as_posix()}/{path}", f"{path} as generated")
            lines = difflib.unified_diff(there.splitlines(True), wanted.splitlines(True), *names)
            yield "".join(line if line.endswith("\n") else line + "\n" for line in lines)


def refuse_occupied(out: Path, targets: Sequence[str]) -> None:
    """Raises OutputError where a folder has files, and they are not of an earlier run of just these targets."""
    with told(out, "read"):
        refuse_in_the_way(out, MANIFEST)
        there = sorted(file.name for file in out.iterdir() if file.name != LOCK) if out.is_dir() else []
        begun = (out / JOURNAL).exists()
        if not there or begun or list(_Manifest.read(out).editions) == list(targets):
            return
    named = ", ".join(there[:3]) + (", …" if len(there) > 3 else "")
    raise OutputError(
        f"{out.as_posix()} has files that are not of an earlier {'/'.join(targets)} ({visible(named)}); name a new or "
        "empty folder with --out, or move them away"
    )


def _changes(out: Path, content: Content, manifest: _Manifest) -> Changes:
    """Raises OutputError where a link, or what is no file, is in the way."""
    removed = [
        path
        for path in manifest.files
        if content.replaces(path) and path not in content and (out / path).is_file() and not (out / path).is_symlink()
    ]
    refuse_in_the_way(out, *content.files, *removed)
    written = [path for path, data in content.files.items() if content_of(out / path) != data]
    unchanged = len(content.files) + len(content.standing) - len(written)
    return Changes(tuple(sorted(written)), tuple(sorted(removed)), unchanged)


def _refuse_outside(out: Path, content: Content) -> None:
    for path in content.files:
        if outside(path):
            raise OutputError(f"{path!r} would be written outside {out.as_posix()}; change the name that it comes from")


def _refuse_overtaken(out: Path, content: Content, manifest: _Manifest) -> None:
    if any(manifest.files.get(path) != hashed for path, hashed in content.standing.items()):
        raise OutputError(f"{out.as_posix()} was changed while this run was at work; run again")


def _refuse_dropped(out: Path, content: Content, manifest: _Manifest) -> None:
    for target in content.targets:
        dropped = [e for e in manifest.editions.get(target, ()) if e not in content.editions]
        if dropped:
            raise OutputError(
                f"{(out / target).as_posix()} also holds {', '.join(dropped)}, which this run would remove; "
                "name those specs too, choose another --out, or remove them with --force"
            )


def _refuse_edited(out: Path, manifest: _Manifest, changes: Changes) -> None:
    for path in (*changes.written, *changes.removed):
        there = content_of(out / path)
        if there is None:
            continue
        if path not in manifest.files:
            raise foreign(out, path)
        if digest(there) != manifest.files[path]:
            raise edited(out, path)
