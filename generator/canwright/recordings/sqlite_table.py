"""The table `messages` of a database of SQLite, as python-can writes it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .log_frame import Counts, LogError, LogFrame, SkippedPart, log_frame, nanoseconds

MAGIC = b"SQLite format 3\0"
_SELECTED = "SELECT ts, arbitration_id, extended, remote, error, data FROM messages"


def read(source: BinaryIO, counts: Counts) -> Iterator[LogFrame]:
    """The frames of a database in a file with a name. Raises LogError."""
    import sqlite3

    name = getattr(source, "name", None)
    if not isinstance(name, str) or not Path(name).is_file():
        raise LogError("a database cannot be read from a stream; give the name of the file")
    try:
        with contextlib.closing(sqlite3.connect(f"{Path(name).resolve().as_uri()}?mode=ro", uri=True)) as database:
            if not database.execute(
                "SELECT 1 FROM sqlite_master WHERE name = 'messages' AND type = 'table'"
            ).fetchone():
                raise LogError("this database has no table `messages`, so python-can did not write it")
            for row in database.execute(_SELECTED):
                recorded = _frame(*row)
                if isinstance(recorded, LogFrame):
                    yield recorded
                else:
                    counts.skip(recorded)
    except (sqlite3.Error, OverflowError) as error:
        counts.skip(SkippedPart.TRUNCATED, 0, str(error))


def _frame(
    time: object, id_: object, extended: object, remote: object, error: object, data: object
) -> LogFrame | SkippedPart:
    if error:
        return SkippedPart.ERROR
    content = b"" if remote or data is None else data
    if not (
        isinstance(id_, int) and isinstance(content, bytes) and isinstance(time, (int, float)) and abs(time) < 1e18
    ):
        return SkippedPart.MALFORMED
    return log_frame(nanoseconds(time), "", id_, content, None, extended=bool(extended), remote=bool(remote))
