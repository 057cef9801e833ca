"""The formats of candump: `-l` and `-L`, the terminal with any time stamps and marks, and lines of cansend."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from datetime import datetime, timezone

from ..model.layout import MAX_DATA_BYTES
from ..semantics.frame import CanFrame
from .log_frame import Counts, LogFrame, Mark, SkippedPart

_SHORT = re.compile(
    r"(?:\((?P<time>[\d.]+)\)\s+)?(?:(?P<bus>\S+)\s+)?(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#"
    r"(?P<data>[Rr]\d?|(?:[0-9A-Fa-f]{2}\.?)*)(?:_[0-9A-Fa-f])?(?:\s+(?P<mark>[RT]))?(?:\s+[B-]\s*[E-]?)?"
)
_LONG = re.compile(
    r"(?:\((?P<time>[\d:. -]+)\)\s+)?(?P<bus>\S+)\s+(?:(?P<mark>[RT]X)\s+\S\s+\S\s+)?"
    r"(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+[\[{](?P<length>\d+)[\]}]\s*"
    r"(?P<data>remote request|(?:[0-9A-Fa-f]{2}\s*)*)(?:'.*')?(?:ERRORFRAME)?"
)
_NOT_CLASSIC = re.compile(r"(?:\S+\s+)*?[0-9A-Fa-f]+#(?:#[0-9A-Fa-f]|[0-9A-Fa-f]{2}:[0-9A-Fa-f]{2}:).*")
_COLOUR = re.compile(r"\x1b\[[\d;]*m")
_COMMENTS = ("#", ";", "//")
_ERROR_BIT = 0x20000000
"""Set in the id of an error that the controller reports, which is not a frame."""
_MAX_KNOWN = 1 << 12
"""The maximum number of ids that are remembered."""
_new = tuple.__new__
"""Makes a NamedTuple in half of the time."""
_SHORT_MARKS = {"R": Mark.RECEIVED, "T": Mark.SENT}
_MARKS = {"R": Mark.RECEIVED, "T": Mark.SENT, "RX": Mark.RECEIVED, "TX": Mark.SENT, None: None}


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log. A last line that was cut off is counted as the truncated end."""
    known: dict[str, tuple[str, int, bool]] = {}
    second, start, width = "-", 0, 1
    for number, line in enumerate(lines, start=1):
        # Most lines are of `candump -l`, with a bus and an id that occurred before: these take a fifth of the time.
        recorded: LogFrame | None = None
        try:
            head, _, written = line.partition("#")
            if head[:width] != second and head[0] == "(":
                point = head.index(".")
                if head[1:point].isdecimal():
                    second, start, width = head[: point + 1], int(head[1:point]) * 1_000_000_000, point + 1
            mark = None
            if written[-3] == " ":
                mark, written = _SHORT_MARKS[written[-2]], written[:-3] + "\n"
            bus, id_, extended = known[head[width + 6 :]]
            data, fraction = bytes.fromhex(written), head[width : width + 6]
            is_whole = 0 < len(data) <= MAX_DATA_BYTES and len(written) == 2 * len(data) + 1 and line[-1] == "\n"
            if is_whole and head[:width] == second and fraction.isdecimal():
                frame = _new(CanFrame, (id_, data, extended, False))
                recorded = _new(LogFrame, (start + int(fraction) * 1_000, bus, frame, mark))
        except (ValueError, KeyError, IndexError):
            pass
        if recorded is None:
            recorded = _read(line, number, counts)
            if recorded is None:
                continue
            if len(known) < _MAX_KNOWN:
                bus, frame = recorded.bus, recorded.frame
                known[f") {bus} {frame.id:0{8 if frame.extended else 3}X}"] = bus, frame.id, frame.extended
        yield recorded


def _read(line: str, number: int, counts: Counts) -> LogFrame | None:
    """The frame of a line of any form; None, counted, without one."""
    written = (_COLOUR.sub("", line) if "\x1b" in line else line).strip()
    match = _SHORT.fullmatch(written) or _LONG.fullmatch(written)
    if match is None:
        counts.skip(_part(line, written), number, written)
        return None
    id_, data, remote = int(match["id"], 16), b"", match["data"].startswith(("R", "r"))
    if not remote:
        data = bytes.fromhex(match["data"].replace(".", " "))
    if id_ & _ERROR_BIT:
        counts.skip(SkippedPart.ERROR, number, written)
    elif len(data) > MAX_DATA_BYTES:
        counts.skip(SkippedPart.FD, number, written)
    elif _is_cut_off(match, data, remote, line):
        counts.skip(SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED, number, written)
    else:
        frame = CanFrame(id_, data, len(match["id"]) == 8, remote)
        return LogFrame(_nanoseconds(match["time"]), match["bus"] or "", frame, _MARKS[match["mark"]])
    return None


def _is_cut_off(match: re.Match[str], data: bytes, remote: bool, line: str) -> bool:
    """Whether data are missing: fewer than a length that is printed, or an interrupted line without any."""
    length = match.groupdict().get("length")
    if length is not None:
        return not remote and int(length) != len(data)
    return not data and not remote and not line.endswith("\n") and match["time"] is not None


def _part(line: str, written: str) -> SkippedPart:
    if not written or written.startswith(_COMMENTS) or line.startswith("\t"):  # a tab starts the details of an error
        return SkippedPart.OTHER
    if _NOT_CLASSIC.fullmatch(written):
        return SkippedPart.FD
    return SkippedPart.MALFORMED if line.endswith("\n") else SkippedPart.TRUNCATED


def _nanoseconds(written: str | None) -> int | None:
    """A time stamp in nanoseconds; a date is read as UTC. None without one, or with one of no known form."""
    if written is None:
        return None
    seconds, _, fraction = written.rpartition(".")
    if fraction.isdigit() and seconds.isdigit():
        return int(seconds) * 1_000_000_000 + int(fraction[:9].ljust(9, "0"))
    try:
        date = datetime.strptime(written, "%Y-%m-%d %H:%M:%S.%f").replace(tzinfo=timezone.utc)
    except ValueError:
        return None
    return int(date.timestamp()) * 1_000_000_000 + date.microsecond * 1_000
