"""The exit status of a benchmark."""

from __future__ import annotations

import pytest

from .bars import Measure, report


@pytest.mark.parametrize(
    ("measure", "status"),
    [
        (Measure("size", 1.2, at_most=1.2), 0),
        (Measure("size", 1.3, at_most=1.2), 1),
        (Measure("speed", 2.7, at_least=2.7), 0),
        (Measure("speed", 2.6, at_least=2.7), 1),
        (Measure("time", 1e9), 0),
    ],
)
def test_exit_status_follows_the_bars(measure: Measure, status: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert report([Measure("other", 1.0, at_most=1.0), measure]) == status
    assert ("MISSED" in capsys.readouterr().out) is bool(status)
