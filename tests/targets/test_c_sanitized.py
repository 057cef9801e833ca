"""The golden frames through C that stops at whatever the language leaves undefined.

A compiler of the machine needs its sanitizer libraries, on Debian `libgcc-VERSION-dev` and `libclang-rt-VERSION-dev`.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from canwright.conformance.runner import Runner
from canwright.project.loader import specification

from ..compilers import SANITIZED, ZIG, Compiler, build, each_compiler
from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.c_harness import harness
from ..verification.sanitizers import UNDEFINED
from .test_c_compiles import MAIN, write


@each_compiler
def test_undefined_behaviour_stops_a_program(compiler: Compiler, tmp_path: Path) -> None:
    source = tmp_path / "shift.c"
    source.write_text(
        "int main(int count, char **words)\n{\n    (void)words;\n    return 1 << (count + 40);\n}\n", "utf-8"
    )
    program = build([source], tmp_path, tmp_path / "shift", *_flags("-O0", compiler), compiler=compiler)
    assert subprocess.run([program], capture_output=True, check=False).returncode != 0


def _flags(level: str, compiler: Compiler) -> tuple[str, ...]:
    if compiler is ZIG:  # it has no library that checks memory, and builds that for the rest for half a minute
        return (level, "-g0", *SANITIZED)
    return (level, *UNDEFINED)


@each_compiler
@pytest.mark.parametrize("level", ["-O0", pytest.param("-O2", marks=pytest.mark.exhaustive)])
def test_golden_frames_leave_nothing_undefined(level: str, compiler: Compiler, tmp_path: Path) -> None:
    flags = _flags(level, compiler)
    item = specification(MAIN)
    assert item.frames is not None
    include = write([item], tmp_path) / "include"
    source = tmp_path / "harness.c"
    source.write_text(harness(item.edition, include), "utf-8")
    program = build([source], include, tmp_path / "harness", *flags, compiler=compiler)
    report = Runner(item.edition, item.frames, CAdapter(item.edition, program)).run()
    assert not report.failures, "\n".join(map(str, report.failures[:40]))
