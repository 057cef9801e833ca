"""Readers of logs: the formats of candump, and every format of python-can."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path

from ..model.layout import MAX_DATA_BYTES
from ..semantics.frame import CanFrame

_LENGTHS = "".join(map(str, range(MAX_DATA_BYTES + 1)))
_SHORT = re.compile(
    r"(?:\([\d.]+\)\s+)?(?:\S+\s+)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(?:#[0-9A-Fa-f])?"
    rf"(R[{_LENGTHS}]?|[0-9A-Fa-f]*)"
    r"(?:_[0-9A-Fa-f])?(?:\s+[RT])?"
)
_LONG = re.compile(
    r"(?:\([\d:. -]+\)\s+)?\S+\s+(?:[RT]X\s+\S+\s+\S+\s+)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[\d+\]"
    r"\s+(remote request|(?:[0-9A-Fa-f]{2}\s*)*)(?:'.*'|ERRORFRAME)?"
)
_COLOUR = re.compile(r"\x1b\[[\d;]*m")
_ERROR = 0x20000000
"""Set in the id of an error that the controller reports, which is not a frame."""
_BINARY = (".asc", ".blf", ".csv", ".db", ".mf4", ".trc")


class LogError(Exception):
    """A log that cannot be read; the message states where and what to do."""


def frames(file: Path) -> Iterator[CanFrame]:
    """The frames of a log in order. Raises LogError and OSError."""
    if file.suffix.lower() in _BINARY:
        yield from _by_python_can(file)
        return
    try:
        text = file.read_text("utf-8")
    except UnicodeDecodeError:
        raise LogError(f"{file} is not a text file; record it with `candump -l`, or as {', '.join(_BINARY)}") from None
    for number, line in enumerate(text.splitlines(keepends=True), start=1):
        written = _COLOUR.sub("", line).strip()
        if not written or line.startswith(("#", ";", "\t")):
            continue
        frame = _parsed(written)
        if frame is not None and not frame.id & _ERROR:
            yield frame
        elif frame is None and line.endswith("\n"):  # an interrupted recording ends within a line
            raise LogError(
                f"{file}:{number}: expected a frame of candump, `141#9A00000000000000`; found `{written[:60]}`"
            )


def _parsed(line: str) -> CanFrame | None:
    found = _SHORT.fullmatch(line) or _LONG.fullmatch(line)
    if found is None:
        return None
    id_, data = found.groups()
    remote = data.startswith(("R", "r"))
    digits = "" if remote else "".join(data.split())
    return None if len(digits) % 2 else CanFrame(int(id_, 16), bytes.fromhex(digits), len(id_) == 8, remote)


def _by_python_can(file: Path) -> Iterator[CanFrame]:
    if importlib.util.find_spec("can") is None:
        raise LogError(f"to read {file.suffix} files, run: pip install python-can; or record the log with `candump -l`")
    import can

    try:
        with can.LogReader(str(file)) as reader:
            for message in reader:
                if not message.is_error_frame:
                    yield CanFrame(
                        message.arbitration_id, bytes(message.data), message.is_extended_id, message.is_remote_frame
                    )
    except OSError:
        raise
    except Exception as error:  # each reader has its own exceptions
        raise LogError(f"{file} cannot be read as {file.suffix}: {error}") from None
