"""Compares generated C with C written by hand: instructions on this machine, flash on a Cortex-M0.

    python -m tests.bench.c

Instructions are those of GCC -O2, counted by valgrind. Flash is that of GCC -Os; figures of clang, which comes from
PyPI with zig, have no bar. On Debian: apt-get install gcc gcc-arm-none-eabi valgrind
"""

from __future__ import annotations

import argparse
import re
import struct
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from canwright.project.loader import specification
from canwright.targets import c

from ..compilers import CORTEX_M0, WARNINGS, ZIG
from ..conformance.adapter import write_files
from ..tools import run, tool
from .bars import Measure, report

HERE = Path(__file__).parent
SPEC = HERE.parents[1] / "spec" / "mwd_motor" / "v2.35.yaml"
FUNCTIONS = (
    "all functions below in one program",
    "encode set_torque",
    "encode set_speed",
    "decode the reply to set_torque",
    "decode the multi-turn angle",
    "decode status 1",
    "torque current to milliamperes",
)
ARM_GCC = ("-mcpu=cortex-m0", "-mthumb", "-ffreestanding")
PROGRAM_BITS = 1
ALLOCATED = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table; the exit status is 1 if a figure misses its bar."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = write_files(c.generate([specification(SPEC)], {}), Path(name))
        return report([*_instructions(folder), *_firmware(folder), *_functions(folder)])


def _instructions(folder: Path) -> Iterator[Measure]:
    """Instructions to receive the replies of one control cycle and to convert their fields to values."""
    generated, by_hand = (_executed(folder, *defines) for defines in ((), ("-DBY_HAND",)))
    yield Measure(
        "instructions, replies of all kinds to values, relative to by hand",
        generated / by_hand,
        at_most=1.05,
        note=f"{generated} / {by_hand} a cycle",
    )


def _executed(folder: Path, *defines: str) -> int:
    program, counts = folder / "replies", folder / "counts"
    run(tool("gcc"), "-std=c99", "-O2", *defines, f"-I{folder / 'include'}", HERE / "c_replies.c", "-o", program)
    cycles = int(run(program))
    run(
        tool("valgrind"),
        "--tool=callgrind",
        f"--callgrind-out-file={counts}",
        "--toggle-collect=receive_cycle",
        program,
    )
    total = re.search(r"^totals: (\d+)", counts.read_text("utf-8"), re.M)
    assert total is not None
    return int(total[1]) // cycles


def _firmware(folder: Path) -> Iterator[Measure]:
    """Flash of a firmware that receives three kinds of replies through the decoder of any reply, or of each message."""
    for compiler, bar in (("gcc", 1.2), ("clang", None)):
        any_, each = (_flash(folder, compiler, "c_firmware.c", *d) for d in (("-DANY_REPLY",), ()))
        yield Measure(
            f"flash with {compiler}, decode_reply relative to functions of messages",
            any_ / each,
            at_most=bar,
            note=f"{any_} / {each} bytes",
        )


def _functions(folder: Path) -> Iterator[Measure]:
    for number, title in enumerate(FUNCTIONS):
        generated, by_hand = (
            _flash(folder, "clang", "c_functions.c", f"-DCASE={number}", *d) for d in ((), ("-DBY_HAND",))
        )
        yield Measure(
            f"flash with clang, {title}, relative to by hand",
            generated / by_hand,
            note=f"{generated} / {by_hand} bytes",
        )


def _flash(folder: Path, compiler: str, source: str, *defines: str) -> int:
    """Bytes of flash on a Cortex-M0 with -Os."""
    unit = folder / "unit.o"
    flags: tuple[str | Path, ...] = (
        *WARNINGS,
        "-Os",
        *defines,
        f"-I{folder / 'include'}",
        "-c",
        HERE / source,
        "-o",
        unit,
    )
    if compiler == "gcc":
        run(tool("arm-none-eabi-gcc"), "-std=c99", *ARM_GCC, *flags)
    else:
        ZIG.run("c99", *CORTEX_M0, *flags)
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
    raise SystemExit(main())
