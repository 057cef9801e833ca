"""What went through each target, for the end of a test run."""

from __future__ import annotations

from collections.abc import Iterator

from .runner import Report

REPORTS: list[Report] = []
KINDS = ("decode", "decode alone", "encode raw", "encode values", "refuse", "answer")


def lines() -> Iterator[str]:
    """A table of cases by target, then the named exceptions."""
    yield (
        f"{'edition':<24}{'target':<8}" + "".join(f"{kind:>15}" for kind in KINDS) + f"{'exceptions':>12}{'failed':>8}"
    )
    for report in REPORTS:
        counts = "".join(f"{report.passed[kind]:>15}" for kind in KINDS)
        failed = len(report.failures)
        yield f"{report.edition:<24}{report.target:<8}{counts}{report.exceptions.total():>12}{failed:>8}"
    for report in REPORTS:
        for name, count in sorted(report.exceptions.items()):
            yield f"{report.edition} {report.target} cannot: {name} ({count})"
