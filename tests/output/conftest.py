"""One scenario and one process to fork runs from, for all tests of a worker."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .runs import Runs
from .scenario import Scenario, make_scenario


@pytest.fixture(scope="session")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    return make_scenario(tmp_path_factory.mktemp("scenario"))


@pytest.fixture(scope="session")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    with Runs(tmp_path_factory.mktemp("runs")) as started:
        yield started
