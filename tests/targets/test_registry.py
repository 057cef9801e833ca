"""Targets of other packages that cannot be used: an error line that names the package, and no traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ..spec_texts import MINIMAL


def install(folder: Path, package: str, entry_point: str) -> None:
    """Puts the metadata of an installed package into a folder."""
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text(f"[canwright.targets]\n{entry_point}\n", "utf-8")


@pytest.mark.parametrize(
    ("entry_point", "message"),
    [
        ("csv = missing_module:TARGET", "the target `csv` of the package other cannot be loaded: No module named"),
        ("csv = json:dumps", "the target `csv` of the package other is not an instance of canwright.Target"),
        ("dbc = json:dumps", "both register the target `dbc`; uninstall one of them"),
    ],
)
@pytest.mark.parametrize("command", ["check", "generate"])
def test_an_unusable_target_is_an_error_line(command: str, entry_point: str, message: str, tmp_path: Path) -> None:
    install(tmp_path / "site", "other", entry_point)
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    found = subprocess.run(
        [sys.executable, "-m", "canwright", command, "--spec", "my.yaml"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.returncode, found.stdout) == (2, "")
    assert found.stderr.startswith("canwright: ") and message in found.stderr
    assert found.stderr.count("\n") == 1
    assert not (tmp_path / "generated").exists()
