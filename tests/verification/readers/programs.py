"""Readers of DBC files that are programs of their own, of the sources beside this module.

Each program gets a file as its argument and frames on standard input, and prints the signals of a frame on one line. Qt is
a Python package. Go and Cargo download can-go, can-dbc and dbc-rs. dbcppp is an installed C++ library and dbcc an installed
program.
"""

from __future__ import annotations

import functools
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path

from ...spec_texts import ROOT
from ...tools import run
from . import Case, Reader, UnsupportedFileError, Values, qt

SOURCES = Path(__file__).parent
BUILD = SOURCES / "build"


class Program(Reader):
    """A reader that is a program, and the tools that build it."""

    tools: Sequence[str]
    unsupported: int | None = None
    """The exit status for a valid file that the reader does not support."""
    unsupported_floats = ""
    """A pattern of the statements SIG_VALTYPE_ that the reader ignores."""

    def is_installed(self) -> bool:
        return all(shutil.which(tool) for tool in self.tools)

    @abstractmethod
    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        """The command that decodes frames with a file; `folder` is for temporary files."""

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        if self.unsupported_floats and re.search(self.unsupported_floats, file.read_text("ascii"), re.MULTILINE):
            raise UnsupportedFileError("it reads floating-point signals as integers")
        frames = "".join(f"{case.can_id | case.extended << 31:X}#{case.data.hex()}\n" for case in cases)
        with tempfile.TemporaryDirectory() as folder:
            command = [str(part) for part in self.program(file, cases, Path(folder))]
            done = subprocess.run(command, input=frames, capture_output=True, text=True, check=False, cwd=ROOT)
        if done.returncode == self.unsupported:
            raise UnsupportedFileError(done.stderr.strip())
        lines = [line.split() for line in done.stdout.splitlines()]
        if done.returncode or len(lines) != len(cases):
            raise ValueError(f"{len(lines)} of {len(cases)} frames decoded; {done.stderr.strip()}")
        return [
            {name: float(value) for name, _, value in (assignment.partition("=") for assignment in line)}
            for line in lines
        ]


class Qt(Program):
    name, tools, source = "qt", (), "pip install PySide6-Addons"
    unsupported = qt.UNSUPPORTED

    def is_installed(self) -> bool:
        return importlib.util.find_spec("PySide6") is not None

    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        return sys.executable, "-m", qt.__name__, file


class CanGo(Program):
    name, tools, source = "can-go", ("go",), "https://go.dev"
    unsupported_floats = r"^SIG_VALTYPE_ .* 2;$"

    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        return _can_go(), file


class Rust(Program):
    """A reader from crates.io."""

    tools, source = ("cargo",), "https://rustup.rs"

    def __init__(self, name: str) -> None:
        self.name = name
        self.unsupported_floats = "^SIG_VALTYPE_ " if name == "dbc-rs" else ""

    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        return _crates() / self.name.replace("-", "_"), file

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        try:
            return super().decode(file, cases)
        except ValueError as error:
            if "Signals overlap within message" in str(error) and "@0" in file.read_text("ascii"):
                raise UnsupportedFileError("it sees an overlap of big-endian signals that share a byte") from error
            if "Too many nodes" in str(error):
                raise UnsupportedFileError("it reads at most 256 nodes") from error
            raise


class Dbcppp(Program):
    name, tools, source = "dbcppp", ("g++",), "https://github.com/xR3b0rn/dbcppp, and g++"

    def is_installed(self) -> bool:
        check = ["g++", "-std=c++17", "-fsyntax-only", str(SOURCES / "dbcppp/main.cpp")]
        return super().is_installed() and not subprocess.run(check, capture_output=True, check=False).returncode

    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        return _dbcppp(), file


class Dbcc(Program):
    """A generator of C, whose functions decode the signals that the golden frames have values of.

    It rounds scales to six digits, so that values at a limit are beyond the limit; frames are decoded without limits.
    """

    name, tools, source = "dbcc", ("dbcc", "gcc"), "https://github.com/howerj/dbcc, and gcc"
    tolerance = 1e-4
    unsupported_floats = "^SIG_VALTYPE_ "

    def program(self, file: Path, cases: Sequence[Case], folder: Path) -> Sequence[str | Path]:
        text = file.read_text("ascii")
        first = subprocess.run(["dbcc", "-D", "-o", str(folder), str(file)], check=False)
        if first.returncode < 0:
            raise UnsupportedFileError("dbcc crashes")
        file.write_text(re.sub(r" \[[^]|]*\|[^]|]*\] ", " [0|0] ", text), "ascii")
        run("dbcc", "-D", "-o", folder, file)
        header = (folder / f"{file.stem}.h").read_text("ascii")
        (structure,) = set(re.findall(r"^int unpack_message\((\w+) ", header, re.MULTILINE))
        decoded = "".join(_decoded(case) for case in cases)
        (folder / "main.c").write_text(
            f'#include <stdio.h>\n#include "{file.stem}.h"\nint main(void)\n{{\n'
            f"    static {structure} o;\n    double value;\n{decoded}    return 0;\n}}\n",
            "ascii",
        )
        run("gcc", "-o", folder / "reader", folder / "main.c", folder / f"{file.stem}.c")
        return (folder / "reader",)


@functools.cache
def _can_go() -> Path:
    run("go", "build", "-o", BUILD / "can_go", cwd=SOURCES / "can_go")
    return BUILD / "can_go"


@functools.cache
def _crates() -> Path:
    run("cargo", "build", "--locked", "--target-dir", BUILD / "rust", cwd=SOURCES / "rust")  # with `.cargo/config.toml`
    return BUILD / "rust/debug"


@functools.cache
def _dbcppp() -> Path:
    BUILD.mkdir(exist_ok=True)
    run("g++", "-std=c++17", "-o", BUILD / "dbcppp", SOURCES / "dbcppp/main.cpp", "-ldbcppp")
    return BUILD / "dbcppp"


def _decoded(case: Case) -> str:
    """The C statements that print the signals of a frame."""
    data = int.from_bytes(case.data.ljust(8, b"\0"), "little")
    lines = [f"unpack_message(&o, 0x{case.can_id:x}, 0x{data:x}, {len(case.data)}, 0);"]
    for name in case.values:
        lines += [f"decode_can_0x{case.can_id:03x}_{name}(&o, &value);", f'printf("{name}=%.17g ", value);']
    return "".join(f"    {line}\n" for line in [*lines, 'puts("");'])


PROGRAMS: Sequence[Reader] = (Qt(), CanGo(), Rust("can-dbc"), Rust("dbc-rs"), Dbcppp(), Dbcc())
