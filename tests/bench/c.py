"""Compares generated C with C written by hand: instructions on this machine, flash on a Cortex-M0 and on a Cortex-M4F.

    python -m tests.bench.c

Instructions are those of GCC -O2: executed ones are counted by valgrind, those of a decoder in its code. Flash is that of
-Os with GCC and with clang, which comes from PyPI with zig. On Debian: apt-get install gcc gcc-arm-none-eabi valgrind

The programs by hand check what the generated ones check, and set the same bytes; the first comment of each lists it. The
firmware by hand has a function for each message that returns why a frame is rejected, as generated code does. One `switch`
without reasons, which checks the node once for three requests, is smaller than any such functions: the notes state its size.
"""

from __future__ import annotations

import argparse
import re
import struct
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget

from ..compilers import CORTEX_M0, WARNINGS, ZIG
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
    "decode status 3",
)
DECODERS = {3: 1.0, 4: 1.15, 5: 1.15, 7: 1.15}
"""The functions whose instructions on this machine are counted, and their bars."""
MIXES = {"raw integers": ("c_mix.c", 1.05), "values": ("c_replies.c", 1.15)}
"""What a host makes of the replies of one control cycle: its program, and the bar of executed instructions."""
RECEIVERS = {
    "functions of messages": ((), 1.05),
    "identify_reply and _unpack": (("-DIDENTIFY",), 1.05),
    "decode_reply": (("-DANY_REPLY",), 1.33),
}
"""The ways to receive replies in the firmware, with the bars of flash for each compiler and processor."""
FLASH_BARS = 1.05, 1.15
"""Of all functions together, and of each alone, beside the same by hand."""
ARM: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "Cortex-M0": (("-mcpu=cortex-m0",), CORTEX_M0),
    "Cortex-M4F": (
        ("-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"),
        ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4", "-ffreestanding"),
    ),
}
"""The flags of GCC and of clang for each processor."""
ARM_GCC = ("-mthumb", "-ffreestanding")
PROGRAM_BITS = 1
ALLOCATED = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table; the exit status is 1 if a figure misses its bar."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = write_files(CTarget().generate([specification(SPEC)], {}), Path(name))
        return report(
            [*_instructions(folder), *_decoders(folder), *_firmware(folder), *_functions(folder), *_values(folder)]
        )


def _instructions(folder: Path) -> Iterator[Measure]:
    """Instructions to receive the replies of one control cycle through `decode_reply`."""
    for title, (source, bar) in MIXES.items():
        generated, by_hand = (_executed(folder, source, *defines) for defines in ((), ("-DBY_HAND",)))
        yield _relative(f"instructions, replies of all kinds to {title}", generated, by_hand, "a cycle", bar)


def _executed(folder: Path, source: str, *defines: str) -> int:
    program, counts = folder / "replies", folder / "counts"
    run(tool("gcc"), "-std=c99", "-O2", *defines, f"-I{folder / 'include'}", HERE / source, "-o", program)
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


def _decoders(folder: Path) -> Iterator[Measure]:
    """Instructions in the code of each decoder, with all that it calls inlined."""
    for number, bar in DECODERS.items():
        count, by_hand = (_counted(folder, f"-DCASE={number}", *defines) for defines in ((), ("-DBY_HAND",)))
        yield _relative(f"instructions, {FUNCTIONS[number]}", count, by_hand, "instructions", bar)


def _counted(folder: Path, *defines: str) -> int:
    unit = folder / "unit.o"
    include = f"-I{folder / 'include'}"
    run(tool("gcc"), "-std=c99", "-O2", *defines, include, "-c", HERE / "c_functions.c", "-o", unit)
    code = run(tool("objdump"), "-d", "--no-show-raw-insn", unit)
    return len(re.findall(r"^ +[0-9a-f]+:\t(?!nop|data16|cs )", code, re.M))


def _relative(title: str, generated: int, by_hand: int, unit: str, bar: float | None) -> Measure:
    note = f"{generated} / {by_hand} {unit}"
    return Measure(f"{title}, relative to by hand", generated / by_hand, at_most=bar, note=note)


def _firmware(folder: Path) -> Iterator[Measure]:
    """Flash of a firmware that receives three kinds of replies."""
    for processor in ARM:
        for compiler in ("gcc", "clang"):
            by_hand, one_switch = (
                _flash(folder, processor, compiler, "c_firmware.c", define)
                for define in ("-DBY_HAND", "-DBY_HAND_SWITCH")
            )
            for title, (defines, bar) in RECEIVERS.items():
                size = _flash(folder, processor, compiler, "c_firmware.c", *defines)
                title = f"flash of a firmware, {processor}, {compiler}, {title}"
                yield _relative(title, size, by_hand, f"bytes; {one_switch} in one switch", bar)


def _functions(folder: Path) -> Iterator[Measure]:
    for number, title in enumerate(FUNCTIONS):
        for compiler in ("gcc", "clang"):
            size, by_hand = (
                _flash(folder, "Cortex-M0", compiler, "c_functions.c", f"-DCASE={number}", *defines)
                for defines in ((), ("-DBY_HAND",))
            )
            yield _relative(f"flash with {compiler}, {title}", size, by_hand, "bytes", FLASH_BARS[number > 0])


def _values(folder: Path) -> Iterator[Measure]:
    """Flash of a program for values in floating point, with the functions of the compiler's library that it calls."""
    for value, bar in (("float", 1.05), ("double", 1.1)):
        for compiler in ("gcc", "clang"):
            size, by_hand = (_linked(folder, compiler, f"-DVALUE={value}", *more) for more in ((), ("-DBY_HAND",)))
            yield _relative(f"flash of replies to {value}, Cortex-M4F, {compiler}", size, by_hand, "bytes", bar)


def _linked(folder: Path, compiler: str, *defines: str) -> int:
    """Bytes of flash of a whole program, with the library of GCC."""
    unit, program = _compiled(folder, "Cortex-M4F", compiler, "c_replies.c", *defines), folder / "values.elf"
    flags = (*ARM["Cortex-M4F"][0], *ARM_GCC, "-nostdlib", "-Wl,-e,receive_cycle", "-Wl,--gc-sections")
    run(tool("arm-none-eabi-gcc"), *flags, unit, "-lgcc", "-o", program)
    return flash(program.read_bytes())


def _flash(folder: Path, processor: str, compiler: str, source: str, *defines: str) -> int:
    """Bytes of flash with -Os."""
    return flash(_compiled(folder, processor, compiler, source, *WARNINGS, *defines).read_bytes())


def _compiled(folder: Path, processor: str, compiler: str, source: str, *flags: str) -> Path:
    """The object file of a program with -Os."""
    unit, (gcc, clang) = folder / "unit.o", ARM[processor]
    arguments: tuple[str | Path, ...] = (*flags, "-Os", f"-I{folder / 'include'}", "-c", HERE / source, "-o", unit)
    if compiler == "gcc":
        run(tool("arm-none-eabi-gcc"), "-std=c99", *gcc, *ARM_GCC, *arguments)
    else:  # without the trap of zig, which is for tests, and without tables that are not in flash
        ZIG.run("c99", *clang, "-fno-unwind-tables", "-fno-asynchronous-unwind-tables", *arguments, "-fno-sanitize=all")
    return unit


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
