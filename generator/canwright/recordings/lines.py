"""Logs of one frame a line: what a line that gives no frame is counted as."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from .log_frame import OVERLONG, Counts, LogFrame, SkippedPart

Read = Callable[[str], LogFrame | SkippedPart]
"""The frame on a line, or what the line is instead."""


def decimal(written: str, digits: int) -> int:
    """A decimal number in units of its digit `digits` after the point; further ones are dropped."""
    whole, _, fraction = written.replace(",", ".").partition(".")
    return int(whole + fraction[:digits].ljust(digits, "0"))


def frames_of(lines: Iterable[str], read: Read, counts: Counts, *, are_timed: bool = True) -> Iterator[LogFrame]:
    """The frames of numbered lines, each read once. Other lines before the first frame are the header.

    Where lines `are_timed`, a frame without a time is one whose time cannot be read.
    """
    is_header = True
    for number, line in enumerate(lines, start=1):
        part = SkippedPart.MALFORMED if line.startswith(OVERLONG) else read(line)
        if isinstance(part, LogFrame):
            is_header = False
            if part.time is None and are_timed:
                counts.lacks_time(number, line)
            yield part
        elif part is SkippedPart.MALFORMED and not line.endswith("\n"):
            counts.skip(SkippedPart.TRUNCATED, number, line)
        elif part is not SkippedPart.OTHER or not is_header:
            counts.skip(part, number, line)
