"""One run at a time in an output folder."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .paths import LOCK, OutputError

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

_FLAGS = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_TEMPORARY", 0)
_PAUSE = 0.05


@contextmanager
def locked(out: Path, patience: float) -> Iterator[None]:
    """Holds the lock of a folder. Raises OutputError when another run still has it after `patience` seconds.

    The system's own lock on a file decides, for it ends with the process however that ends. Where there is none,
    having made the file decides; Windows removes that one with the process, elsewhere a person has to.
    """
    file = out / LOCK
    deadline = time.monotonic() + patience
    while (lock := _take(file)) is None:
        if time.monotonic() >= deadline:
            raise OutputError(
                f"another run{_process(file)} is writing to {out.as_posix()}; wait until it ends and run again, or "
                f"remove {file.as_posix()} if there is no such process"
            )
        time.sleep(_PAUSE)
    try:
        yield
    finally:
        with suppress(OSError):
            file.unlink()
        os.close(lock)


def _take(file: Path) -> int | None:
    """The descriptor of the locked file, or None when it is another's."""
    try:
        lock, made = os.open(file, _FLAGS | os.O_CREAT | os.O_EXCL, 0o666), True
    except FileExistsError:
        if fcntl is None:
            return None
        try:
            lock, made = os.open(file, _FLAGS), False
        except FileNotFoundError:
            return None
    if not _own(lock, made) or not _same(lock, file):
        os.close(lock)
        return None
    with suppress(OSError):  # it is only to be told
        os.truncate(lock, 0)
        os.write(lock, str(os.getpid()).encode())
    return lock


def _own(lock: int, made: bool) -> bool:
    if fcntl is None:
        return made
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return made
    return True


def _same(lock: int, file: Path) -> bool:
    """Whether the file is still the one that was opened: a run that ended has removed its own."""
    try:
        return os.path.samestat(os.fstat(lock), file.stat())
    except FileNotFoundError:
        return False


def _process(file: Path) -> str:
    try:
        text = file.read_bytes()[:20]
    except OSError:
        return ""
    return f" (process {int(text)})" if text.isdigit() else ""
