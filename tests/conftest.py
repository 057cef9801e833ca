"""Shows at the end of a run how many golden frames went through each target."""

from __future__ import annotations

from typing import Any

import pytest

from .conformance.summary import REPORTS, lines

OF_WORKERS: list[str] = []
"""What was counted in the processes that the tests are shared among."""


def pytest_sessionfinish(session: pytest.Session) -> None:
    output = getattr(session.config, "workeroutput", None)
    if output is not None and REPORTS:
        output["golden frames"] = list(lines())


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    OF_WORKERS.extend(getattr(node, "workeroutput", {}).get("golden frames", ()))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    shown = OF_WORKERS or (list(lines()) if REPORTS else [])
    if shown:
        terminalreporter.section("golden frames")
        for line in shown:
            terminalreporter.write_line(line)
