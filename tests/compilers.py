"""C and C++ compilers for tests: those of the machine where there are any, and the one from PyPI, which is always there."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

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

    def run(self, standard: str, *arguments: str | Path) -> None:
        """Compiles; fails with what the compiler says."""
        is_cxx = standard.startswith("c++")
        command = [*(self.cxx if is_cxx else self.c), f"-std={standard}", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(f"{' '.join(command)}\n{done.stdout}{done.stderr}")


ZIG = Compiler("zig", (sys.executable, "-m", "ziglang", "cc"), (sys.executable, "-m", "ziglang", "c++"))


def compilers() -> list[Compiler]:
    """The compilers there are; the one from PyPI is a clang, and takes its place where that is missing."""
    pairs = (("gcc", "g++"), ("clang", "clang++"))
    found = [Compiler(c, (c,), (cxx,)) for c, cxx in pairs if shutil.which(c) and shutil.which(cxx)]
    return found if any(compiler.name == "clang" for compiler in found) else [*found, ZIG]


def build(sources: Sequence[Path], include: Path, program: Path, *flags: str, standard: str = "c99") -> Path:
    """A program, made by the first compiler."""
    first = compilers()[0]
    first.run(standard, *WARNINGS, "-O1", *flags, f"-I{include}", *sources, "-o", program)
    return program
