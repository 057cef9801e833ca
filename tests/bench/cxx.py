"""Compiles a unit that includes the generated header of about 400 messages, and nothing else: `python -m tests.bench.cxx`.

The C++ header, which includes the C header, is compared with the C header alone. Times are those of the processor, the
least of some runs. On Debian: apt-get install g++
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from canwright.conformance.adapter import write_files
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.rules.too_large import VARIABLE
from canwright.targets.c.target import CTarget

from ..tools import tool
from .bars import Measure, report
from .generate import multiplied

TIMES = 7
"""How often the spec has the commands of the first edition."""
ROUNDS = 5
UNITS_OF_MEMORY = 1 if sys.platform == "darwin" else 1024
"""The bytes of a unit of `ru_maxrss`."""


class Used(NamedTuple):
    """What a compiler used."""

    seconds: float
    megabytes: float


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        return report(list(measures(Path(folder))))


def measures(folder: Path) -> Iterator[Measure]:
    os.environ[VARIABLE] = "1000000"
    item = specification(multiplied(folder, TIMES))
    output = write_files(CTarget().generate([item], {}), folder)
    count = sum(len(list(item.edition.messages(direction))) for direction in Direction)
    header = output / "include" / item.edition.family / item.edition.identifier
    in_c = _compiled("gcc", "-std=c99", header.with_name(f"{header.name}.h"))
    in_cxx = _compiled("g++", "-std=c++17", header.with_name(f"{header.name}.hpp"))
    note = f"{count} messages; the C header: {in_c.seconds:.2f} s"
    yield Measure("unit with the C++ header, user seconds", in_cxx.seconds, at_most=1, note=note)
    yield Measure("unit with the C++ header, MB", in_cxx.megabytes, at_most=100)


def _compiled(compiler: str, standard: str, header: Path) -> Used:
    """The least time of a compiler, and its memory, for a unit that includes a header."""
    unit = header.with_name("unit.cpp" if compiler == "g++" else "unit.c")
    unit.write_text(f'#include "{header.name}"\n', "utf-8")
    return min(_run(tool(compiler), standard, "-c", str(unit), "-o", os.devnull) for _ in range(ROUNDS))


def _run(*command: str) -> Used:
    process = subprocess.Popen(command)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return Used(used.ru_utime, used.ru_maxrss * UNITS_OF_MEMORY / 1e6)


if __name__ == "__main__":
    sys.exit(main())
