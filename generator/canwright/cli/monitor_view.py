"""The latest values of nodes as text: cells of a table, and lines for a pipe."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from ..diagnostics.unicode_safety import visible
from ..model.formatting import counted
from ..recordings.exports import bus_name, milliseconds
from ..recordings.latest_values import Entry, Line, Status
from ..recordings.rows import Row
from .decode_view import AlignedTable, value_text

HEADINGS = ("node", "command", "", "signal", "value", "age", "rate", "latency")
_PLAIN = (*HEADINGS[:3], *HEADINGS[5:])
_FIXED = {0: 4, 2: 7, 5: 6, 6: 7, 7: 8}
"""The widths of columns that do not depend on the terminal."""
_SHARED = len(HEADINGS) - len(_FIXED)
"""How many columns share the rest of the width."""
_DIGITS = 7
"""The digits of a number that is not whole: as many as a float of 32 bits has."""
_RIGHT = frozenset((5, 6, 7))


def column_widths(width: int) -> Sequence[int]:
    """The widths of the columns in a terminal, without the blank between two."""
    rest = max(0, width - sum(_FIXED.values()) - len(HEADINGS) + 1)
    return [_FIXED.get(at, rest // _SHARED) for at in range(len(HEADINGS))]


def joined_cells(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Cells in their columns; what is too long ends with an ellipsis."""
    return " ".join(_fitted(cell, width, at) for at, (cell, width) in enumerate(zip(cells, widths, strict=True)))


def _fitted(cell: str, width: int, at: int) -> str:
    text = cell if len(cell) <= width else f"{cell[: max(0, width - 1)]}…"[:width]
    return text.rjust(width) if at in _RIGHT else text.ljust(width)


def cells(line: Line, now: int, *, has_buses: bool, is_repeated: bool) -> Sequence[str]:
    """The cells of a value; only signal and value if it `is_repeated`: of the entry of the line above."""
    entry = line.entry
    value = [visible(line.signal), visible(_value(line))]
    if is_repeated:
        return ["", "", "", *value, "", "", ""]
    return [
        node_name(entry, has_buses=has_buses),
        visible(entry.command) or "-",
        entry.row.form.direction.value if entry.row.form.direction else "-",
        *value,
        duration(entry.age(now)),
        _rate(entry.rate(now)),
        _latency(entry),
    ]


def node_name(entry: Entry, *, has_buses: bool) -> str:
    """`3`; with several buses `can0:3`."""
    node = "-" if entry.node is None else str(entry.node)
    return f"{bus_name(entry.bus)}:{node}" if has_buses else node


def _value(line: Line) -> str:
    row = line.entry.row
    if row.judged.rejection is not None:
        return f"{counted(line.entry.frames, 'frame')}: {row.judged.rejection.text}"
    if not row.form.columns:
        return ""
    raw, value = row.fields[2 * line.at : 2 * line.at + 2]
    if isinstance(value, float):
        value = float(f"{value:.{_DIGITS}g}")
    text = value_text(value, raw, row.form.columns[line.at].field.type)
    return f"{text} !" if is_implausible(line) else text


def is_implausible(line: Line) -> bool:
    """Whether a value is outside a range of its type."""
    return any(at == line.at for at, _ in line.entry.row.implausible)


def duration(seconds: float | None) -> str:
    """`0.2 s`, `45 s`, `12 min`, `3 h`."""
    if seconds is None:
        return "-"
    if seconds < 10:
        return f"{seconds:.1f} s"
    return next(
        f"{seconds / size:.0f} {unit}" for size, unit in ((3600, "h"), (60, "min"), (1, "s")) if seconds >= 2 * size
    )


def _rate(rate: float | None) -> str:
    return "-" if rate is None else f"{rate:.0f}/s" if rate >= 100 else f"{rate:.1f}/s"


def _latency(entry: Entry) -> str:
    latency = entry.row.judged.latency
    return "-" if latency is None else f"{milliseconds(latency, 2 if latency < 10_000_000 else 1)} ms"


class Sources(NamedTuple):
    """What is shown beside the values: error frames, the bit rate in bit/s, the name and the frames of the recording."""

    error_frames: int
    bit_rate: int | None
    recording: tuple[str, int] | None
    recording_error: str
    """Why the recording ended by itself."""


def status_parts(status: Status, sources: Sources) -> Iterator[str]:
    """The parts of the line with the state of the bus."""
    if sources.recording:
        name, frames = sources.recording
        yield f"recording {visible(name)}, {counted(frames, 'frame')}"
    if sources.recording_error:
        yield sources.recording_error
    if status.rate is not None:
        yield f"{status.rate:.0f} frames/s"
    if status.bits is not None and sources.bit_rate:
        yield f"load at most {100 * status.bits / sources.bit_rate:.1f} % of {sources.bit_rate / 1000:g} kbit/s"
    yield counted(status.frames, "frame")
    for count, text in (
        (sources.error_frames, "error frames"),
        (status.rejected, "rejected"),
        (status.foreign, "with foreign ids"),
        (status.dropped, "dropped from view, since more came than can be decoded"),
    ):
        if count:
            yield f"{count} {text}"


class PlainTable(AlignedTable):
    """The messages that came since the last time, for a pipe."""

    def __init__(self) -> None:
        super().__init__([heading or "direction" for heading in _PLAIN], "values", range(3, len(_PLAIN)))
        self._printed: dict[int, Row] = {}

    def __call__(self, lines: Iterable[Line], now: int, *, has_buses: bool) -> str:
        """A line for each message, with those values that are shown."""
        shown = [[*group] for _, group in itertools.groupby(lines, lambda line: id(line.entry))]
        new = [group for group in shown if id(group[0].entry.row) not in self._printed]
        self._printed = {id(group[0].entry.row): group[0].entry.row for group in shown}
        return self.lines([_plain(group, now, has_buses=has_buses) for group in new]) if new else ""


def _plain(group: Sequence[Line], now: int, *, has_buses: bool) -> tuple[Sequence[str], str]:
    node, command, direction, _, _, *timed = cells(group[0], now, has_buses=has_buses, is_repeated=False)
    values = ", ".join(f"{visible(line.signal)} {visible(_value(line))}".strip() for line in group)
    return [node, command, direction, *timed], values
