"""One run at a time in an output folder."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .paths import LOCK, OutputError, content_of


@contextmanager
def locked(out: Path, patience: float) -> Iterator[None]:
    """Locks a folder. Raises OutputError when another run still has the lock after `patience` seconds.

    The lock ends with its process, however that ends. A lock file has no content: some versions of filelock empty it.
    """
    from filelock import FileLock, Timeout  # 70 ms, which other commands need not spend

    file = out / LOCK
    if content_of(file):
        raise OutputError(f"{file.as_posix()} is not a lock of canwright, it has content; move it away and run again")
    if file.exists() and file.stat().st_nlink > 1:
        raise OutputError(f"{file.as_posix()} is a hard link to another file; remove it and run again")
    lock = FileLock(file, timeout=patience)
    try:
        lock.acquire()
    except Timeout:
        raise OutputError(f"another run is writing to {out.as_posix()}; wait until it ends and run again") from None
    try:
        yield
    finally:
        with suppress(OSError):  # an open file cannot be removed on Windows, where releasing removes it
            file.unlink()
        lock.release()
