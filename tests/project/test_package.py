"""The wheel, installed into an empty environment, works in any folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest
from canwright.targets.registry import target_names

from ..spec_texts import MINIMAL, ROOT


def run(folder: Path, *command: str | Path) -> str:
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    result = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, check=False, env=clean)
    assert result.returncode == 0, f"{command}\n{result.stdout}{result.stderr}"
    return result.stdout


PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")


def into(python: Path) -> tuple[str, ...]:
    """The pip of this environment for another one, which takes less time than to install it there."""
    return (*PIP[:3], "--python", str(python), *PIP[3:])


def empty(folder: Path) -> Path:
    """The Python of a new environment with nothing in it."""
    venv.create(folder, with_pip=False)
    return folder / ("Scripts" if os.name == "nt" else "bin") / "python"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment that has nothing but the wheel and what it asks for."""
    folder = tmp_path_factory.mktemp("install")
    run(folder, *PIP, "wheel", "--no-deps", "--wheel-dir", folder, ROOT)
    (wheel,) = folder.glob("canwright-*.whl")
    python = empty(folder / "empty")
    run(folder, *into(python), "install", "--no-compile", wheel)
    return python.parent


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


def test_the_wheel_identifies_editions_without_a_clone(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "bus.log").write_text("141#9A00000000000000\n141#9A32081364000000\n", "utf-8")
    assert "node 1, 2 frames: fits v2.35-2024-02\n" in run(tmp_path, installed / "canwright", "identify", "bus.log")


def test_the_wheel_tests_a_new_spec(installed: Path, tmp_path: Path) -> None:
    run(tmp_path, installed / "canwright", "init", "lamp")
    printed = run(tmp_path, installed / "canwright", "test", "--target", "reference", "--target", "python")
    assert [line.split()[2:] for line in printed.splitlines()[1:]] == [
        [target, "4", "4", "0", "0"] for target in ("reference", "python")
    ]
    assert [path.name for path in tmp_path.iterdir()] == ["spec"]


def test_the_generated_python_package_installs_and_needs_nothing_else(tmp_path: Path) -> None:
    python = empty(tmp_path / "empty")
    package = tmp_path / "python"
    shutil.copytree(ROOT / "generated/python", package)
    run(tmp_path, *into(python), "install", package)
    script = "from mwd_motor.v2_35 import MotorOnRequest; print(MotorOnRequest(node=32).encode().hex())"
    assert run(tmp_path, python, "-c", script) == "8800000000000000\n"
    assert "py.typed" in run(tmp_path, *into(python)[:-1], "show", "--files", "mwd_motor")


@pytest.fixture(scope="module")
def with_csv(installed: Path) -> Path:
    """The same environment with a target from another package."""
    run(installed, *into(installed / "python"), "install", Path(__file__).parent / "csv_target")
    return installed


def test_a_target_of_another_package_is_listed_and_generates(with_csv: Path, tmp_path: Path) -> None:
    assert f"[{'|'.join(sorted(('csv', *target_names())))}]" in run(
        tmp_path, with_csv / "canwright", "generate", "--help"
    ).replace("\n", "").replace(" ", "")
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    run(tmp_path, with_csv / "canwright", "generate", "--spec", "my.yaml", "--out", "out", "--target", "csv")
    assert [file.relative_to(tmp_path).as_posix() for file in (tmp_path / "out").rglob("*.csv")] == [
        "out/csv/lamp-v1.csv"
    ]
    assert (tmp_path / "out/csv/lamp-v1.csv").read_text("utf-8").splitlines() == [
        "message,direction,field,bits,type,unit",
        "dim_request,request,level,16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31,level,%",
        "dim_reply,reply,level,16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31,level,%",
    ]
    run(tmp_path, with_csv / "canwright", "check", "--spec", "my.yaml", "--out", "out", "--target", "csv")


def test_a_target_of_another_package_rejects_names(with_csv: Path, tmp_path: Path) -> None:
    (tmp_path / "my.yaml").write_text(MINIMAL.replace("request: {level:", "request: {order:"), "utf-8")
    command = [str(with_csv / "canwright"), "check", "--spec", "my.yaml"]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "`order` is a reserved word of SQL [name-collision]" in result.stderr


def test_a_target_of_another_package_names_what_to_rename(with_csv: Path, tmp_path: Path) -> None:
    (tmp_path / "old.yaml").write_text(MINIMAL, "utf-8")
    (tmp_path / "new.yaml").write_text(MINIMAL.replace("request: {level:", "request: {brightness:"), "utf-8")
    assert "CSV `level` → `brightness`" in run(tmp_path, with_csv / "canwright", "diff", "old.yaml", "new.yaml")
