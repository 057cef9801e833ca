"""The golden frames through C that stops at whatever the language leaves undefined."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.project.loader import described

from ..compilers import build
from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.c_harness import harness
from ..conformance.runner import Runner
from .test_c_compiles import MAIN, write

EVERYTHING = ("-fsanitize=undefined,address", "-fno-sanitize-recover=all")
LEAST = ("-fsanitize=undefined", "-fno-sanitize-recover=all")


@pytest.fixture(scope="module")
def flags(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, ...]:
    """What the compiler can check: undefined behaviour, and, where its library is there, memory as well."""
    folder = tmp_path_factory.mktemp("probe")
    source = folder / "probe.c"
    source.write_text("int main(void)\n{\n    return 0;\n}\n", "utf-8")
    try:
        build([source], folder, folder / "probe", *EVERYTHING)
    except AssertionError:
        return LEAST
    return EVERYTHING


@pytest.mark.parametrize("level", ["-O0", "-O2"])
def test_golden_frames_leave_nothing_undefined(level: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    item = described(MAIN)
    assert item.frames is not None
    include = write([item], tmp_path) / "include"
    source = tmp_path / "harness.c"
    source.write_text(harness(item.edition, include), "utf-8")
    program = build([source], include, tmp_path / "harness", level, *flags)
    report = Runner(item.edition, item.frames, CAdapter(item.edition, program)).run()
    assert not report.failures, "\n".join(report.failures[:40])
