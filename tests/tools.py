"""Programs of the machine that tests and commands run, and the Debian packages that contain them."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

PACKAGES: Mapping[str, str] = {
    "arm-none-eabi-g++": "gcc-arm-none-eabi",
    "arm-none-eabi-gcc": "gcc-arm-none-eabi",
    "avr-g++": "gcc-avr avr-libc",
    "avr-gcc": "gcc-avr avr-libc",
    "clang": "clang",
    "clang-tidy": "clang-tidy",
    "cpio": "cpio",
    "cppcheck": "cppcheck",
    "frama-c": "frama-c-base",
    "g++": "g++",
    "gcc": "gcc",
    "java": "default-jre-headless",
    "npm": "npm",
    "sdcc": "sdcc",
    "simavr": "simavr",
    "tshark": "tshark",
    "valgrind": "valgrind",
}
"""Those of programs that begin with `qemu-` are in `qemu-user`."""


def tool(name: str) -> str:
    """The path of a program; exits with the name of its package if it is not installed."""
    path = shutil.which(name)
    if path is None:
        package = "qemu-user" if name.startswith("qemu-") else PACKAGES[name]
        raise SystemExit(f"{name} is not installed; on Debian: apt-get install {package}")
    return path


def run(*command: str | Path, cwd: Path | None = None) -> str:
    """The output of a command that succeeds; raises AssertionError with the output of one that fails."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def output(*command: str | Path) -> str:
    """All output of a command, which may fail: that of a checker with findings."""
    done = subprocess.run(
        [*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    return done.stdout
