"""The golden frames through C that stops at whatever the language leaves undefined.

A compiler of the machine needs its sanitizer libraries, on Debian `libgcc-VERSION-dev` and `libclang-rt-VERSION-dev`.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.project.loader import described

from ..compilers import ZIG, Compiler, build, each_compiler
from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.c_harness import harness
from ..conformance.runner import Runner
from .test_c_compiles import MAIN, write


@each_compiler
@pytest.mark.parametrize("level", ["-O0", "-O2"])
def test_golden_frames_leave_nothing_undefined(level: str, compiler: Compiler, tmp_path: Path) -> None:
    checks = "undefined" if compiler is ZIG else "undefined,address"  # zig has no library that checks memory
    flags = (level, f"-fsanitize={checks}", "-fno-sanitize-recover=all")
    item = described(MAIN)
    assert item.frames is not None
    include = write([item], tmp_path) / "include"
    source = tmp_path / "harness.c"
    source.write_text(harness(item.edition, include), "utf-8")
    program = build([source], include, tmp_path / "harness", *flags, compiler=compiler)
    report = Runner(item.edition, item.frames, CAdapter(item.edition, program)).run()
    assert not report.failures, "\n".join(report.failures[:40])
