"""Logs of candump, line by line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..model.layout import MAX_DATA_BYTES
from ..semantics.frame import CanFrame
from ..targets.columns.runtime._candump import MAX_SECONDS, SkippedPart, read_line, without_colours
from .log_frame import MARKS, Counts, LogFrame, Mark, new_tuple

_MAX_KNOWN = 1 << 14
"""The maximum number of ids that are remembered."""
_MARKS = {False: Mark.RECEIVED, True: Mark.SENT, None: None}


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
                if head[1:point].isdecimal() and int(head[1:point]) <= MAX_SECONDS:
                    second, start, width = head[: point + 1], int(head[1:point]) * 1_000_000_000, point + 1
            mark = None
            if written[-3] == " ":
                mark, written = MARKS[written[-2]], written[:-3] + "\n"
            bus, id_, extended = known[head[width + 6 :]]
            data, fraction = bytes.fromhex(written), head[width : width + 6]
            is_whole = 0 < len(data) <= MAX_DATA_BYTES and len(written) == 2 * len(data) + 1 and line[-1] == "\n"
            if is_whole and head[:width] == second and fraction.isdecimal():
                frame = new_tuple(CanFrame, (id_, data, extended, False))
                recorded = new_tuple(LogFrame, (start + int(fraction) * 1_000, bus, frame, mark))
        except (ValueError, KeyError, IndexError):
            pass
        if recorded is None:
            parsed = read_line(line)
            if isinstance(parsed, SkippedPart):
                counts.skip(parsed, number, without_colours(line))
                continue
            time, bus, id_, data, extended, remote, is_sent = parsed
            if time is None and without_colours(line).lstrip().startswith("("):
                counts.lacks_time(number, without_colours(line))
            recorded = LogFrame(time, bus, CanFrame(id_, data, extended, remote), _MARKS[is_sent])
            if len(known) < _MAX_KNOWN:
                known[f") {bus} {id_:0{8 if extended else 3}X}"] = bus, id_, extended
        yield recorded
