"""Files and folders that appear complete or not at all, and never replace what is read."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path


def is_overwritten(read: os.stat_result, path: Path) -> bool:
    """Whether writing to a path replaces the file that is read, under whatever name."""
    try:
        return os.path.samestat(read, path.stat())
    except OSError:
        return False


def same_path(paths: Sequence[Path]) -> Path | None:
    """A path that is among others twice, whatever the spelling; None if all differ."""
    resolved = [os.path.realpath(path) for path in paths]
    return next((path for i, path in enumerate(paths) if resolved[i] in resolved[:i]), None)


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[Path]:
    """A file to write to, which replaces `path` at the end; after an error, `path` is as before. Raises OSError."""
    if path.exists() and not path.is_file():  # a device, such as /dev/null
        yield path
        return
    with _beside(path) as folder:
        part = folder / path.name
        yield part
        part.replace(path)


@contextlib.contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """A folder to write to, which becomes `path` at the end. Raises OSError, also if `path` has files."""
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise FileExistsError(errno.EEXIST, "is not empty; choose a new folder", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    with _beside(path) as folder:
        part = folder / path.name
        part.mkdir()
        yield part
        if path.exists():
            path.rmdir()
        part.replace(path)


@contextlib.contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """A new folder beside a path, removed at the end."""
    folder = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
