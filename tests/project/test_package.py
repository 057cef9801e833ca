"""The wheel, installed into an empty environment, works in any folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from ..spec_texts import MINIMAL, ROOT


def run(folder: Path, *command: str | Path) -> str:
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    result = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, check=False, env=clean)
    assert result.returncode == 0, f"{command}\n{result.stdout}{result.stderr}"
    return result.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment that has nothing but the wheel and what it asks for."""
    folder = tmp_path_factory.mktemp("install")
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")
    run(folder, *pip, "wheel", "--no-deps", "--wheel-dir", folder, ROOT)
    (wheel,) = folder.glob("canwright-*.whl")
    venv.create(folder / "empty", with_pip=True)
    programs = folder / "empty" / ("Scripts" if os.name == "nt" else "bin")
    run(folder, programs / "python", "-m", "pip", "--disable-pip-version-check", "--quiet", "install", wheel)
    return programs


def test_the_wheel_generates_in_any_folder(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    run(tmp_path, installed / "canwright", "generate", "--spec", "my.yaml", "--out", "out")
    assert (tmp_path / "out/c/include/lamp/v1.h").is_file()
    assert (tmp_path / "out/python/lamp/v1.py").is_file()
    assert (tmp_path / "out/python/lamp/_dispatch.py").is_file()
    assert (tmp_path / "out/dbc/lamp-v1-reply.dbc").is_file()
    assert (tmp_path / "out/docs/en/v1/index.md").is_file()


def test_the_wheel_carries_the_schema(installed: Path, tmp_path: Path) -> None:
    schema = run(tmp_path, installed / "canwright", "schema")
    assert schema == (ROOT / "spec/canwright.schema.json").read_text("utf-8")


def test_the_generated_python_package_installs_and_needs_nothing_else(tmp_path: Path) -> None:
    venv.create(tmp_path / "empty", with_pip=True)
    python = tmp_path / "empty" / ("Scripts" if os.name == "nt" else "bin") / "python"
    package = tmp_path / "python"
    shutil.copytree(ROOT / "generated/python", package)
    run(tmp_path, python, "-m", "pip", "--disable-pip-version-check", "--quiet", "install", package)
    script = "from mwd_motor.v2_35 import MotorOnRequest; print(MotorOnRequest(node=32).encode().hex())"
    assert run(tmp_path, python, "-c", script) == "8800000000000000\n"
    assert "py.typed" in run(tmp_path, python, "-m", "pip", "show", "--files", "mwd_motor")
