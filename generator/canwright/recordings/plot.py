"""A picture of fields over time. Memory does not grow with the log."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from .exports import bus_name
from .packages import require
from .rows import Row

FORMATS = (".pdf", ".png", ".svg")
_MAX_BUCKETS = 4096
"""The maximum number of buckets of a curve, more than a picture has columns."""


class Curve:
    """Points of one field, and of more points than a picture has columns the smallest and largest of some in turn."""

    def __init__(self) -> None:
        self._size = 1
        self._buckets: list[list[tuple[float, float]]] = []
        """Smallest and largest point, in the order of their times, of `_size` points; the last may have fewer."""
        self._filled = 0

    def add(self, time: float, value: float) -> None:
        """Adds a point."""
        if self._filled in (0, self._size):
            if len(self._buckets) == _MAX_BUCKETS:
                pairs = zip(self._buckets[::2], self._buckets[1::2], strict=True)
                self._buckets = [_ends(first + second) for first, second in pairs]
                self._size *= 2
            self._buckets.append([])
            self._filled = 0
        self._buckets[-1] = _ends([*self._buckets[-1], (time, value)])
        self._filled += 1

    def points(self) -> tuple[list[float], list[float]]:
        """Times and values."""
        points = [point for bucket in self._buckets for point in bucket]
        return [time for time, _ in points], [value for _, value in points]


def _ends(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points with the smallest and with the largest value, in their order."""
    if len(points) < 3:
        return points
    values = [value for _, value in points]
    ends = sorted({values.index(min(values)), values.index(max(values))})
    return [points[i] for i in ends]


class Plot:
    """Collects the values of fields: one diagram for each field, one curve for each node and direction.

    The horizontal axis is the time since the first frame; in a log without times, the number of the frame. Raises
    MissingPackageError.
    """

    def __init__(self, fields: Collection[str]) -> None:
        require("matplotlib", "matplotlib", "--plot")
        self._fields = list(dict.fromkeys(fields))
        self._start: int | None = None
        self._curves: dict[tuple[str, str], dict[str, Curve]] = {}

    def write(self, row: Row) -> None:
        time, number = row.judged.recorded.time, row.judged.number
        if self._start is None:
            self._start = time
        at = number if time is None or self._start is None else (time - self._start) / 1_000_000_000
        for cell in row.cells:
            name = cell.column.name
            if name not in self._fields and cell.column.field.name not in self._fields:
                continue
            if cell.no_value is not None:
                continue
            named = cell.value is None or isinstance(cell.value, (str, list))
            value, unit = (cell.raw, "raw") if named else (cell.value, cell.column.unit)
            assert isinstance(value, (int, float))
            curves = self._curves.setdefault((name, unit), {})
            curves.setdefault(_label(row), Curve()).add(float(at), float(value))

    @property
    def missing(self) -> list[str]:
        """The fields without a value so far."""
        names = {name for name, _ in self._curves} | {name.partition("[")[0] for name, _ in self._curves}
        return [name for name in self._fields if name not in names]

    def save(self, path: Path, form: str) -> None:
        """Saves the picture in a format of FORMATS. Equal logs give equal files."""
        import matplotlib

        matplotlib.use("Agg")
        matplotlib.rcParams["svg.hashsalt"] = "canwright"
        from matplotlib.figure import Figure

        figure = Figure(figsize=(10, 1 + 2.5 * max(1, len(self._curves))), layout="constrained")
        axes = figure.subplots(max(1, len(self._curves)), sharex=True, squeeze=False)[:, 0]
        for axis, ((name, unit), curves) in zip(axes, sorted(self._curves.items()), strict=False):
            for label, curve in sorted(curves.items()):
                axis.plot(*curve.points(), label=_literal(label), linewidth=1, marker=".", markersize=2)
            axis.set_ylabel(_literal(f"{name} [{unit}]" if unit else name))
            axis.legend(loc="upper right", fontsize="small")
            axis.grid(visible=True, alpha=0.3)
        axes[-1].set_xlabel("number of the frame" if self._start is None else "time [s]")
        metadata = {"Software": None} if form == ".png" else {"Date": None, "Creator": None}
        if form == ".pdf":
            metadata = {"CreationDate": None, "Creator": None, "Producer": None}
        figure.savefig(path, format=form.removeprefix("."), dpi=100, metadata=metadata)


def _label(row: Row) -> str:
    judged = row.judged
    place = "no node" if judged.node is None else f"node {judged.node}"
    direction = f" {judged.direction.value}" if judged.direction else ""
    return f"{bus_name(judged.recorded.bus)} {place}{direction}".strip()


def _literal(text: str) -> str:
    """A text that is not read as a formula; an underscore at its start would hide a label."""
    return text.replace("$", r"\$")
