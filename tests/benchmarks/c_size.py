"""Bytes of flash that generated C takes on a Cortex-M0 with -Os, beside what is written by hand for the same job.

python -m tests.benchmarks.c_size
"""

from __future__ import annotations

import struct
import tempfile
from pathlib import Path

from canwright.project.loader import specification
from canwright.targets import c

from ..compilers import CORTEX_M0, WARNINGS, ZIG

SPEC = Path(__file__).parents[2] / "spec" / "mwd_motor" / "v2.35.yaml"
SOURCE = Path(__file__).with_name("c_size.c")
CASES = (
    "all of them in one program",
    "encode set_torque",
    "encode set_speed",
    "decode the reply to set_torque",
    "decode the multi-turn angle",
    "decode status 1",
    "torque current to milliamperes",
)
PROGRAM_BITS = 1
ALLOCATED = 2


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for output in c.generate([specification(SPEC)], {}):
            file = folder / output.path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(output.text, "utf-8")
        print(f"{'bytes on a Cortex-M0 with -Os':32} generated  by hand")
        for number, title in enumerate(CASES):
            case = f"-DCASE={number}"
            print(f"{title:32} {_size(folder, case):9}  {_size(folder, case, '-DBY_HAND'):7}")


def _size(folder: Path, *defines: str) -> int:
    unit = folder / "unit.o"
    flags = (*CORTEX_M0, *WARNINGS, "-Os", *defines, f"-I{folder / 'include'}")
    ZIG.run("c99", *flags, "-c", SOURCE, "-o", unit)
    return flash(unit.read_bytes())


def flash(elf: bytes) -> int:
    """Bytes of a 32-bit ELF object that go to flash: code and constants, without the tables for unwinding."""
    (start,) = struct.unpack_from("<I", elf, 32)
    size, count, names_at = struct.unpack_from("<HHH", elf, 46)
    sections = [struct.unpack_from("<10I", elf, start + i * size) for i in range(count)]
    names = sections[names_at][4]
    total = 0
    for name, kind, flags, _, _, length, *_ in sections:
        title = elf[names + name : elf.index(b"\0", names + name)]
        if kind == PROGRAM_BITS and flags & ALLOCATED and not title.startswith(b".ARM"):
            total += length
    return total


if __name__ == "__main__":
    main()
