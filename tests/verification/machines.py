"""Machines that generated C runs on: compilers for them, and emulators that run the programs."""

from __future__ import annotations

import re
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..compilers import ZIG_COMMAND
from ..tools import tool


@dataclass(frozen=True, kw_only=True)
class Machine(ABC):
    """A kind of computer; `build` makes a program of one C source, `run` returns what it prints.

    `properties` is what makes the machine worth a run.
    """

    name: str
    properties: str

    @abstractmethod
    def build(self, source: Path, include: Path, program: Path) -> None: ...

    @abstractmethod
    def run(self, program: Path) -> str: ...


@dataclass(frozen=True, kw_only=True)
class Emulated(Machine):
    """A Linux machine: zig compiles for it, and qemu runs the program; without `emulator` it runs directly."""

    target: str
    emulator: str = ""
    flags: tuple[str, ...] = ()

    def build(self, source: Path, include: Path, program: Path) -> None:
        _run(
            [
                *ZIG_COMMAND,
                "cc",
                "-target",
                self.target,
                *self.flags,
                *_FLAGS,
                "-static",
                f"-I{include}",
                source,
                "-o",
                program,
            ]
        )

    def run(self, program: Path) -> str:
        return _run([*([tool(self.emulator)] if self.emulator else []), program])


@dataclass(frozen=True, kw_only=True)
class Avr(Machine):
    """An AVR microcontroller in simavr, which shows the bytes that the program sends to the first UART."""

    mcu: str

    def build(self, source: Path, include: Path, program: Path) -> None:
        compiler = tool("avr-g++" if source.suffix == ".cpp" else "avr-gcc")
        standard = "-std=gnu++11" if source.suffix == ".cpp" else "-std=c99"
        _run([compiler, standard, f"-mmcu={self.mcu}", *_FLAGS, f"-I{include}", source, "-o", program])

    def run(self, program: Path) -> str:
        output = _run([tool("simavr"), "-m", self.mcu, "-f", "16000000", program])
        lines = (_COLOUR.sub("", line).rstrip() for line in output.splitlines() if _COLOUR.search(line))
        return "".join(f"{line.removesuffix('.')}\n" for line in lines if line.endswith("."))


_COLOUR = re.compile(r"\x1b\[\d+m")
"""simavr shows sent bytes in colour, and a line feed as a point."""

_FLAGS = ("-Os", "-g0", "-Wall", "-Wextra", "-Werror")


def _run(command: Sequence[str | Path]) -> str:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, errors="replace")
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr
