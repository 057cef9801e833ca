"""C and C++ compilers for tests: the one from PyPI always, and those of the machine in the tests marked `machine`."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from filelock import FileLock

PROGRAMS = "CANWRIGHT_TEST_PROGRAMS"

WARNINGS = (
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wcast-qual",
    "-Wundef",
    "-Wdouble-promotion",
    "-Wfloat-equal",
    "-Werror",
)
LEVELS = ("-O0", "-O2", "-O3", "-Os")
STANDARDS = ("c99", "c11", "c++17")
CORTEX_M0 = ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m0", "-ffreestanding")


@dataclass(frozen=True)
class Compiler:
    """A command for C and one for C++."""

    name: str
    c: tuple[str, ...]
    cxx: tuple[str, ...]
    for_messages: tuple[str, ...] = ()
    """Flags that leave out what has no effect on the messages about a unit."""

    def run(self, standard: str, *arguments: str | Path) -> None:
        """Compiles; fails with the output of the compiler."""
        is_cxx = standard.startswith("c++")
        command = [*(self.cxx if is_cxx else self.c), f"-std={standard}", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(f"{' '.join(command)}\n{done.stdout}{done.stderr}")

    def check(self, standard: str, *arguments: str | Path) -> None:
        """Compiles units for the messages of the compiler alone: the object file may have no code of the machine."""
        self.run(standard, *arguments, *self.for_messages)


_TARGET = ("-target", "native-linux-gnu") if sys.platform == "linux" else ()
"""Makes zig use its own C library: by default it asks the C compiler of the machine, if there is one, for another."""

_TRAP = "-fsanitize-trap=undefined"
"""Stops a program of zig at whatever the language leaves undefined, which it checks unless it optimizes. Without a trap,
zig builds the library that describes it, which takes half a minute."""

_PACKAGE = find_spec("ziglang")
assert _PACKAGE and _PACKAGE.origin
ZIG_COMMAND = (str(Path(_PACKAGE.origin).with_name("zig")),)
"""The program in the package, without an interpreter of Python before each of its runs."""

_FOR_MESSAGES = ("-O0", "-g0", "-fno-sanitize=all", "-emit-llvm")
"""The warnings of zig depend neither on the level nor on the code of the machine, which take most of the time."""

ZIG = Compiler("zig", (*ZIG_COMMAND, "cc", *_TARGET, _TRAP), (*ZIG_COMMAND, "c++", *_TARGET, _TRAP), _FOR_MESSAGES)

_PAIRS = (("gcc", "g++"), ("clang", "clang++"))
OF_MACHINE = [Compiler(c, (c,), (cxx,)) for c, cxx in _PAIRS if shutil.which(c) and shutil.which(cxx)]

each_compiler = pytest.mark.parametrize(
    "compiler",
    [ZIG, *(pytest.param(compiler, marks=pytest.mark.machine) for compiler in OF_MACHINE)],
    ids=lambda compiler: compiler.name,
)
"""Runs a test with the compiler from PyPI, and once more with each of the machine under `-m machine`."""


SANITIZED = ("-fsanitize=undefined", _TRAP)
"""Stops a program of any compiler at whatever the language leaves undefined."""


def build(
    sources: Sequence[Path],
    include: Path,
    program: Path,
    *flags: str,
    standard: str = "c99",
    compiler: Compiler = ZIG,
) -> Path:
    """A program from sources in C; without other flags it is not optimized, which takes ten times as long, and stops where it
    is wrong.

    Processes of one test run compile equal files once: `PROGRAMS` of the environment is the folder that they share.
    """
    options = (*WARNINGS, *(flags or ("-O0", "-g0", *SANITIZED)))
    if compiler is ZIG and standard.startswith("c++"):
        options += ("-nostdlib++",)  # zig would first build the library, for a minute
    if PROGRAMS not in os.environ:
        compiler.run(standard, *options, f"-I{include}", *sources, "-o", program)
        return program
    headers = sorted(file for file in include.rglob("*") if file.is_file())
    parts = [repr((compiler, standard, options)), *(str(file.relative_to(include)) for file in headers)]
    contents = [part.encode() for part in parts] + [file.read_bytes() for file in (*headers, *sources)]
    digest = hashlib.sha256(b"".join(hashlib.sha256(content).digest() for content in contents)).hexdigest()
    shared = Path(os.environ[PROGRAMS]) / digest
    shared.parent.mkdir(exist_ok=True)
    with FileLock(shared.with_suffix(".lock")):
        if not shared.exists():
            compiler.run(standard, *options, f"-I{include}", *sources, "-o", program)
            shutil.copy(program, shared)
    program.unlink(missing_ok=True)
    os.link(shared, program)
    return program
