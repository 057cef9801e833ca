"""The headers as packages: CMake with a version, pkg-config, Arduino and PlatformIO."""

from __future__ import annotations

import configparser
import json
import os
import subprocess
import sys
from pathlib import Path

import canwright
import pytest
from canwright.project.loader import specification
from canwright.targets.base import PACKAGE_VERSION

from ..compilers import WARNINGS, ZIG
from ..spec_texts import ROOT, SPECS, called
from ..tools import tool
from ..verification.machines import Avr
from .test_c_compiles import MAIN, cmake, write

ARDUINO = Path(__file__).parent / "arduino"
GENERATED = ROOT / "generated/c"
SKETCH = "mwd_motor_v2_35_sketch"
PRINTED = """\
request 141 A1 0 0 0 64 0 0 0
reply 141 A1 32 0 8 F4 1 E8 3
temperature = 50
iq = 33000 thousandths of A
speed = 500
encoder = 5493 thousandths of deg
ok
"""


def test_generated_packages_have_the_version_of_canwright() -> None:
    assert canwright.__version__ == PACKAGE_VERSION
    assert f'version = "{PACKAGE_VERSION}"\n' in (ROOT / "generated/python/pyproject.toml").read_text("utf-8")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the headers are installed."""
    folder = tmp_path_factory.mktemp("installed")
    cmake("-S", GENERATED, "-B", folder / "build", f"-DCMAKE_INSTALL_PREFIX={folder / 'prefix'}")
    cmake("--install", folder / "build")
    return folder / "prefix"


@pytest.mark.interop("cmake", "ninja")
@pytest.mark.parametrize(
    ("version", "is_found"), [("0.1", True), ("0.1.0", True), ("0.0", False), ("0.2", False), ("1", False)]
)
def test_cmake_finds_compatible_versions(version: str, is_found: bool, prefix: Path, tmp_path: Path) -> None:
    lines = (
        "cmake_minimum_required(VERSION 3.15)",
        "project(use LANGUAGES NONE)",
        f"find_package(mwd_motor {version} REQUIRED)",
        'message(STATUS "found ${mwd_motor_VERSION}")',
    )
    (tmp_path / "CMakeLists.txt").write_text("\n".join(lines), "utf-8")
    arguments = ("-S", tmp_path, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    if is_found:
        assert f"found {PACKAGE_VERSION}" in cmake(*arguments)
    else:
        with pytest.raises(AssertionError, match=r"mwd_motor"):
            cmake(*arguments)


@pytest.mark.interop("cmake", "ninja", "pkgconf")
@pytest.mark.parametrize("where", ["installed", "in place"])
def test_pkg_config_finds_the_headers(where: str, prefix: Path, tmp_path: Path) -> None:
    root = prefix if where == "installed" else GENERATED
    flags = _pkg_config(root, "--cflags", "mwd_motor >= 0.1").split()
    assert _pkg_config(root, "--modversion", "mwd_motor") == PACKAGE_VERSION
    unit = tmp_path / "unit.c"
    unit.write_text("#include <mwd_motor/v2_35_float.h>\n#include <mwd_motor/v2_35_selftest.h>\n", "utf-8")
    ZIG.check("c99", *flags, "-c", unit, "-o", tmp_path / "unit.o")


def _pkg_config(root: Path, *arguments: str) -> str:
    """The output of the pkg-config of PyPI."""
    environment = {**os.environ, "PKG_CONFIG_PATH": str(root / "share/pkgconfig")}
    command = [sys.executable, "-m", "pkgconf", "--define-prefix", *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()


def test_arduino_finds_every_header_below_src(tmp_path: Path) -> None:
    """Arduino searches `src` alone, and recognizes a library by the headers directly in it."""
    names = {str(file.relative_to(GENERATED / "include")) for file in GENERATED.rglob("include/*/*.h*")}
    assert names == {str(file.relative_to(GENERATED / "src")) for file in GENERATED.rglob("src/*/*.h*")}
    assert [file.name for file in GENERATED.glob("src/*.h")] == ["mwd_motor.h"]
    unit = tmp_path / "unit.c"
    lines = ["#include <mwd_motor.h>", *(f"#include <{name}>" for name in sorted(names) if name.endswith(".h"))]
    unit.write_text("\n".join([*lines, ""]), "utf-8")
    ZIG.check("c99", *WARNINGS, f"-I{GENERATED / 'src'}", "-c", unit, "-o", tmp_path / "unit.o")


def test_manifests_are_complete() -> None:
    text = (GENERATED / "library.properties").read_text("utf-8")
    properties = configparser.ConfigParser()
    properties.read_string(f"[library]\n{text}")
    required = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"}
    assert {*properties["library"]} == required | {"includes"}
    assert properties["library"]["version"] == PACKAGE_VERSION
    manifest = json.loads((GENERATED / "library.json").read_text("utf-8"))
    assert (manifest["name"], manifest["version"]) == ("mwd_motor", PACKAGE_VERSION)
    assert (GENERATED / manifest["build"]["includeDir"] / "mwd_motor/v2_35.h").is_file()
    project = configparser.ConfigParser()
    file = GENERATED / f"examples/{SKETCH}/platformio.ini"
    project.read_string(file.read_text("utf-8"))
    assert (file.parent / project["env"]["lib_deps"].removeprefix("symlink://") / "library.json").is_file()
    assert f"env:{project['platformio']['default_envs']}" in project.sections()


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_sketches_run(spec: Path, tmp_path: Path) -> None:
    folder = write([specification(spec)], tmp_path)
    for sketch in folder.glob("examples/*/*.ino"):
        assert sketch.stem == sketch.parent.name
        program = tmp_path / "sketch"
        arguments = (f"-I{folder / 'src'}", _unit(sketch, tmp_path), "-nostdlib++", "-o", program)
        ZIG.run("c++17", *WARNINGS, *arguments)
        printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
        assert printed.endswith("\nok\n")
        if spec == MAIN:
            assert printed == PRINTED


def _unit(sketch: Path, folder: Path) -> Path:
    """A sketch as the Arduino build compiles it: with the core included first."""
    unit = folder / "sketch.cpp"
    unit.write_text(f'#include "{ARDUINO / "Arduino.h"}"\n#include "{sketch}"\n', "utf-8")
    return unit


@pytest.mark.tools
def test_a_sketch_runs_on_an_uno(tmp_path: Path) -> None:
    uno = Avr(name="uno", properties="", mcu="atmega328p")
    program = tmp_path / "sketch.elf"
    uno.build(_unit(GENERATED / f"examples/{SKETCH}/{SKETCH}.ino", tmp_path), GENERATED / "src", program)
    assert uno.run(program) == PRINTED


@pytest.mark.tools
def test_a_sketch_compiles_for_a_cortex_m0(tmp_path: Path) -> None:
    unit = _unit(GENERATED / f"examples/{SKETCH}/{SKETCH}.ino", tmp_path)
    command = [tool("arm-none-eabi-g++"), "-mcpu=cortex-m0", "-mthumb", "-std=gnu++17", "-fno-exceptions", *WARNINGS]
    subprocess.run(
        [*command, f"-I{GENERATED / 'include'}", f"-I{GENERATED / 'src'}", "-c", unit, "-o", tmp_path / "unit.o"],
        check=True,
    )
