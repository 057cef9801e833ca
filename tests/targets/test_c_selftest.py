"""The self-test of every edition: it passes, it notices broken headers, and it runs on other machines."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget

from ..compilers import CORTEX_M0, STANDARDS, WARNINGS, ZIG, Compiler, build, each_compiler
from ..spec_texts import MINIMAL, ROOT, SPECS, called
from ..tools import tool
from ..verification.targets import MACHINES, Result, main, run, write
from .test_c_compiles import MAIN

STEPS = {"decode": 1, "fields": 2, "decode any": 3, "encode": 4, "reject frame": 5, "reject message": 6, "reply": 7}

TEXT = """\
#include <stdio.h>
#include <mwd_motor/v2_35_selftest.h>
int main(void)
{
    canwright_selftest_t result;
    if (mwd_motor_v2_35_selftest(&result) != 0u) {
        printf("%u: %s", (unsigned)result.first, canwright_step_text(result.step));
    }
    return 0;
}
"""


def result(source: Path) -> Result:
    """The result on this machine."""
    program = build([source], source.parent / "include", source.with_suffix(""))
    output = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    return Result(*map(int, output.split()))


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_every_edition_passes(spec: Path, tmp_path: Path) -> None:
    item = specification(spec)
    assert item.frames is not None
    cases, failures, first, step = result(write(item, tmp_path))
    assert (failures, first, step) == (0, 0, 0)
    assert cases >= len(item.frames.frames) + len(item.frames.exchanges)


@pytest.mark.parametrize(
    ("step", "pattern", "replacement"),
    [
        (
            "decode",
            r"(set_torque_request_decode\([^{]*\{\n)",
            r"\1    if (frame->data[4] == 0x64u) { return CANWRIGHT_WRONG_CONSTANT; }\n",
        ),
        ("fields", r"(message->iq = [^;]*)frame->data\[5\]", r"\1frame->data[6]"),
        (
            "decode any",
            r"(_decode_reply\([^{]*\{\n)",
            r"\1    if (frame->dlc == 8u) { return CANWRIGHT_UNKNOWN_CODE; }\n",
        ),
        ("encode", r"frame->data\[5\] = ", "frame->data[6] = "),
        ("reject frame", r"return CANWRIGHT_WRONG_LENGTH;", "return CANWRIGHT_UNKNOWN_CODE;"),
        ("reject message", r"return CANWRIGHT_OUT_OF_RANGE;", "return CANWRIGHT_NOT_FINITE;"),
        ("reply", r"answers \? CANWRIGHT_OK : CANWRIGHT_NOT_ANSWER", "CANWRIGHT_OK"),
    ],
)
def test_a_broken_header_fails(step: str, pattern: str, replacement: str, tmp_path: Path) -> None:
    source = write(specification(MAIN), tmp_path)
    header = tmp_path / "include/mwd_motor/v2_35.h"
    text, changes = re.subn(pattern, replacement, header.read_text("utf-8"))
    assert changes
    header.write_text(
        text.replace("    bool answers = false;\n", "    bool answers = false; (void)answers;\n"), "utf-8"
    )
    outcome = result(source)
    assert outcome.failures and outcome.first
    assert outcome.step == STEPS[step]


def test_a_wrong_decoder_is_described(tmp_path: Path) -> None:
    """The number leads to a case of the message whose field is read from another byte."""
    write(specification(MAIN), tmp_path)
    header = tmp_path / "include/mwd_motor/v2_35.h"
    pattern, replacement = r"(message->iq = [^;]*)frame->data\[5\]", r"\1frame->data[6]"
    header.write_text(re.sub(pattern, replacement, header.read_text("utf-8")), "utf-8")
    source = tmp_path / "text.c"
    source.write_text(TEXT, "utf-8")
    program = build([source], tmp_path / "include", tmp_path / "text")
    number, what = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split(": ")
    assert what == "another node or other raw integers"
    cases = (tmp_path / "include/mwd_motor/v2_35_selftest.h").read_text("utf-8")
    assert re.findall(rf"/\* {number}: (.*) \*/", cases) == ["request of set_torque"]


UNIT = """\
#include <mwd_motor/v2_35_selftest.h>
#include <mwd_motor/v2_36_2025_03_selftest.h>
uint16_t test(canwright_selftest_t *result);
uint16_t test(canwright_selftest_t *result)
{
    const uint16_t failures = mwd_motor_v2_35_selftest(result);
    return failures != 0u ? failures : mwd_motor_v2_36_2025_03_selftest(result);
}
"""


@each_compiler
@pytest.mark.parametrize("standard", STANDARDS)
def test_no_warning(standard: str, compiler: Compiler, tmp_path: Path) -> None:
    """With two editions in one unit; zig compiles for a Cortex-M0 without any library."""
    unit = tmp_path / "unit.c"
    unit.write_text(UNIT, "utf-8")
    language = ("-x", "c++") if standard.startswith("c++") else ()
    machine = CORTEX_M0 if compiler is ZIG else ()
    flags = (*machine, *WARNINGS, "-Os", f"-I{ROOT / 'generated/c/include'}", *language)
    compiler.check(standard, *flags, "-c", unit, "-o", tmp_path / "unit.o")


def test_no_selftest_without_golden_frames(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(MINIMAL, "utf-8")
    assert not [output for output in CTarget().generate([specification(spec)], {}) if "v1_selftest" in output.path]


def test_a_missing_tool_is_named_with_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setattr("tests.verification.targets.SPECS", SPECS[-1:])
    with pytest.raises(SystemExit, match="avr-gcc is not installed; on Debian: apt-get install gcc-avr avr-libc"):
        main(["avr"])
    with pytest.raises(SystemExit, match="apt-get install qemu-user"):
        tool("qemu-s390x")


@pytest.mark.tools
@pytest.mark.parametrize("name", ["s390x", "powerpc", "arm", "avr"])
def test_selftest_passes_on_emulated_machines(name: str, tmp_path: Path) -> None:
    machine = next(machine for machine in MACHINES if machine.name == name)
    outcome = run(machine, write(specification(MAIN), tmp_path))
    assert outcome.cases > 400
    assert outcome.failures == 0
