"""Recorded frames: what candump writes, and every format that python-can reads."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path

from .interpret import CanFrame

_SHORT = re.compile(
    r"(?:\([\d.]+\)\s+)?(?:\S+\s+)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R|[0-9A-Fa-f]{0,16})(?:\s+[RT])?\s*"
)
_LONG = re.compile(
    r"(?:\([\d:. -]+\)\s+)?\S+\s+(?:[RT]X\s+\S+\s+\S+\s+)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[(\d)\]"
    r"\s+(remote request|(?:[0-9A-Fa-f]{2}\s*)*)(?:'.*')?\s*"
)
_BINARY = (".asc", ".blf", ".csv", ".db", ".mf4", ".trc")


class LogError(Exception):
    """A log that cannot be read; the message says where and what to do."""


def frames(file: Path) -> Iterator[CanFrame]:
    """The frames of a log in order. Raises LogError and OSError."""
    if file.suffix.lower() in _BINARY:
        yield from _by_python_can(file)
        return
    try:
        lines = file.read_text("utf-8").splitlines()
    except UnicodeDecodeError:
        raise LogError(f"{file} is no text; write it with `candump -l`, or as {', '.join(_BINARY)}") from None
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.startswith(("#", ";")):
            yield _parsed(file, number, line.strip())


def _parsed(file: Path, number: int, line: str) -> CanFrame:
    short, long = _SHORT.fullmatch(line), _LONG.fullmatch(line)
    if short:
        id_, data = short.groups()
        remote = data == "R"
    elif long:
        id_, _, data = long.groups()
        remote = data.startswith("remote")
    else:
        raise LogError(
            f"{file}:{number}: expected a frame as candump writes it, `141#9A00000000000000`; found `{line[:60]}`"
        )
    digits = "" if remote else "".join(data.split())
    if len(digits) % 2:
        raise LogError(f"{file}:{number}: the data has half a byte, `{digits}`; write pairs of hex digits")
    return CanFrame(int(id_, 16), bytes.fromhex(digits), len(id_) == 8, remote)


def _by_python_can(file: Path) -> Iterator[CanFrame]:
    if importlib.util.find_spec("can") is None:
        raise LogError(
            f"to read {file.suffix} files, run: pip install 'canwright[log]'; or write the log with `candump -l`"
        )
    import can

    try:
        with can.LogReader(str(file)) as reader:
            for message in reader:
                yield CanFrame(
                    message.arbitration_id, bytes(message.data), message.is_extended_id, message.is_remote_frame
                )
    except OSError:
        raise
    except Exception as error:  # each of the readers raises its own
        raise LogError(f"{file} cannot be read as {file.suffix}: {error}") from None
