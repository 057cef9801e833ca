"""Text formats with one frame a line, each described by patterns: what a line is follows from their named groups."""

from __future__ import annotations

import functools
import re
from base64 import b64decode
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from .lines import decimal, frames_of
from .log_frame import (
    FD_LENGTHS,
    MARKS,
    MAX_CLASSIC_BYTES,
    Counts,
    LogError,
    LogFrame,
    SkippedPart,
    log_frame,
    nanoseconds,
)


@dataclass
class State:
    """What the lines so far state of the next ones: the patterns of frames, the base of numbers, and how times are counted.

    Times are since `start`, in ns, or relative to `last`, that of the line before.
    """

    frames: Sequence[re.Pattern[str]]
    base: int = 16
    start: int = 0
    last: int = 0
    is_relative: bool = False


class LineForm(NamedTuple):
    """A format. Its logs start with one of `starts`, in lower case; without one, a line of a frame identifies it.

    Groups of `frames`: `id` of 11 bits, or of 29 bits if it is `extended`, or `long` of 29 bits, and where the format has
    them `time`, `bus`, `mark`, `remote` and `error`. The data are `digits`, in `base64`, or a list of numbers: all of
    `data`, or the first of `numbers`. They have `length` bytes, or as many as a `code` states, of CAN FD if there is `fd`.
    `others` match the start of lines that are no frames, some of which have a `time`, too. `header` reads what lines state of the next ones. `bus` is that of a line without one.
    """

    frames: Sequence[re.Pattern[str]]
    others: Sequence[tuple[SkippedPart, re.Pattern[str]]]
    time: Callable[[str], int] = functools.partial(decimal, digits=9)
    starts: tuple[str, ...] = ()
    header: Callable[[State, str], object] | None = None
    bus: str = ""
    is_timed: bool = True


def reader(form: LineForm) -> Callable[[Iterable[str], Counts], Iterator[LogFrame]]:
    """The reader of the lines of a format."""
    return lambda lines, counts: frames_of(
        lines, functools.partial(_read, form, State(form.frames)), counts, are_timed=form.is_timed
    )


def _read(form: LineForm, state: State, line: str) -> LogFrame | SkippedPart:
    """The frame on a line, or what the line is instead."""
    written = line.strip()
    match = next(filter(None, (pattern.fullmatch(written) for pattern in state.frames)), None)
    part = None
    if match is None:
        if form.header is not None:
            form.header(state, written)
        matches = ((kind, pattern.match(written)) for kind, pattern in form.others)
        blank_or_damaged = SkippedPart.MALFORMED if written else SkippedPart.OTHER
        part, match = next((pair for pair in matches if pair[1]), (blank_or_damaged, None))
    fields = defaultdict(str, match.groupdict("") if match else {})
    time = None
    if fields["time"]:
        time = state.last = form.time(fields["time"]) + (state.last if state.is_relative else state.start)
    if part is not None or fields["error"]:
        return part or SkippedPart.ERROR
    try:
        id_ = int(fields["id"] or fields["long"], state.base)
        data = b"" if fields["remote"] else _data(fields, line, state.base)
    except ValueError:
        return SkippedPart.MALFORMED
    mark, extended = MARKS.get(fields["mark"].upper()), bool(fields["extended"] or fields["long"])
    return log_frame(time, fields["bus"] or form.bus, id_, data, mark, extended=extended, remote=bool(fields["remote"]))


def _data(fields: Mapping[str, str], line: str, base: int) -> bytes:
    """The data bytes. Raises ValueError if they are not as many as stated, one is no byte, or the last one may be cut off."""
    length = int(fields["length"]) if fields["length"] else None
    if fields["code"]:
        code = int(fields["code"], base if len(fields["code"]) == 1 else 10)
        length = FD_LENGTHS.get(code, code) if fields["fd"] else min(MAX_CLASSIC_BYTES, code)
    if fields["base64"] or fields["digits"]:
        data = b64decode(fields["base64"], validate=True) or bytes.fromhex(fields["digits"])
    else:
        numbers = fields["data"].split() or fields["numbers"].replace(",", " ").split()[:length]
        if numbers and line.endswith(numbers[-1]) and (base != 16 or len(numbers[-1]) < 2):
            raise ValueError  # the last number may be cut off, since no "\n" follows
        data = bytes([int(number, base) for number in numbers])
    if length not in (None, len(data)):
        raise ValueError
    return data


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(text, re.ASCII | re.IGNORECASE | re.DOTALL)


