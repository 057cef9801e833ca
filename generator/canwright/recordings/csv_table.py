"""The CSV format of python-can: times in seconds, ids in hexadecimal, data in Base64."""

from __future__ import annotations

import re
from base64 import b64decode
from binascii import Error
from collections.abc import Iterable, Iterator

from .lines import frames_of
from .log_frame import Counts, LogFrame, SkippedPart, log_frame, nanoseconds

START = "timestamp,arbitration_id"
_FRAME = re.compile(
    r"(?P<time>\d{1,20}(?:\.\d{1,40})?(?:e[+-]?\d{1,2})?),0x(?P<id>[\da-f]{1,16}),(?P<extended>[01]),(?P<remote>[01]),"
    r"(?P<error>[01]),(?P<length>\d{1,4}),(?P<data>[\w+/]*={0,2})\s*",
    re.ASCII | re.IGNORECASE,
)


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log, the first of which names the columns."""
    return frames_of(lines, _read, counts)


def _read(line: str) -> LogFrame | SkippedPart:
    match = _FRAME.fullmatch(line)
    if match is None:
        return SkippedPart.OTHER if not line.strip() or line.startswith(START) else SkippedPart.MALFORMED
    if match["error"] == "1":
        return SkippedPart.ERROR
    remote = match["remote"] == "1"
    try:
        data = b"" if remote else b64decode(match["data"], validate=True)
    except Error:
        return SkippedPart.MALFORMED
    if not remote and len(data) != int(match["length"]):
        return SkippedPart.MALFORMED
    time = nanoseconds(float(match["time"]))
    return log_frame(time, "", int(match["id"], 16), data, None, extended=match["extended"] == "1", remote=remote)
