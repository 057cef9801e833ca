"""The text of adapters with a serial port (slcan, Lawicel): `t14189A00...` for 11 bits, `T` for 29, `r` and `R` for remote frames."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from .lines import frames_of
from .log_frame import FD_LENGTHS, MAX_CLASSIC_BYTES, Counts, LogFrame, SkippedPart, log_frame

FRAME = re.compile(
    r"(?:[tdbr](?P<id>[\dA-F]{3})|[TDBR](?P<long>[\dA-F]{8}))(?P<length>[\dA-F])(?P<data>(?:[\dA-F]{2})*)",
    re.ASCII | re.IGNORECASE,
)
"""A line; after the data, adapters can write the time in milliseconds, which begins again after a minute."""
_OTHER = re.compile(r"[zZ]*|[OCLSVNFMmXQWZ][\dA-F]*", re.ASCII)
"""Commands to an adapter, and its answers."""
_ERROR_ANSWER = "\x07"
_MINUTE = 60_000


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log."""
    return frames_of(lines, _Slcan().read, counts, are_timed=False)


class _Slcan:
    """The time of the last frame, in milliseconds."""

    def __init__(self) -> None:
        self._time = 0

    def read(self, line: str) -> LogFrame | SkippedPart:
        """The frame on a line, or what the line is instead."""
        written = line.strip().strip(_ERROR_ANSWER)
        match = FRAME.fullmatch(written)
        if match is None or (match["id"] is None) != written[0].isupper():
            return SkippedPart.OTHER if _OTHER.fullmatch(written) else SkippedPart.MALFORMED
        code, content = int(match["length"], 16), bytes.fromhex(match["data"])
        kind = written[0].lower()
        remote = kind == "r"
        length = 0 if remote else FD_LENGTHS.get(code, code) if kind in "db" else min(MAX_CLASSIC_BYTES, code)
        if len(content) not in (length, length + 2):
            return SkippedPart.MALFORMED
        time = None
        if len(content) > length:
            self._time += (int.from_bytes(content[length:], "big") - self._time) % _MINUTE
            time = self._time * 1_000_000
        return log_frame(
            time,
            "",
            int(match["id"] or match["long"], 16),
            content[:length],
            None,
            extended=match["id"] is None,
            remote=remote,
        )