def _by_columns(
    names: Sequence[str], known: Mapping[str, str], rest: str, separator: str, end: str
) -> list[re.Pattern[str]]:
    """The pattern of lines with these columns and an end; `rest` is an unknown column. No pattern if a name is there twice."""
    columns = separator.join(known.get(name, rest) for name in names)
    return [_pattern(columns + end)] if len({*names}) == len(names) else []


def _read_base(state: State, line: str) -> None:
    base = re.match(r"base\s+(hex|dec)(?:\s+timestamps\s+(\w+))?", line, re.IGNORECASE)
    if base:
        state.base = 10 if base[1].lower() == "dec" else 16
        state.is_relative = (base[2] or "").lower() == "relative"


def _read_modes(state: State, line: str) -> None:
    title = line.strip("*\r\n ").upper()
    if line.startswith("***"):
        state.base = {"HEX": 16, "DEC": 10}.get(title, state.base)
        if title.endswith(" MODE"):
            state.is_relative = title.startswith("RELATIVE")


def _of_the_day(written: str) -> int:
    """A time of BUSMASTER, whose last digits count tenths of a millisecond."""
    hours, minutes, seconds, ticks = map(int, written.split(":"))
    return ((hours * 60 + minutes) * 60 + seconds) * 1_000_000_000 + ticks * 100_000


_EPOCH = 25569
"""The days from 30 December 1899, from which start times of TRC count, to the epoch."""
_DAY = 86_400_000_000
"""A day in microseconds."""


def _read_start(state: State, line: str) -> None:
    start = re.match(r";\$STARTTIME=(\d{1,7}(?:[.,]\d{1,18})?)(?:\s|$)", line, re.ASCII)
    if start:
        state.start = round((Fraction(start[1].replace(",", ".")) - _EPOCH) * _DAY) * 1_000
    if line.startswith(";$COLUMNS="):
        letters, _, end = line.partition("=")[2].replace(" ", "").partition(",D")
        names = letters.split(",")
        is_complete = {"I", "O", "T"} < {*names} and not {"L", "l"}.isdisjoint(names) and not end
        state.frames = _by_columns(names, _TRC_COLUMNS, r"\S+", r"\s+", f"{_NUMBERS}.*") if is_complete else []


def _read_names(state: State, line: str) -> None:
    """Reads the first line of SavvyCAN. The bytes are the last columns. Raises LogError."""
    if state.frames:
        return
    names = [name.strip() for name in line.split(",")]
    names = names[: names.index("D1") if "D1" in names else names.index("LEN") + 1 if "LEN" in names else None]
    missing = next((name for name in _SAVVYCAN_COLUMNS if name not in (*names, "Dir", "Bus")), None)
    if missing is not None:
        raise LogError(
            f"the first line of this CSV log names no column {missing}; export it again with all columns of SavvyCAN"
        )
    end = r"(?P<numbers>(?:\s*,\s*[\da-f]{1,2})*)(?:\s*,.*)?"
    state.frames = _by_columns(names, _SAVVYCAN_COLUMNS, "[^,]*", r"\s*,\s*", end)


