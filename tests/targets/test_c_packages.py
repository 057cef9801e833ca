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
request 141 30 0 0 0 0 0 0 0
reply 141 30 0 64 65 32 28 33 34
angle_kp = 100
angle_ki = 101
speed_kp = 50
speed_ki = 40
iq_kp = 51
iq_ki = 52
ok
"""
ON_ESP32 = ("-DESP32", f"-I{ARDUINO}")
REPLY = ("-DREPLY_ID=0x141", "-DREPLY_DATA=0x30,0,0x64,0x65,0x32,0x28,0x33,0x34")
SOCKETS = """\
#define main main_of_the_example
#include "mwd_motor_v2_35_socketcan.c"
#undef main

/* A host and a node on a pair of sockets, which have frames as SocketCAN has them. */
int main(void)
{
    const canwright_frame_t request = {.id = 0x141u, .dlc = 8u, .data = {0x30u}};
    const canwright_frame_t foreign = {.id = 0x142u, .dlc = 8u, .data = {0x30u, 0u, 9u}};
    const canwright_frame_t answer = {
        .id = 0x141u, .dlc = 8u, .data = {0x30u, 0u, 0x64u, 0x65u, 0x32u, 0x28u, 0x33u, 0x34u}};
    canwright_frame_t frame;
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0
        || write(ends[1], &answer, sizeof answer) != (ssize_t)sizeof answer) {
        return 1;
    }
    if (exchange(ends[0], &frame, &request)) {
        return 2; /* a frame that came before the request is not its reply */
    }
    if (read(ends[1], &frame, sizeof frame) != (ssize_t)sizeof frame || memcmp(&frame, &request, sizeof frame) != 0) {
        return 3;
    }
    if (fork() == 0) {
        const bool is_asked = read(ends[1], &frame, sizeof frame) == (ssize_t)sizeof frame;
        const bool is_sent = is_asked && write(ends[1], &foreign, sizeof foreign) == (ssize_t)sizeof foreign;
        _exit(is_sent && write(ends[1], &answer, sizeof answer) == (ssize_t)sizeof answer ? 0 : 1);
    }
    return exchange(ends[0], &frame, &request) && memcmp(&frame, &answer, sizeof frame) == 0 ? 0 : 4;
}
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
        printed = _run(sketch, tmp_path)
        assert printed.endswith("\nok\n")
        if spec == MAIN:
            assert printed == PRINTED
        if "esp32dev" in (sketch.parent / "platformio.ini").read_text("utf-8"):
            assert _run(sketch, tmp_path, *ON_ESP32).endswith("\nno reply\n")


def test_a_sketch_waits_for_the_reply_on_an_esp32(tmp_path: Path) -> None:
    sketch = GENERATED / f"examples/{SKETCH}/{SKETCH}.ino"
    assert _run(sketch, tmp_path, *ON_ESP32, *REPLY) == PRINTED


@pytest.mark.skipif(sys.platform != "linux", reason="SocketCAN is a part of Linux")
@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_programs_for_socketcan_compile(spec: Path, tmp_path: Path) -> None:
    folder = write([specification(spec)], tmp_path)
    for source in folder.glob("examples/*_socketcan.c"):
        ZIG.check("c99", *WARNINGS, f"-I{folder / 'include'}", "-c", source, "-o", tmp_path / "unit.o")


@pytest.mark.skipif(sys.platform != "linux", reason="SocketCAN is a part of Linux")
def test_a_program_for_socketcan_takes_only_the_reply(tmp_path: Path) -> None:
    unit, program, name = tmp_path / "unit.c", tmp_path / "program", "mwd_motor_v2_35_socketcan.c"
    start, short, end = (GENERATED / "examples" / name).read_text("utf-8").partition("TIMEOUT_MS (20 ")
    assert short
    (tmp_path / name).write_text(f"{start}TIMEOUT_MS (500 {end}", "utf-8")  # a busy machine may start the node late
    unit.write_text(SOCKETS, "utf-8")
    ZIG.run("c99", *WARNINGS, f"-I{GENERATED / 'include'}", unit, "-o", program)
    assert subprocess.run([program], check=False).returncode == 0


def _run(sketch: Path, folder: Path, *flags: str) -> str:
    """What a sketch prints."""
    program = folder / "sketch"
    include = sketch.parents[2] / "src"
    ZIG.run("c++17", *WARNINGS, *flags, f"-I{include}", _unit(sketch, folder), "-nostdlib++", "-o", program)
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout


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
