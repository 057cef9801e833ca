"""The order of the files, caches, packages of markers, and how many golden frames went through each target."""

from __future__ import annotations

import functools
import gc
import os
import signal
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from canwright.__main__ import OBJECTS_BETWEEN_COLLECTIONS
from canwright.conformance.runner import Report
from canwright.project import loader
from canwright.targets.base import EditionInput
from hypothesis import settings

from .compilers import PROGRAMS
from .conformance import summary
from .own_targets import hide

ROOT = Path(__file__).parents[1]

LONGEST = {
    "test_mutation.py",
    "test_readme.py",
    "test_editions.py",
    "test_limits.py",
    "test_compare.py",
    "test_quality.py",
    "test_fuzz.py",
    "test_specs.py",
}
"""These files come first: a worker that started one of them last would run on its own at the end."""

OPTIONAL = {"interop", "machine", "tools"}
"""The markers of tests that use more than the extra `test` installs; they take the packages of `test-interop`."""

OF_WORKERS: list[Report] = []
"""The replays of the processes that the tests are shared among."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--conformance-table",
        action="store_true",
        help="list the golden frames that went through each target, and what targets cannot express",
    )


def pytest_configure() -> None:
    """Hides targets of other packages, collects garbage as the command line does, and loads each committed spec once
    in a process: its edition is frozen. A shell that runs the tests in the background ignores interrupts, and programs
    that the tests start and interrupt would never end. Hypothesis has the same examples in each run, and no time limit."""
    settings.register_profile("same", deadline=None, derandomize=True)
    settings.load_profile("same")
    hide()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    load = loader.specification
    load_once = functools.cache(load)

    def specification(file: Path, *, for_output: bool = True) -> EditionInput:
        return (load_once if ROOT in file.parents else load)(file, for_output=for_output)

    loader.specification = specification


@pytest.fixture(autouse=True, scope="session")
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Records of runs go to a temporary folder, not to that of the user; all workers share compiled programs."""
    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        patch.setenv(PROGRAMS, str(shared / "programs"))
        patch.setenv("ZIG_GLOBAL_CACHE_DIR", os.environ.get("ZIG_GLOBAL_CACHE_DIR", str(shared / "zig")))
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.path.name not in LONGEST)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fails a test whose marker names a package that is not installed."""
    names = {name for marker in item.iter_markers() if marker.name in OPTIONAL for name in marker.args}
    missing = sorted(name for name in names if find_spec(name) is None)
    if missing:
        command = f"{sys.executable} -m pip install -e '.[test-interop]'"
        pytest.fail(f"not installed: {', '.join(missing)}; run: {command}", pytrace=False)


def pytest_sessionfinish(session: pytest.Session) -> None:
    output = getattr(session.config, "workeroutput", None)
    if output is not None:
        output["golden frames"] = summary.as_data(summary.REPORTS)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    OF_WORKERS.extend(summary.from_data(getattr(node, "workeroutput", {}).get("golden frames", ())))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = OF_WORKERS or summary.REPORTS
    if reports:
        terminalreporter.section("golden frames")
        is_complete = terminalreporter.config.getoption("conformance_table")
        for line in (summary.table if is_complete else summary.summary)(reports):
            terminalreporter.write_line(line)
