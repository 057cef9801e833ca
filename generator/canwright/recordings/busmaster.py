"""Logs of BUSMASTER: numbers in the base and times of the mode that the header states."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from .lines import frames_of, octets
from .log_frame import MARKS, Counts, LogFrame, SkippedPart, log_frame

START = "***BUSMASTER"
_FRAME = re.compile(
    r"\s*(?P<time>\d{1,9}:\d\d:\d\d:\d{4})\s+(?P<mark>[RT]x)\s+(?P<bus>\d{1,3})\s+(?:0x)?(?P<id>[\da-f]{1,10})\s+"
    r"(?P<type>[sx])(?P<remote>r?)(?:-?fd)?\s+(?P<length>\d{1,2})(?P<data>(?:\s+[\da-f]{1,3}(?=\s|$))*)\s*",
    re.ASCII | re.IGNORECASE,
)
_ERROR = re.compile(r"\s*\d+:\d\d:\d\d:\d+\s.*\bERR", re.ASCII | re.IGNORECASE)
_TICK = 100_000
"""The last digits of a time count tenths of a millisecond."""


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log, with times of the day, or since its start."""
    return frames_of(lines, _Busmaster().read, counts)


class _Busmaster:
    """The base of numbers, and the time of the last line, since that of the next one can be relative to it."""

    def __init__(self) -> None:
        self._base = 16
        self._is_relative = False
        self._time = 0

    def read(self, line: str) -> LogFrame | SkippedPart:
        """The frame on a line, or what the line is instead."""
        if line.startswith("***"):
            title = line.strip("*\r\n ").upper()
            self._base = {"HEX": 16, "DEC": 10}.get(title, self._base)
            if title.endswith(" MODE"):
                self._is_relative = title.startswith("RELATIVE")
            return SkippedPart.OTHER
        match = _FRAME.fullmatch(line)
        if match is None:
            return (
                SkippedPart.ERROR
                if _ERROR.match(line)
                else SkippedPart.MALFORMED
                if line.strip()
                else SkippedPart.OTHER
            )
        hours, minutes, seconds, ticks = map(int, match["time"].split(":"))
        time = ((hours * 60 + minutes) * 60 + seconds) * 1_000_000_000 + ticks * _TICK
        self._time = self._time + time if self._is_relative else time
        remote = bool(match["remote"])
        try:
            id_ = int(match["id"], self._base)
        except ValueError:
            return SkippedPart.MALFORMED
        data = b"" if remote else octets(match["data"], int(match["length"]), line, self._base)
        if data is None:
            return SkippedPart.MALFORMED
        mark = MARKS[match["mark"].lower()]
        return log_frame(
            self._time, match["bus"], id_, data, mark, extended=match["type"].lower() == "x", remote=remote
        )