_TIME = r"(?P<time>\d{1,15}(?:[.,]\d{1,18})?)"
_STAMP = r"(?P<time>\d{1,15}\.\d{1,18})"
_MARK = r"(?P<mark>[RT])x"
_DATA = r"(?P<data>(?:[\da-f]{2}(?:\s+|$))*)"
_NUMBERS = r"(?P<numbers>(?:\s+[\da-f]{1,3}(?=\s|$))*)"
_BY_NUMBER = r"0x(?:(?P<id>0*[0-7]?[\da-f]{1,2})|(?P<long>[\da-f]{3,10}))"
"""An id of 11 bits if it is small enough."""
_LONG = r"(?P<long>[\da-f]{8})"
_BY_DIGITS = rf"(?!FFFFFFFF)(?:{_LONG}|(?P<id>[\da-f]{{4}}))"
"""An id of TRC; all bits of it stand for a status of the bus."""
_TRC_COLUMNS = {
    "N": r"\d+",
    "O": _TIME,
    "T": "(?:(?P<remote>RR)|DT|(?P<fd>F[DBE]|BI))",
    "B": r"(?P<bus>\S+)",
    "I": _BY_DIGITS,
    "d": rf"(?:{_MARK}|\S+)",
    "l": r"(?P<length>\d{1,4})",
    "L": r"(?P<code>\d{1,2})",
}
_SAVVYCAN_COLUMNS = {
    "Time Stamp": r"(?P<time>-?\d{1,30})",
    "ID": r"(?:0x)?(?P<id>[\da-f]{1,16})",
    "Extended": r"(?:(?P<extended>true)|[^,]*)",
    "LEN": r"(?P<length>-?\d{1,30})",
    "Dir": rf"(?:{_MARK}|[^,]*)",
    "Bus": r"(?P<bus>[^,]*?)",
}
_OTHER, _ERROR, _MALFORMED = SkippedPart.OTHER, SkippedPart.ERROR, SkippedPart.MALFORMED

