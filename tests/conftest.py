"""Shows at the end of a run how many golden frames went through each target."""

from __future__ import annotations

import pytest

from .conformance.summary import REPORTS, lines


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if REPORTS:
        terminalreporter.section("golden frames")
        for line in lines():
            terminalreporter.write_line(line)
