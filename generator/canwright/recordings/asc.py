"""ASC, the text format of Vector: one frame or event a line, numbers in the base that the header states."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from .lines import SECONDS, decimal, frames_of, octets
from .log_frame import MARKS, MAX_CLASSIC_BYTES, Counts, LogFrame, SkippedPart, log_frame

_BASE = re.compile(r"\s*base\s+(hex|dec)(?:\s+timestamps\s+(\w+))?", re.IGNORECASE)
_TIME = re.compile(r"\s*(\d{1,18}\.\d{1,18})\s", re.ASCII)
_FRAME = re.compile(
    r"(?P<bus>\d{1,9})\s+(?P<id>[\da-f]{1,10})(?P<extended>x?)\s+(?P<mark>Rx|Tx)\s+"
    r"(?:(?P<remote>r)\b.*|d\s+(?P<length>[\da-f]{1,2})(?P<data>(?:\s+[\da-f]{1,3}(?=\s|$))*).*)",
    re.ASCII | re.IGNORECASE | re.DOTALL,
)
_FD_FRAME = re.compile(
    r"CANFD\s+(?P<bus>\d{1,9})\s+(?P<mark>Rx|Tx)\s+(?P<id>[\da-f]{1,10})(?P<extended>x?)\s+(?:(?![01]\s)\S+\s+)?"
    r"[01]\s+[01]\s+(?P<code>[\da-f]{1,2})\s+(?P<length>\d{1,4})(?P<data>(?:\s+[\da-f]{1,3}(?=\s|$))*).*",
    re.ASCII | re.IGNORECASE | re.DOTALL,
)
_ERROR = re.compile(r"(CANFD\s+)?\d+\s+(\w+\s+)?ErrorFrame\b", re.IGNORECASE)
_EVENT = re.compile(r"\d+\s+(\w+:(?!.*\s(Rx|Tx)\s)|\w+\s+TxRq\s)")
"""An event on a channel, such as `Statistic:`, or the request of a frame that is sent later."""
_LIKE_A_FRAME = re.compile(r"(\d+|CANFD)\s")


def read(lines: Iterable[str], counts: Counts) -> Iterator[LogFrame]:
    """The frames of the lines of a log, with times since its start."""
    return frames_of(lines, _Asc().read, counts)


class _Asc:
    """The base of numbers, and the time of the last line, since that of the next one can be relative to it."""

    def __init__(self) -> None:
        self._base = 16
        self._is_relative = False
        self._time = 0

    def read(self, line: str) -> LogFrame | SkippedPart:
        """The frame on a line, or what the line is instead."""
        stamp = _TIME.match(line)
        if stamp is None:
            base = _BASE.match(line)
            if base is not None:
                self._base = 10 if base[1].lower() == "dec" else 16
                self._is_relative = (base[2] or "").lower() == "relative"
            return SkippedPart.OTHER
        time = decimal(stamp[1], SECONDS)
        if self._is_relative:
            time += self._time
        self._time = time
        event = line[stamp.end() :].lstrip()
        match = _FRAME.match(event) or _FD_FRAME.match(event)
        if match is not None:
            return self._frame(time, match, line)
        if _ERROR.match(event):
            return SkippedPart.ERROR
        if _EVENT.match(event) or not _LIKE_A_FRAME.match(event):
            return SkippedPart.OTHER
        return SkippedPart.MALFORMED

    def _frame(self, time: int, match: re.Match[str], line: str) -> LogFrame | SkippedPart:
        fields = match.groupdict()
        try:
            id_ = int(fields["id"], self._base)
            if "code" in fields:
                length = int(fields["length"])
                remote = length == 0 and int(fields["code"], self._base) != 0
            else:
                remote = fields["remote"] is not None
                length = 0 if remote else min(MAX_CLASSIC_BYTES, int(fields["length"], self._base))
        except ValueError:
            return SkippedPart.MALFORMED
        data = octets(fields["data"] or "", length, line, self._base)
        if data is None:
            return SkippedPart.MALFORMED
        mark = MARKS[fields["mark"].lower()]
        return log_frame(
            time, str(int(fields["bus"])), id_, data, mark, extended=bool(fields["extended"]), remote=remote
        )
