"""The C++17 header under compilers and standards, and what must not compile with it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from canwright.project.loader import specification

from ..compilers import WARNINGS, ZIG, Compiler, each_compiler
from ..conformance.adapters.cxx import cxx_harness
from ..spec_texts import ROOT, SMALL, called
from .test_c_compiles import MAIN, write

INCLUDE = ROOT / "generated/c/include"
STRICT = (*WARNINGS, "-Wold-style-cast", "-fno-exceptions", "-fno-rtti")

PROGRAM = """\
#include <mwd_motor/v2_35.hpp>
#include <mwd_motor/v2_36_2025_03.hpp>

using namespace mwd_motor::v2_35;

canwright_status_t use(const frame &received);
canwright_status_t use(const frame &received)
{
    const parameters motor = parameters().set(series::mg).set(encoder_bits::_18);
    set_torque_request request;
    set_torque_reply reply;
    read_status_1_reply state;
    canwright_status_t status = set(request, field::iq, 2.5, motor);
    if (!decode(reply, received, motor, &status) || !encode(1u, request) || !decode(state, received)) {
        return status;
    }
    %s;
    return get(reply, field::iq, motor).has_value() ? status : CANWRIGHT_NO_SCALE;
}
"""
CORRECT = (
    "status = set(reply, field::speed, get(reply, field::speed))",
    "set(state, field::errors, error_flags::low_voltage, has(state, field::errors, error_flags::over_temperature))",
    "status = set_float(request, field::iq, get_float(reply, field::iq, motor).value_or(0.0f), motor)",
    "status = set_milli(request, field::iq, get_milli(reply, field::iq, motor).value_or(0), motor)",
)
INCORRECT = (
    "status = set(reply, field::voltage, 1.0)",
    "status = set(request, field::iq, 2.5)",
    "status = set_float(request, field::iq, 2.7, motor)",
    "status = set(request, field::iq, series::mg, motor)",
    "set(state, field::errors, spin_direction::clockwise)",
    "status = set(request, mwd_motor::v2_36_2025_03::field::iq, 2.5, motor)",
    "static_cast<void>(mwd_motor::v2_36_2025_03::encode(1u, request))",
    "encode(1u, request)",
    "set(request, field::iq, 2.5, motor)",
    "state.errors = error_flags::low_voltage",
)
IGNORED = (
    "set(request, field::iq, 2.5, motor)",
    "encode(1u, request)",
    "decode(reply, received, motor)",
    "get(reply, field::speed)",
    "check_reply(received, received)",
)


def compiled(statement: str, compiler: Compiler, standard: str, folder: Path, *flags: str) -> None:
    """Compiles a program with a statement. Raises AssertionError with the messages of the compiler."""
    unit = folder / "unit.cpp"
    unit.write_text(PROGRAM % statement, "utf-8")
    compiler.check(standard, *STRICT, *flags, f"-I{INCLUDE}", "-c", unit, "-o", folder / "unit.o")


@each_compiler
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_what_fits_compiles(standard: str, compiler: Compiler, tmp_path: Path) -> None:
    compiled(";\n    ".join(CORRECT), compiler, standard, tmp_path)


def test_what_does_not_fit_does_not_compile(tmp_path: Path) -> None:
    with pytest.raises(AssertionError) as raised:
        compiled(";\n    ".join(INCORRECT), ZIG, "c++17", tmp_path)
    first = PROGRAM.partition("%s")[0].count("\n") + 1
    reported = {int(line) for line in re.findall(r"unit\.cpp:(\d+):\d+: error:", str(raised.value))}
    assert reported == {*range(first, first + len(INCORRECT))}


@each_compiler
def test_an_ignored_result_does_not_compile_unless_switched_off(compiler: Compiler, tmp_path: Path) -> None:
    for statement in IGNORED:
        with pytest.raises(AssertionError, match="unused-result"):
            compiled(statement, compiler, "c++17", tmp_path)
    compiled(";\n    ".join(IGNORED), compiler, "c++17", tmp_path, "-DCANWRIGHT_CHECKED=")


@pytest.mark.parametrize("spec", [MAIN, *SMALL[::3]], ids=called)
@each_compiler
def test_every_function_compiles_in_cxx20(compiler: Compiler, spec: Path, tmp_path: Path) -> None:
    """The conformance tests do the same in C++17 with every spec."""
    item = specification(spec)
    include = write([item], tmp_path) / "include"
    unit = tmp_path / "unit.cpp"
    unit.write_text(cxx_harness(item.edition), "utf-8")
    compiler.check("c++20", *STRICT, f"-I{include}", "-c", unit, "-o", tmp_path / "unit.o")


@each_compiler
def test_an_older_standard_is_named(compiler: Compiler, tmp_path: Path) -> None:
    unit = tmp_path / "unit.cpp"
    unit.write_text("#include <mwd_motor/v2_35.hpp>\n", "utf-8")
    with pytest.raises(AssertionError, match=r"v2_35\.hpp needs C\+\+17; use v2_35\.h"):
        compiler.check("c++14", f"-I{INCLUDE}", "-c", unit, "-o", tmp_path / "unit.o")