FORMS = {
    "asc": LineForm(
        frames=(
            _pattern(
                rf"{_STAMP}\s+0*(?P<bus>\d{{1,9}})\s+(?P<id>[\da-f]{{1,10}})(?P<extended>x?)\s+{_MARK}\s+"
                rf"(?:(?P<remote>r)\b|d\s+(?P<code>[\da-f]{{1,2}}){_NUMBERS}).*"
            ),
            _pattern(
                rf"{_STAMP}\s+CANFD\s+0*(?P<bus>\d{{1,9}})\s+{_MARK}\s+(?P<id>[\da-f]{{1,10}})(?P<extended>x?)\s+"
                r"(?:(?![01]\s)\S+\s+)?[01]\s+[01]\s+"
                rf"(?:(?P<remote>(?!0+\s)[\da-f]{{1,2}}\s+0+(?=\s|$))|[\da-f]{{1,2}}\s+(?P<length>\d{{1,4}}){_NUMBERS}).*"
            ),
        ),
        others=(
            (_OTHER, _pattern(rf"(?!{_STAMP}(?:\s|$))")),
            (_ERROR, _pattern(rf"{_STAMP}\s+(CANFD\s+)?\d+\s+(\w+\s+)?ErrorFrame\b")),
            # An event on a channel, such as `Statistic:`, or the request of a frame that is sent later.
            (_OTHER, _pattern(rf"{_STAMP}\s+\d+\s+(\w+:(?!.*\s(Rx|Tx)\s)|\w+\s+TxRq\b)")),
            (_OTHER, _pattern(rf"{_STAMP}\s+(?!(\d+|CANFD)\s)")),
            (_MALFORMED, _pattern(_STAMP)),
        ),
        starts=("date ", "base ", "// version", "begin triggerblock"),
        header=_read_base,
    ),
    "busmaster": LineForm(
        frames=(
            _pattern(
                rf"(?P<time>\d{{1,9}}:\d\d:\d\d:\d{{4}})\s+{_MARK}\s+(?P<bus>\d{{1,3}})\s+(?:0x)?(?P<id>[\da-f]{{1,10}})\s+"
                rf"(?:s|(?P<extended>x))(?P<remote>r?)(?:-?fd)?\s+(?P<length>\d{{1,2}}){_NUMBERS}"
            ),
        ),
        others=((_OTHER, _pattern(r"\*\*\*")), (_ERROR, _pattern(r"\d+:\d\d:\d\d:\d+\s.*\bERR"))),
        time=_of_the_day,
        starts=("***busmaster",),
        header=_read_modes,
    ),
    "cabana": LineForm(
        frames=(_pattern(rf"{_TIME},{_BY_NUMBER},(?P<bus>\d{{1,3}}),(?:0x)?(?P<digits>(?:[\da-f]{{2}})*)"),),
        others=((_OTHER, _pattern("time,addr,bus,data")),),
        starts=("time,addr,bus,data",),
    ),
    "crtd": LineForm(
        frames=(
            _pattern(
                rf"{_TIME}\s+(?P<bus>\d?)(?P<mark>[RT])(?:11\s+(?P<id>[\da-f]{{1,8}})|29\s+(?P<long>[\da-f]{{1,8}}))\s*{_DATA}"
            ),
        ),
        others=((_OTHER, _pattern(r"\d+(\.\d+)?\s+\d?C")),),
    ),
    "csv": LineForm(
        frames=(
            _pattern(
                r"(?P<time>\d{1,20}(?:\.\d{1,40})?(?:e[+-]?\d{1,2})?),0x(?P<id>[\da-f]{1,16}),(?:(?P<extended>1)|0),"
                r"(?:(?P<remote>1)|0),(?:(?P<error>1)|0),(?P<length>\d{1,4}),(?P<base64>[\w+/]*={0,2})"
            ),
        ),
        others=((_OTHER, _pattern("timestamp,arbitration_id")),),
        time=lambda written: nanoseconds(float(written)),
        starts=("timestamp,arbitration_id",),
    ),
    "old_candump": LineForm(
        frames=(
            _pattern(
                rf"(?:\({_TIME}\)\s+)?(?:(?P<bus>\w+):?\s+)?<{_BY_NUMBER}>\s+"
                rf"\[(?P<length>\d{{1,2}})\]\s*(?:(?P<remote>remote request)|{_DATA})"
            ),
        ),
        others=((_OTHER, _pattern(r"#|interface\b")),),
        is_timed=False,
    ),
    "pcan_explorer": LineForm(
        frames=(
            _pattern(
                rf"\d+\s+{_TIME}\s+(?P<bus>\d{{1,3}})\s+(?:{_LONG}|(?P<id>[\da-f]{{3,4}}))h?\s+(?:\S+\s+)?{_MARK}\s+"
                rf"(?:(?P<error>Error)\b.*|(?:(?P<remote>Remote|RTR)|(?:FD\s+)?Data)\s+(?P<length>\d{{1,2}})\s*{_DATA})"
            ),
        ),
        others=((_OTHER, _pattern(";")),),
        time=functools.partial(decimal, digits=6),
        starts=(";index",),
    ),
    "python_can_print": LineForm(
        frames=(
            _pattern(
                rf"Timestamp:\s+{_TIME}\s+ID:\s+(?:{_LONG}\s+X|(?P<id>[\da-f]{{3,4}})\s+S)(?:\s+{_MARK})?"
                r"(?:\s+(?P<error>E))?(?:\s+(?P<remote>R))?(?:\s+(?:F|BS|EI))*\s+DLC?:\s+(?P<length>\d{1,2})\s*"
                rf"{_DATA}(?:'.*'\s*)?(?:Channel:\s+(?P<bus>\S+))?"
            ),
        ),
        others=((_OTHER, _pattern("(?!Timestamp:)")),),
    ),
    "savvycan": LineForm(
        frames=(),
        others=((_OTHER, _pattern("Time Stamp,")),),
        time=functools.partial(decimal, digits=3),
        starts=("time stamp,id,extended",),
        header=_read_names,
    ),
    "trc": LineForm(
        frames=(
            _pattern(
                rf"\d+\)\s+{_TIME}\s+(?:(?P<bus>\d{{1,2}})\s+)?(?:{_MARK}\s+)?{_BY_DIGITS}\s+(?:-\s+)?(?P<length>\d{{1,2}})"
                rf"(?:\s+(?P<remote>RTR)|{_NUMBERS}.*)"
            ),
        ),
        others=(
            (_OTHER, _pattern(r"(?!\d+\)?\s+\d+([.,]\d+)?(\s|$))")),
            (_ERROR, _pattern(r"\d+\)?\s+[\d.,]+\s+(\d+\s+)?(ERROR|Warng|ER|STATUS|ST)\b")),
            (_OTHER, _pattern(r"\d+\)?\s+[\d.,]+\s+(EV\b|(\d{1,2}\s+)?([RT]x\s+)?FFFFFFFF\b)")),
        ),
        time=functools.partial(decimal, digits=6),
        starts=(";$", ";##"),
        header=_read_start,
        bus="1",
    ),
}
"""The formats by their names."""
