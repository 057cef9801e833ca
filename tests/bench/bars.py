"""A table of measures with their bars."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import NamedTuple


class Measure(NamedTuple):
    """A figure and what is required of it; `at_most` and `at_least` are None without a bar."""

    title: str
    figure: float
    at_most: float | None = None
    at_least: float | None = None
    note: str = ""

    @property
    def passes(self) -> bool:
        bars = ((operator.le, self.at_most), (operator.ge, self.at_least))
        return all(bar is None or compare(self.figure, bar) for compare, bar in bars)

    @property
    def bar(self) -> str:
        if self.at_most is not None:
            return f"<= {self.at_most:g}"
        return "" if self.at_least is None else f">= {self.at_least:g}"


def report(measures: Sequence[Measure]) -> int:
    """Prints the table; the exit status is 1 if a figure misses its bar."""
    width = max(len(measure.title) for measure in measures)
    print(f"{'measure':{width}}  figure  bar")
    for measure in measures:
        missed = "" if measure.passes else "MISSED"
        print(f"{measure.title:{width}}  {measure.figure:6.2f}  {measure.bar:8} {missed:7} {measure.note}".rstrip())
    return 0 if all(measure.passes for measure in measures) else 1
