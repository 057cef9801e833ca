"""The binary formats, which python-can reads: BLF and MF4."""

from __future__ import annotations

import contextlib
import gc
import logging
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, BinaryIO, cast

from .log_frame import Counts, LogFrame, Mark, SkippedPart, log_frame, nanoseconds
from .packages import require

if TYPE_CHECKING:
    import can
    from can.io.generic import MessageReader

_FIRST_BUS = {"blf": 1}
"""What python-can subtracts from the number of a channel in a file."""


def read_bytes(form: str, source: BinaryIO, counts: Counts) -> Iterator[LogFrame]:
    """The frames of a log in the form `blf` or `mf4`. Raises MissingPackageError."""
    opened = _reader(form)
    counted = _Counted(source)
    objects, size, listed = 0, 0, 0
    is_whole = False
    with _silent():
        try:
            reader = opened(source if form == "mf4" else counted)
            size, listed = getattr(reader, "file_size", 0), getattr(reader, "object_count", 0)
            for message in reader:
                objects += 1
                recorded = recorded_frame(form, message)
                if isinstance(recorded, SkippedPart):
                    counts.skip(recorded)
                else:
                    yield recorded
            is_whole = True
        except Exception as error:  # each reader has its own
            counts.skip(SkippedPart.TRUNCATED, 0, str(error) or type(error).__name__)
        if not is_whole:
            if form == "mf4":
                gc.collect()  # asammdf's objects refer to themselves, and print when they are deleted half made
            return
    if form == "blf" and counted.size < size:
        counts.skip(SkippedPart.TRUNCATED, 0, f"{counted.size} of {size} bytes")
    elif listed > objects:
        counts.skipped[SkippedPart.OTHER] += listed - objects


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Without what readers print: text of the log in their loggers, and tracebacks of objects that they leave half made."""
    levels = {name: logging.getLogger(name).level for name in ("can", "asammdf", "canmatrix")}
    hook = sys.unraisablehook
    try:
        for name in levels:
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        sys.unraisablehook = lambda _: None
        yield
    finally:
        sys.unraisablehook = hook
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


def _reader(form: str) -> Callable[..., MessageReader]:
    if form == "mf4":
        require("asammdf", "asammdf", "reading .mf4 files")
    import can

    return cast("Callable[..., MessageReader]", {"blf": can.BLFReader, "mf4": can.MF4Reader}[form])


def recorded_frame(form: str, message: can.Message) -> LogFrame | SkippedPart:
    """The frame that a message of python-can is, or what it is instead."""
    if message.is_error_frame:
        return SkippedPart.ERROR
    if not message.is_remote_frame and len(message.data) != message.dlc:
        return SkippedPart.MALFORMED
    bus = message.channel
    if isinstance(bus, int):
        bus += _FIRST_BUS.get(form, 0)
    return log_frame(
        nanoseconds(message.timestamp),
        "" if bus is None else str(bus),
        message.arbitration_id,
        bytes(message.data),
        Mark.RECEIVED if message.is_rx else Mark.SENT,
        extended=message.is_extended_id,
        remote=message.is_remote_frame,
    )


class _Counted:
    """A binary file whose bytes are counted as they are read."""

    def __init__(self, source: BinaryIO) -> None:
        self.source, self.size = source, 0

    def read(self, size: int = -1) -> bytes:
        content = self.source.read(size)
        self.size += len(content)
        return content

    def close(self) -> None:
        """Readers close what they read."""
