"""What stands in an output folder, what is in the way there, and how that is told."""

from __future__ import annotations

import errno
import functools
import hashlib
import os
import re
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, StringConstraints, ValidationError

MANIFEST = ".canwright.json"
LOCK = ".canwright-lock"
STAGING = ".canwright-staging"
JOURNAL = f"{STAGING}/journal.json"

_MAX_RECORD = 64 * 1024 * 1024
"""Bytes of a manifest or journal: some hundred times what the largest known output needs."""

_INSIDE = re.compile(r"[^./\\:][^/\\:]*(?:/[^./\\:][^/\\:]*)*")

_HINTS = {
    **dict.fromkeys((errno.ENOSPC, errno.EDQUOT), "make room there and run again"),
    **dict.fromkeys(
        (errno.EACCES, errno.EPERM, errno.EROFS), "make it accessible to you, or choose another folder with --out"
    ),
    errno.EFBIG: "lift the limit of file sizes (ulimit -f) and run again",
    errno.ENAMETOOLONG: "choose a folder with a shorter path with --out",
}


class OutputError(Exception):
    """The output cannot be written as asked; says what is in the way and what to do."""


def outside(path: str) -> bool:
    """Whether a path leads out of the folder, is hidden in it, or is no plain path on some system."""
    return not path.isprintable() or not _INSIDE.fullmatch(path)


def _generated(path: str) -> str:
    if outside(path):
        raise ValueError(f"{path[:80]!r} is not a path inside the folder")
    return path


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError(f"{text[:80]!r} is not a name")
    return text


GeneratedPath = Annotated[str, AfterValidator(_generated)]
Digest = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
Name = Annotated[str, AfterValidator(_printable)]


class Record(BaseModel):
    """What canwright keeps in an output folder. A stranger may have written it."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    def json_bytes(self) -> bytes:
        return self.model_dump_json(indent=1).encode() + b"\n"


_R = TypeVar("_R", bound=Record)


def record(file: Path, kind: type[_R], remedy: str) -> _R | None:
    """The record in a file, or None where there is no file. Raises OutputError with the `remedy` where it is damaged."""
    if not file.exists():
        return None
    try:
        if not file.is_file():
            raise ValueError("it is not a file")
        if file.stat().st_size > _MAX_RECORD:
            raise ValueError(f"it is larger than {_MAX_RECORD} bytes")
        found: _R = _parsed(kind, file.read_bytes())
        return found
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        why = " ".join([*(repr(part)[:80] for part in first["loc"]), first["msg"]])
    except ValueError as error:
        why = str(error)
    raise OutputError(f"{file.as_posix()} is damaged: {why}; {remedy}")


@functools.lru_cache(maxsize=1)
def _parsed(kind: type[Record], data: bytes) -> Any:
    """Kept, for a run reads a manifest before it makes something and again before it writes."""
    return kind.model_validate_json(data)


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def content_of(file: Path) -> bytes | None:
    """None where there is no file."""
    try:
        if not stat.S_ISREG(file.stat().st_mode):
            return None
    except (FileNotFoundError, NotADirectoryError):
        return None
    with file.open("rb", buffering=0) as stream:
        return stream.read()


def digest_of(file: Path) -> str | None:
    """None where there is no file."""
    data = content_of(file)
    return None if data is None else digest(data)


def refuse_in_the_way(out: Path, *paths: str) -> None:
    """Raises OutputError where a file below `out` would go through a link, or cannot be for what stands there."""
    way = Way(out)
    for path in paths:
        way.refuse(path)


class Way:
    """What leads to the files below a folder; each folder on it is looked at once."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._passable: set[str] = set()

    def refuse(self, path: str) -> None:
        """Raises OutputError where a file would go through a link, or cannot be for what stands there."""
        self._go_through(path.rpartition("/")[0])
        _refuse_but(stat.S_ISREG, "file", self._out, path)

    def _go_through(self, folder: str) -> None:
        if folder not in self._passable:
            if folder:
                self._go_through(folder.rpartition("/")[0])
            _refuse_but(stat.S_ISDIR, "folder", self._out, folder)
            self._passable.add(folder)


def _refuse_but(is_wanted: Callable[[int], bool], wanted: str, out: Path, path: str) -> None:
    try:
        mode = os.lstat(f"{out}/{path}" if path else out).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    if stat.S_ISLNK(mode):
        remedy = "remove it, files are not written through links"
        if not path:
            remedy = "name the folder that it leads to with --out"
        raise OutputError(f"{(out / path).as_posix()} is a symbolic link; {remedy}")
    if not is_wanted(mode):
        raise OutputError(
            f"{(out / path).as_posix()} is not a {wanted}; move it away, a {wanted} of that name is generated"
        )


def edited(out: Path, path: str) -> OutputError:
    return OutputError(
        f"{(out / path).as_posix()} was edited by hand; move the edit into the spec, or drop it with --force"
    )


def foreign(out: Path, path: str) -> OutputError:
    return OutputError(
        f"{(out / path).as_posix()} is in the way and was not made by canwright; move it away, or "
        "overwrite it with --force"
    )


@contextmanager
def told(out: Path, doing: str) -> Iterator[None]:
    """What the file system refuses, as OutputError: what, where, what became of the output and what to do."""
    try:
        yield
    except OSError as error:
        named = error.filename2 or error.filename
        where = out.as_posix() if named is None else Path(str(named)).as_posix()
        hint = _HINTS.get(error.errno or 0, "mend that and run again, or choose another folder with --out")
        state = "the next run completes what was begun" if _begun(out) else "nothing was changed"
        raise OutputError(f"cannot {doing} {where}: {error.strerror or error}; {hint}; {state}") from error


def _begun(out: Path) -> bool:
    try:
        return (out / JOURNAL).exists()
    except OSError:
        return False
