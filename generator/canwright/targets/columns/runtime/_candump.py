"""The formats of candump: `-l` and `-L`, the terminal with any time stamps and marks, and lines of cansend."""

from __future__ import annotations

import re
from datetime import datetime, timezone
from enum import Enum
from typing import NamedTuple


class SkippedPart(str, Enum):
    """What a log contains besides frames; each is counted and then skipped."""

    MALFORMED = "malformed"
    TRUNCATED = "truncated end"
    ERROR = "error frames"
    XL = "CAN XL frames"
    OTHER = "other lines"
    """Comments and events that a log format allows."""


class RecordedFrame(NamedTuple):
    """A frame on a line.

    `time` is in nanoseconds, in 64 bits; None without a time of a known form. `bus` is empty without one. `is_sent` is the mark: true
    if the recorder sent the frame, false if it received it; None without one.
    """

    time: int | None
    bus: str
    id: int
    data: bytes
    extended: bool
    remote: bool
    is_sent: bool | None


SHORT = re.compile(
    r"(?:\((?P<time>-?[\d.]+)\)\s+)?(?:(?P<bus>\S+)\s+)?(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(?P<fd>#[0-9A-Fa-f])?"
    r"(?P<data>[Rr]\d?|(?:[0-9A-Fa-f]{2}\.?)*)(?:_[0-9A-Fa-f])?(?:\s+(?P<mark>[RT]))?(?:\s+[B-]\s*[E-]?)?"
)
"""A line of a log or of cansend, without white space at its ends."""
_LONG = re.compile(
    r"(?:\((?P<time>[\d:. -]+)\)\s+)?(?P<bus>\S+)\s+(?:(?P<mark>[RT]X)\s+\S\s+\S\s+)?"
    r"(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+[\[{](?P<length>\d+)[\]}]\s*"
    r"(?P<data>remote request|(?:[0-9A-Fa-f]{2}\s*)*)(?:'.*')?(?:ERRORFRAME)?"
)
"""A line of the terminal."""
_XL = re.compile(r"(?:\S+\s+)*?[0-9A-Fa-f]+#[0-9A-Fa-f]{2}:[0-9A-Fa-f]{2}:.*")
_COLOUR = re.compile(r"\x1b\[[\d;]*m")
_COMMENTS = ("#", ";", "//")
MAX_ID = {False: 0x7FF, True: 0x1FFFFFFF}
"""The greatest id, by whether it is one of 29 bits."""
_ERROR_BIT = 0x20000000
"""Set in the id of an error that the controller reports, which is not a frame."""
_MAX_DATA_BYTES = 64
MAX_SECONDS = (1 << 63) // 1_000_000_000 - 1
"""Later times, of the year 2262 and beyond, have no nanoseconds of 64 bits."""
_IS_SENT = {"R": False, "T": True, "RX": False, "TX": True, None: None}


def without_colours(line: str) -> str:
    """The text of a line of a terminal."""
    return _COLOUR.sub("", line) if "\x1b" in line else line


def read_line(line: str) -> RecordedFrame | SkippedPart:
    """The frame on a line, or what the line is instead. A line without its end was interrupted."""
    written = without_colours(line).strip()
    match = SHORT.fullmatch(written) or _LONG.fullmatch(written)
    if match is None:
        return _part(line, written)
    id_, data, remote = int(match["id"], 16), b"", match["data"].startswith(("R", "r"))
    if not remote:
        data = bytes.fromhex(match["data"].replace(".", " "))
    extended = len(match["id"]) == 8
    if extended and _ERROR_BIT <= id_ < 2 * _ERROR_BIT:
        return SkippedPart.ERROR
    if len(data) > _MAX_DATA_BYTES:
        return SkippedPart.XL
    if id_ > MAX_ID[extended] or _is_cut_off(match, data, remote, line):
        return SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED
    is_sent = _IS_SENT[match["mark"]]
    return RecordedFrame(_nanoseconds(match["time"]), match["bus"] or "", id_, data, extended, remote, is_sent)


def _is_cut_off(match: re.Match[str], data: bytes, remote: bool, line: str) -> bool:
    """Whether data are missing: fewer than a length that is printed, or an interrupted line without any."""
    length = match.groupdict().get("length")
    if length is not None:
        return not remote and int(length) != len(data)
    return not data and not remote and not line.endswith("\n") and match["time"] is not None


def _part(line: str, written: str) -> SkippedPart:
    if not written or written.startswith(_COMMENTS) or line.startswith("\t"):  # a tab starts the details of an error
        return SkippedPart.OTHER
    if _XL.fullmatch(written):
        return SkippedPart.XL
    return SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED


def _nanoseconds(written: str | None) -> int | None:
    """A time stamp in nanoseconds; a date is read as UTC. None without one, or with one of no known form."""
    if written is None:
        return None
    sign = -1 if written.startswith("-") else 1
    seconds, _, fraction = written.removeprefix("-").rpartition(".")
    if fraction.isdigit() and seconds.isdigit():
        if int(seconds) > MAX_SECONDS:
            return None
        return sign * (int(seconds) * 1_000_000_000 + int(fraction[:9].ljust(9, "0")))
    try:
        date = datetime.strptime(seconds, "%Y-%m-%d %H:%M:%S").replace(tzinfo=timezone.utc)
    except ValueError:
        return None
    is_known = fraction.isdigit() and 0 <= date.timestamp() <= MAX_SECONDS
    return int(date.timestamp()) * 1_000_000_000 + int(fraction[:9].ljust(9, "0")) if is_known else None
