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
    "busybox": "busybox-static",
    "clang": "clang",
    "clang-tidy": "clang-tidy",
    "cpio": "cpio",
    "cppcheck": "cppcheck",
    "dpkg-deb": "dpkg",
    "frama-c": "frama-c-base",
    "g++": "g++",
    "gcc": "gcc",
    "ip": "iproute2",
    "java": "default-jre-headless",
    "npm": "npm",
    "qemu-system-x86_64": "qemu-system-x86",
    "sdcc": "sdcc",
    "simavr": "simavr",
    "tshark": "tshark",
    "valgrind": "valgrind",
}
"""Those of other programs that begin with `qemu-` are in `qemu-user`."""


def tool(name: str) -> str:
    """The path of a program; exits with the name of its package if it is not installed."""
    path = shutil.which(name)
    if path is None:
        package = PACKAGES[name] if name in PACKAGES or not name.startswith("qemu-") else "qemu-user"
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
