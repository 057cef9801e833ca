"""What tests need and what is installed: packages of markers, and targets of other packages."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import OPTIONAL, pytest_runtest_setup
from .own_targets import COMMAND
from .spec_texts import ROOT


@pytest.mark.parametrize("marker", sorted(OPTIONAL))
def test_a_package_that_is_not_installed_is_an_error_with_the_command(
    marker: str, request: pytest.FixtureRequest
) -> None:
    request.node.add_marker(getattr(pytest.mark, marker)("pytest", "no_such_package"))
    with pytest.raises(pytest.fail.Exception, match=r"^not installed: no_such_package; run: .* '\.\[test-interop\]'$"):
        pytest_runtest_setup(request.node)


def test_targets_of_other_packages_take_no_part_in_tests(tmp_path: Path) -> None:
    info = tmp_path / "other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text("[canwright.targets]\ncsv = missing_module:TARGET\n", "utf-8")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    command = [sys.executable, "-c", COMMAND, "generate", "--target", "csv"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "Invalid value for '--target'" in done.stderr
