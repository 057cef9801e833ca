"""The registered targets: those of canwright are tested as targets; one of another package may be unusable."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ..conformance.adapters import ADAPTERS
from ..spec_texts import MINIMAL, ROOT

PROJECT = (ROOT / "pyproject.toml").read_text("utf-8")
WITHOUT_ADAPTER = {
    "handover": "its tables name ids and codes in texts for readers; tests/project/test_handover.py decodes golden frames with their fields"
}


def test_own_targets_replay_golden_frames_and_import_no_other_target() -> None:
    own = set(re.findall(r'^(\w+) = "canwright\.targets\.', PROJECT, re.MULTILINE))
    assert own == set(re.findall(r'^  "canwright\.targets\.(\w+)",$', PROJECT, re.MULTILINE))
    assert own == set(WITHOUT_ADAPTER) | set(ADAPTERS) - {"reference", "cxx"}


def install(folder: Path, package: str, entry_point: str) -> None:
    """Puts the metadata of an installed package into a folder."""
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text(f"[canwright.targets]\n{entry_point}\n", "utf-8")


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """canwright in a folder, with the packages in `site` installed."""
    return subprocess.run(
        [sys.executable, "-m", "canwright", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder / "site")},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("command", ["check", "generate"])
def test_a_target_that_exits_when_it_is_imported_is_an_error_line(command: str, tmp_path: Path) -> None:
    install(tmp_path / "site", "other", "csv = canwright_exits:TARGET")
    (tmp_path / "site/canwright_exits.py").write_text("import sys\nsys.exit(0)\n", "utf-8")
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    result = run(tmp_path, command, "--spec", "my.yaml")
    assert (result.returncode, result.stdout) == (2, "")
    assert "the target `csv` of the package other cannot be loaded: it exits with 0" in result.stderr


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
    result = run(tmp_path, command, "--spec", "my.yaml")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith("canwright: ") and message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "generated").exists()


@pytest.fixture
def with_csv(tmp_path: Path) -> Path:
    """A folder with a spec, and the target of another package, which declares an option."""
    install(tmp_path / "site", "other", "csv = canwright_csv:TARGET")
    shutil.copy(ROOT / "tests/project/csv_target/canwright_csv.py", tmp_path / "site")
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    return tmp_path


def test_an_option_of_a_target_of_another_package(with_csv: Path) -> None:
    listed = " ".join(run(with_csv, "generate", "--help").stdout.split())
    assert "--delimiter DELIMITER What separates the columns of the CSV files: , or ; or tab." in listed
    generate = ("generate", "--spec", "my.yaml", "--out", "out", "--target", "csv")
    for given, first in ((("--delimiter", ";"), "message;direction;"), ((), "message,direction,")):
        assert run(with_csv, *generate, *given).returncode == 0
        assert (with_csv / "out/csv/lamp-v1.csv").read_text("utf-8").startswith(first)
        assert run(with_csv, "check", *generate[1:], *given).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--target", "csv", "--delimiter", "x"], "--delimiter x: the delimiter is one of: , ; tab"),
        (["--delimiter", ";"], "--delimiter affects only the target csv; add --target csv"),
        (
            ["--target", "csv", "--target", "dbc", "--nodes", "1"],
            "--nodes affects only the target dbc; add --target dbc",
        ),
    ],
)
@pytest.mark.parametrize("command", ["check", "generate"])
def test_an_option_that_a_target_rejects(command: str, arguments: list[str], message: str, with_csv: Path) -> None:
    result = run(with_csv, command, "--spec", "my.yaml", *arguments)
    assert (result.returncode, result.stderr.splitlines()[-1]) == (2, f"canwright: {message}")


def test_a_target_must_not_declare_an_option_of_the_command(with_csv: Path) -> None:
    module = with_csv / "site/canwright_csv.py"
    module.write_text(module.read_text("utf-8").replace('name="delimiter"', 'name="out"'), "utf-8")
    result = run(with_csv, "generate", "--spec", "my.yaml")
    assert result.returncode == 2
    assert "the target `csv` declares the option --out, which canwright has already" in result.stderr
