"""How many golden frames went through each target, for the end of a test run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from canwright.conformance.runner import REASONS, Failure, Report

from .adapters import ADAPTERS

REPORTS: list[Report] = []
"""The replays of this process."""

KINDS = ("decode", "decode alone", "encode raw", "encode values", "refuse", "answer")


def as_data(reports: Iterable[Report]) -> list[dict[str, Any]]:
    """Reports as plain data without the entries of golden frames, which one process can send to another."""
    return [
        {
            "target": report.target,
            "edition": report.edition,
            "passed": dict(report.passed),
            "exceptions": dict(report.exceptions),
            "failures": [failure._replace(entry=None) for failure in report.failures],
            "asked": report.asked,
            "failed": report.failed,
        }
        for report in reports
    ]


def from_data(data: Iterable[Mapping[str, Any]]) -> Iterator[Report]:
    """The reports that `as_data` made plain."""
    for item in data:
        counters = {key: Counter(item[key]) for key in ("passed", "exceptions")}
        failures = [Failure(*failure) for failure in item["failures"]]
        yield Report(**{**item, **counters, "failures": failures})


def summary(reports: Iterable[Report]) -> Iterator[str]:
    """A few lines: how much was replayed, and with which result."""
    reports = list(reports)
    editions = {report.edition for report in reports}
    targets = sorted({report.target for report in reports})
    passed = sum(report.passed.total() for report in reports)
    failed = sum(len(report.failures) for report in reports)
    exceptions = sum(report.exceptions.total() for report in reports)
    yield f"{len(editions)} edition{'s' * (len(editions) != 1)} through {', '.join(targets)}:"
    yield f"{passed} cases passed, {failed} failed, {exceptions} cannot be expressed (--conformance-table lists them)"


def table(reports: Iterable[Report]) -> Iterator[str]:
    """Cases of each edition and target by kind, then what each target cannot express."""
    reports = sorted(reports, key=lambda report: (report.edition, report.target))
    yield f"{'edition':<24}{'target':<11}" + "".join(f"{kind:>14}" for kind in (*KINDS, "exceptions", "failed"))
    for report in reports:
        numbers = (*(report.passed[kind] for kind in KINDS), report.exceptions.total(), len(report.failures))
        yield f"{report.edition:<24}{report.target:<11}" + "".join(f"{number:>14}" for number in numbers)
    yield ""
    yield f"{'target':<11}{'cannot':<20}{'cases':>7}{'editions':>10}  reason"
    cases: Counter[tuple[str, str]] = Counter()
    editions: Counter[tuple[str, str]] = Counter()
    for report in reports:
        for name, count in report.exceptions.items():
            cases[report.target, name] += count
            editions[report.target, name] += 1
    for (target, name), count in sorted(cases.items()):
        reason = ADAPTERS[target].cannot.get(name, REASONS.get(name, ""))
        yield f"{target:<11}{name:<20}{count:>7}{editions[target, name]:>10}  {reason}"
