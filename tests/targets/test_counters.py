"""The functions for counters in C and JavaScript; those of Python are in test_python_runtime.py."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from canwright.project.loader import specification
from canwright.targets.c.target import CTarget
from canwright.targets.javascript.package import RUNTIME

from ..compilers import build
from ..conformance.adapter import write_files
from ..node import run
from ..spec_texts import ROOT

NEXT = {0: 1, 1: 2, 13: 14, 254: 255, 255: 1}
"""The values after some values of a counter 1..255."""
STEPS = {(1, 2): 1, (255, 1): 1, (3, 3): 0, (254, 2): 3, (2, 1): 254, (0, 1): 0, (1, 0): 0, (1, 255): 254}

PROGRAM = """\
#include <stdio.h>
#include "chassis/v1.h"
int main(void)
{
    unsigned counter, previous;
    while (scanf("%u %u", &previous, &counter) == 2) {
        printf("%u %u\\n", (unsigned)chassis_v1_odometer_reply_count_next((uint8_t)previous),
            (unsigned)chassis_v1_odometer_reply_count_steps((uint8_t)previous, (uint8_t)counter));
    }
    return 0;
}
"""


def test_counters_in_c(tmp_path: Path) -> None:
    folder = write_files(CTarget().generate([specification(ROOT / "tests/specs/chassis/v1.yaml")], {}), tmp_path)
    source = tmp_path / "counters.c"
    source.write_text(PROGRAM, "utf-8")
    program = build([source], folder / "include", tmp_path / "counters")
    asked = [*((value, value) for value in NEXT), *STEPS]
    given = "".join(f"{previous} {value}\n" for previous, value in asked)
    answers = subprocess.run([program], input=given, capture_output=True, text=True, check=True).stdout.split("\n")
    assert [int(line.split()[0]) for line in answers[: len(NEXT)]] == list(NEXT.values())
    assert [int(line.split()[1]) for line in answers[len(NEXT) : -1]] == list(STEPS.values())


def test_counters_in_javascript() -> None:
    script = f"""
        import {{ countSteps, nextCount }} from {json.dumps((RUNTIME / "canwright-codec.js").as_uri())};
        const steps = {json.dumps(list(STEPS))}.map(([previous, value]) => countSteps([1, 255], previous, value));
        console.log(JSON.stringify([{json.dumps(list(NEXT))}.map((value) => nextCount([1, 255], value)), steps]));
    """
    assert json.loads(run(script)) == [list(NEXT.values()), list(STEPS.values())]
