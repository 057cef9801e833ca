"""The self-test of the C headers, compiled and run with a C compiler of the machine."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from ..model.golden_frames import GoldenFrames
from ..targets.base import EditionInput
from ..targets.c.selftest import SelfTest
from ..targets.c.target import CTarget
from ..targets.c.view import edition_view
from .adapter import write_files
from .runner import Failure, Report

COMPILERS = ("cc", "gcc", "clang", "tcc", "zig cc")

CANNOT = {"values": "the self-test leaves out values in units, and raw integers that no variable of C contains"}

_PROGRAM = """\
#include <stdio.h>
#include <{family}/canwright_{fd}selftest.h>

static void count(canwright_{fd}selftest_t *result, canwright_step_t step, const canwright_{fd}frame_t *frame)
{{
    canwright_{fd}selftest_count(result, step, frame);
    if (step != CANWRIGHT_STEP_NONE) {{
        printf("%u %s\\n", (unsigned)result->cases, canwright_step_text(step));
    }}
}}

#define canwright_{fd}selftest_count count
#include <{family}/{edition}_selftest.h>

int main(void)
{{
    canwright_{fd}selftest_t result;
    (void){prefix}_selftest(&result);
    printf("%u\\n", (unsigned)result.cases);
    return 0;
}}
"""
"""Prints each case that fails with its step, then the number of cases."""


def compiler() -> Sequence[str] | None:
    """The command of a C compiler: that in `CC`, or the first that is installed; None without one."""
    commands = (shlex.split(command) for command in (os.environ.get("CC", ""), *COMPILERS))
    installed = next((command for command in commands if command and shutil.which(command[0])), None)
    return installed or ([sys.executable, "-m", "ziglang", "cc"] if find_spec("ziglang") else None)


def replay(item: EditionInput, frames: GoldenFrames, command: Sequence[str], workdir: Path) -> Report:
    """Runs the self-test of the golden frames of an edition."""
    edition = item.edition
    report = Report("c", f"{edition.family} {edition.name}")
    view = edition_view(edition)
    folder = write_files(CTarget().generate([item], {}), workdir)
    source, program = folder / "selftest.c", folder / "selftest.exe"
    names = {"family": edition.family, "edition": edition.identifier, "fd": view.fd}
    source.write_text(_PROGRAM.format(**names, prefix=f"{edition.family}_{edition.identifier}".lower()), "utf-8")
    build = [*command, "-std=c99", f"-I{folder / 'include'}", str(source), "-o", str(program)]
    output = ""
    for arguments in (build, [str(program)]):
        done = subprocess.run(arguments, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode:
            reason = next((line for line in done.stderr.splitlines() if "error" in line), f"status {done.returncode}")
            wrong = f"{Path(arguments[0]).name}: {reason.replace(f'{folder}{os.sep}', '')}"
            report.failures.append(Failure("c", "self-test", None, wrong))
            report.asked = report.failed = len(frames.entries)
            return report
        output = done.stdout
    *failed, cases = output.splitlines()
    entries = [case.golden for case in SelfTest(edition, frames, view).cases if case.golden]
    for line in failed:
        case, _, text = line.partition(" ")
        report.failures.append(Failure("c", "self-test", entries[int(case) - 1], text))
    report.asked, report.failed = int(cases), len(failed)
    if left_out := len(frames.entries) - report.asked:
        report.exceptions["values"] = left_out
    return report
