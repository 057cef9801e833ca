"""All or nothing: compare with what is there, write, and remove what is no longer generated.

A manifest in the output folder says which files canwright made and what was in them. Only those are ever replaced or
removed, and none that was edited since, unless forced. New files are staged first; a journal then makes the change
final, and a run that was cut short after that is completed by the next one.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

MANIFEST = ".canwright.json"
STAGING = ".canwright-staging"
_JOURNAL = "journal.json"
_NEW = "new"


class OutputError(Exception):
    """The output cannot be written as asked; says what is in the way and what to do."""


@dataclass(frozen=True)
class Content:
    """What a run makes: its editions, its targets, and every file by its path below the output folder."""

    editions: tuple[str, ...]
    targets: tuple[str, ...]
    files: Mapping[str, bytes]


@dataclass(frozen=True)
class Changes:
    """What writing does, or did, to the files of a folder."""

    written: tuple[str, ...]
    removed: tuple[str, ...]
    unchanged: int


@dataclass(frozen=True)
class _Manifest:
    """What earlier runs made: hash by path, and the editions of each target."""

    files: Mapping[str, str]
    editions: Mapping[str, Sequence[str]]

    @classmethod
    def read(cls, out: Path) -> _Manifest:
        file = out / MANIFEST
        if not file.exists():
            return cls({}, {})
        try:
            data = json.loads(file.read_text("utf-8"))
            return cls(dict(data["files"]), dict(data["editions"]))
        except (ValueError, KeyError, TypeError):
            raise OutputError(
                f"{file.as_posix()} is damaged, so there is no telling which files are generated; restore it "
                "from version control, or generate into an empty folder"
            ) from None

    def after(self, content: Content) -> _Manifest:
        """The manifest once `content` is there; other targets stay as they are."""
        kept = {path: digest for path, digest in self.files.items() if _target(path) not in content.targets}
        files = {**kept, **{path: _digest(data) for path, data in content.files.items()}}
        editions = {**self.editions, **{target: list(content.editions) for target in content.targets}}
        return _Manifest(files, editions)

    def text(self) -> str:
        return json.dumps({"editions": self.editions, "files": self.files}, indent=1, sort_keys=True) + "\n"


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _target(path: str) -> str:
    return PurePosixPath(path).parts[0]


def write(out: Path, content: Content, *, force: bool = False) -> Changes:
    """Makes the files of `content.targets` below `out` exactly those of `content`.

    Raises OutputError, with nothing changed, when a file that canwright did not make or that was edited by hand is in
    the way, or when an edition would be dropped, unless `force`; and when a link leads out of the folder. OSError from
    the file system leaves the old output whole.
    """
    out.mkdir(parents=True, exist_ok=True)
    _complete(out)
    manifest = _Manifest.read(out)
    changes = _changes(out, content, manifest)
    for path in (*content.files, *changes.removed):
        _refuse_links(out, path)
    if not force:
        _refuse_dropped(out, content, manifest)
        _refuse_edited(out, content, manifest, changes)
    after = manifest.after(content).text()
    if changes.written or changes.removed or after != manifest.text():
        _stage(out, {path: content.files[path] for path in changes.written}, changes.removed, after)
        _complete(out)
    return changes


def difference(out: Path, content: Content) -> Iterator[str]:
    """The unified diff from what is there to what would be generated, file by file; nothing when they are the same."""
    _complete(out)
    changes = _changes(out, content, _Manifest.read(out))
    for path in sorted((*changes.written, *changes.removed)):
        there = (out / path).read_bytes().decode("utf-8", "replace") if (out / path).is_file() else ""
        wanted = content.files.get(path, b"").decode("utf-8")
        names = (f"{out.as_posix()}/{path}", f"{path} as generated")
        lines = difflib.unified_diff(there.splitlines(True), wanted.splitlines(True), *names)
        yield "".join(line if line.endswith("\n") else line + "\n" for line in lines)


def _changes(out: Path, content: Content, manifest: _Manifest) -> Changes:
    written = [path for path, data in content.files.items() if _read(out / path) != data]
    removed = [
        path
        for path in manifest.files
        if _target(path) in content.targets and path not in content.files and (out / path).exists()
    ]
    return Changes(tuple(sorted(written)), tuple(sorted(removed)), len(content.files) - len(written))


def _read(file: Path) -> bytes | None:
    return file.read_bytes() if file.is_file() else None


def _refuse_links(out: Path, path: str) -> None:
    pure = PurePosixPath(path)
    if pure.is_absolute() or ".." in pure.parts:
        raise OutputError(f"`{path}` would be written outside {out.as_posix()}")
    for part in (pure, *pure.parents):
        if (out / part).is_symlink() and part != PurePosixPath("."):
            raise OutputError(
                f"{(out / part).as_posix()} is a symbolic link; remove it, files are not written through links"
            )


def _refuse_dropped(out: Path, content: Content, manifest: _Manifest) -> None:
    for target in content.targets:
        dropped = [e for e in manifest.editions.get(target, ()) if e not in content.editions]
        if dropped:
            raise OutputError(
                f"{(out / target).as_posix()} also holds {', '.join(dropped)}, which this run would remove; "
                "name those specs too, choose another --out, or remove them with --force"
            )


def _refuse_edited(out: Path, content: Content, manifest: _Manifest, changes: Changes) -> None:
    for path in (*changes.written, *changes.removed):
        there = _read(out / path)
        if there is None and not (out / path).exists():
            continue
        if there is None:
            raise OutputError(
                f"{(out / path).as_posix()} is not a file; move it away, a file of that name is generated"
            )
        if path not in manifest.files:
            raise OutputError(
                f"{(out / path).as_posix()} is in the way and was not made by canwright; move it away, or "
                "overwrite it with --force"
            )
        if _digest(there) != manifest.files[path]:
            raise OutputError(
                f"{(out / path).as_posix()} was edited by hand; move the edit into the spec, or drop it with --force"
            )


def _stage(out: Path, files: Mapping[str, bytes], removed: Sequence[str], manifest: str) -> None:
    """Writes everything beside its place; the journal comes last and makes it final."""
    staging = out / STAGING
    shutil.rmtree(staging, ignore_errors=True)
    try:
        for path, data in {**files, MANIFEST: manifest.encode()}.items():
            file = staging / _NEW / path
            file.parent.mkdir(parents=True, exist_ok=True)
            with file.open("wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
        journal = staging / (_JOURNAL + ".tmp")
        journal.write_text(json.dumps({"write": [*files, MANIFEST], "remove": list(removed)}), "utf-8")
        journal.replace(staging / _JOURNAL)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        raise


def _complete(out: Path) -> None:
    """Carries out a journal, if there is one; whatever else was staged was not final and goes."""
    staging = out / STAGING
    journal = staging / _JOURNAL
    if journal.is_file():
        steps = json.loads(journal.read_text("utf-8"))
        for path in steps["write"]:
            staged = staging / _NEW / path
            if staged.is_file():
                (out / path).parent.mkdir(parents=True, exist_ok=True)
                staged.replace(out / path)
        for path in steps["remove"]:
            (out / path).unlink(missing_ok=True)
            _remove_empty(out, (out / path).parent)
    if staging.is_dir():
        shutil.rmtree(staging)


def _remove_empty(out: Path, folder: Path) -> None:
    while folder != out and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent
