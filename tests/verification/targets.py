"""Runs the self-test of every spec on machines of other byte orders and sizes of integers.

zig (from PyPI) compiles for Linux machines, and qemu runs the programs; avr-gcc and simavr serve the microcontroller. The
exit status is 1 if a case fails, and 2 if a tool is missing.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget

from ..spec_texts import SPECS, called
from .machines import Avr, Emulated, Machine

NATIVE = Emulated(name="x86_64", properties="64-bit", target="x86_64-linux-musl")

MACHINES: Sequence[Machine] = (
    NATIVE,
    Emulated(name="i386", properties="32-bit", target="x86-linux-musl", emulator="qemu-i386"),
    Emulated(name="s390x", properties="64-bit, big-endian", target="s390x-linux-musl", emulator="qemu-s390x"),
    Emulated(name="powerpc", properties="32-bit, big-endian", target="powerpc-linux-musleabi", emulator="qemu-ppc"),
    Emulated(name="mips", properties="32-bit, big-endian", target="mips-linux-musleabi", emulator="qemu-mips"),
    Emulated(name="arm", properties="32-bit, char unsigned", target="arm-linux-musleabi", emulator="qemu-arm"),
    Emulated(name="aarch64", properties="64-bit", target="aarch64-linux-musl", emulator="qemu-aarch64"),
    Emulated(name="riscv64", properties="64-bit", target="riscv64-linux-musl", emulator="qemu-riscv64"),
    Emulated(name="riscv32", properties="32-bit", target="riscv32-linux-musl", emulator="qemu-riscv32"),
    Avr(name="avr", properties="int of 16 bits", mcu="atmega2560"),
)

PROGRAM = """\
#include <{header}>

#if defined(__AVR__)
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
static void send(char character)
{{
    while ((UCSR0A & (1u << UDRE0)) == 0u) {{
    }}
    UDR0 = (uint8_t)character;
}}
static void stop(void)
{{
    cli();
    sleep_mode(); /* Ends the simulation, as no interrupt can occur. */
}}
static void start(void)
{{
    UCSR0B = 1u << TXEN0;
}}
#else
#include <stdio.h>
static void send(char character)
{{
    putchar(character);
}}
static void stop(void)
{{
}}
static void start(void)
{{
}}
#endif

static void number(uint16_t value)
{{
    if (value > 9u) {{
        number((uint16_t)(value / 10u));
    }}
    send((char)('0' + value % 10u));
}}

int main(void)
{{
    canwright_{fd}selftest_t result;
    start();
    (void){function}(&result);
    number(result.cases);
    send(' ');
    number(result.failures);
    send(' ');
    number(result.first);
    send(' ');
    number((uint16_t)result.step);
    send('\\n');
    stop();
    return 0;
}}
"""


class Result(NamedTuple):
    """The result of a self-test on a machine; `first` and `step` describe the first failure."""

    cases: int
    failures: int
    first: int
    step: int


def write(item: EditionInput, folder: Path) -> Path:
    """Writes the headers and the program of an edition; returns the source of the program."""
    for output in CTarget().generate([item], {}):
        file = folder / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    edition = item.edition
    header = f"{edition.family}/{edition.identifier}_selftest.h"
    function = f"{edition.family}_{edition.identifier}_selftest".lower()
    source = folder / "selftest.c"
    fd = "fd_" if edition.bus.frame_format.is_fd else ""
    source.write_text(PROGRAM.format(header=header, function=function, fd=fd), "utf-8")
    return source


def run(machine: Machine, source: Path) -> Result:
    """Builds and runs the self-test. Raises AssertionError with the output of a failed command."""
    program = source.with_suffix(f".{machine.name}")
    machine.build(source, source.parent / "include", program)
    output = machine.run(program)
    numbers = output.split()
    assert len(numbers) == len(Result._fields), f"{machine.name} printed: {output}"
    return Result(*map(int, numbers))


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints a table; the exit status."""
    parser = argparse.ArgumentParser(
        "python -m tests.verification.targets",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "machines",
        nargs="*",
        metavar="MACHINE",
        help=f"of {', '.join(machine.name for machine in MACHINES)} (default: all)",
    )
    names = parser.parse_args(arguments).machines
    machines = [machine for machine in MACHINES if not names or machine.name in names]
    unknown = set(names) - {machine.name for machine in machines}
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; machines are: {', '.join(m.name for m in MACHINES)}")
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        sources = {called(spec): write(specification(spec), Path(folder) / called(spec)) for spec in SPECS}
        print(f"{'machine':<10}{'properties':<24}{'edition':<26}{'cases':>7}{'failures':>10}")
        for machine in machines:
            for edition, source in sources.items():
                result = run(machine, source)
                first = f"  first: case {result.first}, step {result.step}" if result.failures else ""
                counts = f"{result.cases:>7}{result.failures:>10}{first}"
                print(f"{machine.name:<10}{machine.properties:<24}{edition:<26}{counts}", flush=True)
                failures += result.failures
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
