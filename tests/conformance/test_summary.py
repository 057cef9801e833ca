"""The summary of golden frames at the end of a run."""

from __future__ import annotations

from collections import Counter

from canwright.conformance.runner import Failure, Report

from .summary import as_data, from_data, summary, table

REPORTS = [
    Report("c", "lamp v1", Counter({"decode": 5, "answer": 2}), Counter({"beyond_double": 1})),
    Report(
        "dbc", "lamp v1", Counter({"decode": 4}), Counter({"exchanges": 2}), [Failure("dbc", "decode", None, "wrong")]
    ),
    Report("dbc", "lamp v2", Counter({"decode": 4}), Counter({"exchanges": 3})),
]


def test_the_summary_has_two_lines() -> None:
    assert list(summary(REPORTS)) == [
        "2 editions through c, dbc:",
        "15 cases passed, 1 failed, 6 cannot be expressed (--conformance-table lists them)",
    ]


def test_the_table_adds_up_what_a_target_cannot_express_and_gives_the_reason() -> None:
    *_, c, dbc = table(REPORTS)
    assert c.split()[:4] == ["c", "beyond_double", "1", "1"] and "no double represents" in c
    assert dbc.split()[:4] == ["dbc", "exchanges", "5", "2"] and "which reply belongs to which request" in dbc


def test_reports_of_another_process_are_complete() -> None:
    assert list(from_data(as_data(REPORTS))) == REPORTS
