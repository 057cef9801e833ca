"""Text formats with one frame a line, each described by a pattern: what a line is follows from its named groups."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from .lines import MILLISECONDS, SECONDS, decimal, frames_of
from .log_frame import Counts, LogFrame, Mark, SkippedPart, log_frame

_MARKS = {"r": Mark.RECEIVED, "t": Mark.SENT}


class LineForm(NamedTuple):
    """A format.

    Groups of `frame`: `id` of 11 bits or `long` of 29 bits, `data` in hexadecimal digits, and where the format has them `time`
    in units of `digits`, `bus`, `mark`, `length`, `remote` and `error`. `other` matches the start of lines that are no frames.
    """

    frame: re.Pattern[str]
    other: re.Pattern[str]
    digits: int = SECONDS


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(text, re.ASCII | re.IGNORECASE)


_TIME = r"(?P<time>\d{1,15}(?:\.\d{1,18})?)"
_DATA = r"(?P<data>(?:[\da-f]{2}(?:\s+|$))*)"
_BY_NUMBER = r"0x(?:(?P<id>0*[0-7]?[\da-f]{1,2})|(?P<long>[\da-f]{3,10}))"
"""An id of 11 bits if it is small enough."""

FORMS = {
    "cabana": LineForm(
        _pattern(rf"{_TIME},{_BY_NUMBER},(?P<bus>\d{{1,3}}),(?:0x)?(?P<data>(?:[\da-f]{{2}})*)"),
        _pattern("time,addr,bus,data"),
    ),
    "crtd": LineForm(
        _pattern(
            rf"{_TIME}\s+(?P<bus>\d?)(?P<mark>[RT])(?:11\s+(?P<id>[\da-f]{{1,8}})|29\s+(?P<long>[\da-f]{{1,8}}))\s*{_DATA}"
        ),
        _pattern(r"\d+(\.\d+)?\s+\d?C"),
    ),
    "old_candump": LineForm(
        _pattern(
            rf"(?:\({_TIME}\)\s+)?(?:(?P<bus>\w+):?\s+)?<{_BY_NUMBER}>\s+"
            rf"\[(?P<length>\d{{1,2}})\]\s*(?:(?P<remote>remote request)|{_DATA})"
        ),
        _pattern(r"#|interface\b"),
    ),
    "pcan_explorer": LineForm(
        _pattern(
            rf"\d+\s+{_TIME}\s+(?P<bus>\d{{1,3}})\s+(?:(?P<long>[\da-f]{{8}})|(?P<id>[\da-f]{{3,4}}))h?\s+(?:\S+\s+)?(?P<mark>[RT])x\s+"
            rf"(?:(?P<error>Error)\b.*|(?:(?P<remote>Remote|RTR)|(?:FD\s+)?Data)\s+(?P<length>\d{{1,2}})\s*{_DATA})"
        ),
        _pattern(";"),
        MILLISECONDS,
    ),
    "python_can_print": LineForm(
        _pattern(
            rf"Timestamp:\s+{_TIME}\s+ID:\s+(?:(?P<long>[\da-f]{{8}})\s+X|(?P<id>[\da-f]{{3,4}})\s+S)(?:\s+(?P<mark>[RT])x)?"
            r"(?:\s+(?P<error>E))?(?:\s+(?P<remote>R))?(?:\s+(?:F|BS|EI))*\s+DLC?:\s+(?P<length>\d{1,2})\s*"
            rf"{_DATA}(?:'.*'\s*)?(?:Channel:\s+(?P<bus>\S+))?"
        ),
        _pattern("(?!Timestamp:)"),
    ),
}
"""The formats by their names."""


def reader(form: LineForm) -> Callable[[Iterable[str], Counts], Iterator[LogFrame]]:
    """The reader of a format."""
    return lambda lines, counts: frames_of(
        lines, lambda line: read_line(form, line), counts, are_timed=form is not FORMS["old_candump"]
    )


def read_line(form: LineForm, line: str) -> LogFrame | SkippedPart:
    """The frame on a line, or what the line is instead."""
    written = line.strip()
    match = form.frame.fullmatch(written)
    if match is None:
        return SkippedPart.OTHER if not written or form.other.match(written) else SkippedPart.MALFORMED
    fields = match.groupdict()
    if fields.get("error"):
        return SkippedPart.ERROR
    remote = bool(fields.get("remote"))
    data = b"" if remote else bytes.fromhex(fields["data"])
    length = fields.get("length")
    if length is not None and not remote and int(length) != len(data):
        return SkippedPart.MALFORMED
    return log_frame(
        None if fields.get("time") is None else decimal(fields["time"], form.digits),
        fields.get("bus") or "",
        int(fields["id"] or fields["long"], 16),
        data,
        _MARKS.get((fields.get("mark") or "").lower()),
        extended=fields["id"] is None,
        remote=remote,
    )
