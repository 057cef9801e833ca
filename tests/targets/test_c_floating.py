"""Floating point in C: exact conversions, `float` functions without any double, and scales of more than 63 bits."""

from __future__ import annotations

import random
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget

from ..compilers import WARNINGS, ZIG
from ..conformance.adapters.c_signatures import functions
from ..spec_texts import MINIMAL, SPECS
from ..tools import tool
from ..verification import floating

SAMPLE = 20_000
DOUBLE_CALL = re.compile(rb"\b__aeabi_(?:d\w+|\w+2d|cd\w+)\b")
"""The names of functions for doubles in the symbol table of an object."""
CORTEX_M4F = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")


def test_conversions_agree_with_fractions(tmp_path: Path) -> None:
    assert floating.differences(floating.compiled(tmp_path), floating.cases(SAMPLE, random.Random(7))) == []


def unit(folder: Path, kinds: Sequence[str]) -> tuple[str, Path]:
    """The option for the headers, and a unit with the conversions of all specs to and from some floating-point types."""
    specifications = [specification(spec) for spec in SPECS]
    include = write_files(CTarget().generate(specifications, {}), folder) / "include"
    lines, table = [], []
    for edition_input in specifications:
        name = f"{edition_input.edition.family}/{edition_input.edition.identifier}_float.h"
        lines.append(f'#include "{name}"')
        function_names = functions((include / name).read_text("utf-8"))
        table += [
            f"    (void (*)(void)){f}," for f in function_names if f.endswith(tuple(f"_{kind}" for kind in kinds))
        ]
    assert table
    lines += ["extern void (*const all[])(void);", "void (*const all[])(void) = {", *table, "};", ""]
    (folder / "unit.c").write_text("\n".join(lines), "utf-8")
    return f"-I{include}", folder / "unit.c"


def test_float_functions_call_no_function_for_doubles(tmp_path: Path) -> None:
    target = ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4", "-ffreestanding", "-Os")
    made = tmp_path / "unit.o"
    ZIG.run("c99", *target, *WARNINGS, *unit(tmp_path, ["float"]), "-c", "-o", made)
    assert not DOUBLE_CALL.search(made.read_bytes())
    ZIG.run("c99", *target, *WARNINGS, *unit(tmp_path, ["float", "double"]), "-c", "-o", made)
    assert DOUBLE_CALL.search(made.read_bytes())


@pytest.mark.tools
def test_float_functions_of_gcc_for_cortex_m4f_call_no_function_for_doubles(tmp_path: Path) -> None:
    flags = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-std=c99", "-Os", *WARNINGS)
    made = tmp_path / "unit.o"
    subprocess.run([tool("arm-none-eabi-gcc"), *flags, *unit(tmp_path, ["float"]), "-c", "-o", made], check=True)
    assert not DOUBLE_CALL.search(made.read_bytes())


@pytest.mark.tools
def test_avr_has_the_float_functions_alone(tmp_path: Path) -> None:
    """A double of avr-gcc has 32 bits."""
    command: list[str | Path] = [
        tool("avr-gcc"),
        "-std=c99",
        "-mmcu=atmega2560",
        "-Os",
        "-c",
        "-o",
        tmp_path / "unit.o",
    ]
    subprocess.run([*command, *unit(tmp_path, ["float"])], check=True)
    with_double = [*command, *unit(tmp_path, ["double"])]
    done = subprocess.run(with_double, capture_output=True, text=True, check=False)
    assert re.search(r"_to_double\W undeclared", done.stderr)


@pytest.mark.parametrize("ending", ["double", "float"])
@pytest.mark.parametrize(
    "scale", ["25.132741228718345/65535, offset: -12.566370614359172", "1/1000000000000000000000000000000"]
)
def test_a_scale_of_more_than_63_bits_has_conversions_to_floating_point(
    scale: str, ending: str, tmp_path: Path
) -> None:
    file = tmp_path / "spec.yaml"
    file.write_text(MINIMAL.replace("scale: 0.1", f"scale: {scale}"), "utf-8")
    texts = {output.path: output.text for output in CTarget().generate([specification(file)], {})}
    text = " ".join(texts["include/lamp/v1.h"].replace("*", " ").split())
    assert "No thousandths: scale or offset needs integers of more than 63 bits" in text
    assert f"level_to_{ending}" in texts["include/lamp/v1_float.h"]


def test_a_scale_beyond_float_has_conversions_to_double(tmp_path: Path) -> None:
    file = tmp_path / "spec.yaml"
    file.write_text(MINIMAL.replace("scale: 0.1", f"scale: 0.{'0' * 37}1/10"), "utf-8")
    texts = {output.path: output.text for output in CTarget().generate([specification(file)], {})}
    header = texts["include/lamp/v1_float.h"]
    assert "level_to_double" in header and "level_to_float" not in header
    text = " ".join(texts["include/lamp/v1.h"].replace("*", " ").split())
    assert "No conversions to float: values are beyond its range." in text
