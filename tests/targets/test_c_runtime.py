"""The C headers that are the same for every protocol: plain source that compiles as it is and is copied unchanged."""

from __future__ import annotations

import random
import re
import subprocess
from pathlib import Path

import pytest
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.targets.base import header
from canwright.targets.c.cpp import SHARED_CXX
from canwright.targets.c.names import FD, SHARED, TEXT
from canwright.targets.c.package import RUNTIME

from ..compilers import CORTEX_M0, LEVELS, STANDARDS, WARNINGS, ZIG, Compiler, build, each_compiler
from ..spec_texts import ROOT
from ..verification import floating, integers
from .test_c_compiles import MAIN, everything, write

SAMPLE = 10_000
PRINT_STATUSES = """\
#include <stdio.h>
#include "canwright.h"
int main(void)
{
    int status;
    for (status = 0; status <= %d; status++) {
        puts(canwright_status_name((canwright_status_t)status));
    }
    return 0;
}
"""

SPEC_WITH = {FD: ROOT / "tests/specs/servo/v1.yaml", TEXT: ROOT / "tests/specs/stack/v1.yaml"}
"""Specs that need a header which others do not have."""


@pytest.fixture(scope="module")
def unit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A translation unit that takes the address of every function of the runtime."""
    file = tmp_path_factory.mktemp("runtime") / "everything.c"
    file.write_text(everything(RUNTIME, SHARED), "utf-8")
    return file


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_the_source_compiles_as_it_is(compiler: Compiler, standard: str, unit: Path) -> None:
    language = ("-x", "c++") if standard.startswith("c++") else ()
    for level in LEVELS[:1] if compiler is ZIG else LEVELS:  # the warnings of zig do not depend on the level
        flags = (*WARNINGS, f"-I{RUNTIME}", *language, level, "-c", unit, "-o", unit.with_suffix(".o"))
        compiler.check(standard, *flags)


def test_the_source_compiles_for_a_bare_cortex_m0(unit: Path) -> None:
    ZIG.check("c99", *CORTEX_M0, *WARNINGS, "-Os", f"-I{RUNTIME}", "-c", unit, "-o", unit.with_suffix(".arm.o"))


@pytest.mark.parametrize("file", SHARED)
def test_each_header_compiles_alone(file: str, tmp_path: Path) -> None:
    unit = tmp_path / "unit.c"
    unit.write_text(f'#include "{file}"\n', "utf-8")
    ZIG.check("c99", *WARNINGS, f"-I{RUNTIME}", "-c", unit, "-o", unit.with_suffix(".o"))


@pytest.mark.parametrize(
    "source", [*(RUNTIME / file for file in (*SHARED, FD, TEXT)), SHARED_CXX], ids=lambda p: p.name
)
def test_the_source_is_copied_below_a_header_line(source: Path, tmp_path: Path) -> None:
    edition_input = specification(SPEC_WITH.get(source.name, MAIN))
    copied = write([edition_input], tmp_path) / "include" / edition_input.edition.family / source.name
    assert copied.read_bytes() == f"/* {header(edition_input.edition)} */\n".encode() + source.read_bytes()


def test_every_source_file_is_copied() -> None:
    assert sorted(file.name for file in RUNTIME.iterdir()) == sorted([*SHARED, FD, TEXT])


def test_the_statuses_are_the_reasons_for_rejection(tmp_path: Path) -> None:
    """In the same order with the same words, so that a status means what the other targets mean."""
    (body,) = re.findall(
        r"typedef enum \{(.*?)\} canwright_status_t;", (RUNTIME / "canwright.h").read_text("utf-8"), re.S
    )
    assert re.findall(r"\bCANWRIGHT_\w+(?=(?: = 0)?,?$)", body, re.M) == [
        "CANWRIGHT_OK",
        *(f"CANWRIGHT_{refusal.name}" for refusal in Refusal),
    ]
    source = tmp_path / "statuses.c"
    source.write_text(PRINT_STATUSES % (len(Refusal) + 1), "utf-8")
    program = build([source], RUNTIME, tmp_path / "statuses")
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split("\n")
    assert printed == ["ok", *(refusal.value for refusal in Refusal), "?", ""]


def test_integers_and_texts_agree_with_fractions(tmp_path: Path) -> None:
    assert floating.differences(integers.compiled(tmp_path), integers.cases(SAMPLE, random.Random(7))) == []
