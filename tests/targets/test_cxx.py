"""The C++17 header under compilers and standards, and what must not compile with it."""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.project.loader import specification

from ..compilers import SANITIZED, WARNINGS, ZIG, ZIG_COMMAND, Compiler, each_compiler
from ..conformance.adapters.cxx import cxx_harness
from ..spec_texts import MINIMAL, ROOT, SMALL, called
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
    set_torque_request::reply reply;
    read_status_1_reply state;
    canwright_status_t status = set(request, field::iq, 2.5, motor);
    if (!decode(reply, received, motor) || !encode(1u, request, motor) || !decode(state, received)) {
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
    "request.iq = 250",
    "request.iq = reply.iq",
    "status = request == set_torque_request() && request != request ? status : CANWRIGHT_OK",
    "status = get(reply, field::power, motor).why()",
    "static_assert(set_torque_request::code == 0xA1u && set_torque_request::which == command::set_torque)",
    "status = set_torque_request::text == nullptr ? CANWRIGHT_OK : encode(1u, request, motor).why()",
)
INCORRECT = (
    "status = set(reply, field::voltage, 1.0)",
    "status = set(request, field::iq, 2.5)",
    "status = set_float(request, field::iq, 2.7, mwd_motor::v2_36_2025_03::parameters())",
    "status = set(request, field::iq, series::mg, motor)",
    "status = set_milli(request, field::iq, 2500.5, motor)",
    "status = set(reply, field::iq, 0u, 2.5, motor)",
    "set(state, field::errors, spin_direction::clockwise)",
    "status = set(request, mwd_motor::v2_36_2025_03::field::iq, 2.5, motor)",
    "static_cast<void>(encode(1u, request))",
    "static_cast<void>(encode(request, motor))",
    "static_cast<void>(get(reply, field::power))",
    "static_cast<void>(get(state, field::errors))",
    "static_cast<void>(has(state, field::errors, spin_direction::clockwise))",
    "static_cast<void>(has(state, field::iq, error_flags::low_voltage))",
    "static_cast<void>(request == reply)",
    "encode(1u, request, motor)",
    "set(request, field::iq, 2.5, motor)",
    "state.errors = error_flags::low_voltage",
    "request.iq = 2.5",
    "request.iq = 2.5f",
)
IGNORED = (
    "set(request, field::iq, 2.5, motor)",
    "encode(1u, request, motor)",
    "decode(reply, received, motor)",
    "get(reply, field::speed)",
    "check_reply(received, received)",
)
FIRST = PROGRAM.partition("%s")[0].count("\n") + 1
"""The line of the first statement."""
ONE_SENTENCE = {
    "static_cast<void>(get(reply, field::voltage))": "the message has no such field",
    "status = set(reply, field::voltage, 1.0)": "the message has no such field",
    "static_cast<void>(get(reply, field::iq))": "pass them last",
    "status = set(request, field::iq, series::mg, motor)": "a value of another type",
    "static_cast<void>(encode(1u, request))": "pass them last",
    "static_cast<void>(get(state, field::errors))": "or its flags with `has`",
    "static_cast<void>(set(state, field::errors, spin_direction::clockwise))": "flags of another type",
    "static_cast<void>(has(state, field::errors, spin_direction::clockwise))": "flags of another type",
    "status = set(reply, field::iq, 0u, 2.5, motor)": "parameters of the node, of this edition, can follow",
    "request.iq = 2.5": "deleted",
}
"""Mistakes, and the end of the sentence about each."""
READS = """\
#include <cstdio>
#include <mwd_motor/v2_35.hpp>

using namespace mwd_motor::v2_35;

static void show(const char *what, const result<double> &found)
{
    std::printf("%s %s %s\\n", what, canwright_status_name(found.why()), found ? "none" : name(found.field()));
}

int main()
{
    const parameters mf = parameters().set(series::mf);
    const parameters ms = parameters().set(series::ms);
    set_torque_reply reply;
    set_torque_request request;
    show("power of MF", get(reply, field::power, mf));
    show("power of MS", get(reply, field::power, ms));
    show("iq of MS", get(reply, field::iq, ms));
    show("power of any", get(reply, field::power, parameters()));
    request.iq = 3000;
    const auto sent = encode(1u, request, mf);
    std::printf("iq of 3000 %s %s\\n", canwright_status_name(sent.why()), name(sent.field()));
    std::printf("node 99 [%s]\\n", name(encode(99u, request, mf).field()));
    std::printf("torque of MS %s\\n", canwright_status_name(encode(1u, request, ms).why()));
    const frame received = {0x141u, 8u, {0u}, {0x9Au, 20u, 0u, 0u, 0u, 0u, 0u, 8u}};
    const auto any = decode_reply(received, mf);
    std::puts(visit([](const auto &message) { return message.text; }, *any));
    return 0;
}
"""
READ = """\
power of MF not_available power
power of MS ok none
iq of MS not_available iq
power of any missing_parameter power
iq of 3000 out_of_range iq
node 99 []
torque of MS not_available
reply of read_status_1
"""

FLOAT_FIELD = """\
#include <blower/v1.hpp>

using namespace blower::v1;

canwright_status_t use(const frame &received);
canwright_status_t use(const frame &received)
{
    read_voltage_reply reply;
    canwright_status_t status = decode(reply, received).why();
    %s;
    return reply == read_voltage_reply() && get_float(reply, field::voltage) < 1.0f ? status : CANWRIGHT_OK;
}
"""
SETS = (
    "status = set(reply, field::voltage, 49.5)",
    "reply.voltage.bits = 0x42460000u",
    "reply.voltage = {0x42460000u}",
)
NUMBERS = (
    "reply.voltage = 49.5f",
    "reply.voltage = 49",
    "reply.voltage = {49.5f}",
    "status = set(reply, field::voltage)",
)

WIDE = """\
#include <cstdio>
#include <lamp/v1.hpp>

using namespace lamp::v1;

int main()
{
    int failures = 0;
    for (std::uint32_t raw = 0u; raw <= 65535u; raw++) {
        dim_request message;
        message.level = static_cast<std::uint16_t>(raw);
        dim_request copy;
        const status exact = set(copy, field::level, get(message, field::level));
        failures += exact != CANWRIGHT_OK || copy != message;
        const status single = set_float(copy, field::level, get_float(message, field::level));
        failures += single != CANWRIGHT_OK || copy != message;
        if (raw % 4369u == 0u) {
            std::printf("%.17g\\n", get(message, field::level));
        }
    }
    return failures;
}
"""
NO_64_BITS = ("-U__DBL_MANT_DIG__", "-D__DBL_MANT_DIG__=24", "-Wno-builtin-macro-redefined")
"""A compiler whose double has 32 bits."""
SINGLE = """\
#include <mwd_motor/v2_35.hpp>
#include <type_traits>

using namespace mwd_motor::v2_35;

status use(set_torque_request &request, const set_torque_reply &reply, const parameters &motor);
status use(set_torque_request &request, const set_torque_reply &reply, const parameters &motor)
{
    static_assert(std::is_same_v<decltype(get(reply, field::speed)), float>);
    static_assert(std::is_same_v<decltype(get(reply, field::iq, motor)), result<float>>);
    return set(request, field::iq, get(reply, field::iq, motor).value_or(0.0f), motor);
}
"""


def compiled(statement: str, compiler: Compiler, standard: str, folder: Path, *flags: str) -> None:
    """Compiles a program with a statement. Raises AssertionError with the messages of the compiler."""
    unit = folder / "unit.cpp"
    unit.write_text(PROGRAM % statement, "utf-8")
    compiler.check(standard, *STRICT, *flags, f"-I{INCLUDE}", "-c", unit, "-o", folder / "unit.o")


def lines_of(message: str, error: AssertionError) -> set[int]:
    """The lines of the program that messages name; the sentence about a mistake can be in the shared header."""
    return {int(line) for line in re.findall(rf"unit\.cpp:(\d+):\d+: {message}", str(error))}


@each_compiler
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_correct_calls_compile(standard: str, compiler: Compiler, tmp_path: Path) -> None:
    compiled(";\n    ".join(CORRECT), compiler, standard, tmp_path)


def test_incorrect_calls_do_not_compile(tmp_path: Path) -> None:
    with pytest.raises(AssertionError) as raised:
        compiled(";\n    ".join(INCORRECT), ZIG, "c++17", tmp_path, "-ferror-limit=0")
    assert lines_of("(?:error|note: in instantiation)", raised.value) == {*range(FIRST, FIRST + len(INCORRECT))}


@each_compiler
def test_no_number_is_assigned_to_a_float_field(compiler: Compiler, tmp_path: Path) -> None:
    include = write([specification(ROOT / "tests/specs/blower/v1.yaml")], tmp_path) / "include"
    unit = tmp_path / "unit.cpp"
    flags = (*STRICT, f"-I{include}", "-c", unit, "-o", tmp_path / "unit.o")
    unit.write_text(FLOAT_FIELD % ";\n    ".join(SETS), "utf-8")
    compiler.check("c++17", *flags)
    for statement in NUMBERS:
        unit.write_text(FLOAT_FIELD % statement, "utf-8")
        with pytest.raises(AssertionError, match="error"):
            compiler.check("c++17", *flags)


@each_compiler
def test_the_message_about_a_mistake_is_one_sentence(compiler: Compiler, tmp_path: Path) -> None:
    with pytest.raises(AssertionError) as raised:
        compiled(";\n    ".join(ONE_SENTENCE), compiler, "c++17", tmp_path)
    errors = [line for line in str(raised.value).splitlines() if " error: " in line]
    assert len(errors) == len(ONE_SENTENCE), errors
    for sentence, count in Counter(ONE_SENTENCE.values()).items():
        assert sum(sentence in error for error in errors) == count, (sentence, errors)


def test_a_result_has_the_reason_and_the_field(tmp_path: Path) -> None:
    source = tmp_path / "reads.cpp"
    source.write_text(READS, "utf-8")
    unit, program = source.with_suffix(".o"), tmp_path / "reads"
    ZIG.run("c++17", *STRICT, *SANITIZED, f"-I{INCLUDE}", "-c", source, "-o", unit)
    ZIG.run("c++17", *SANITIZED, "-nostdlib++", unit, "-o", program)
    assert subprocess.run([program], capture_output=True, text=True, check=True).stdout == READ


@each_compiler
def test_an_ignored_result_does_not_compile_unless_switched_off(compiler: Compiler, tmp_path: Path) -> None:
    with pytest.raises(AssertionError) as raised:
        compiled(";\n    ".join(IGNORED), compiler, "c++17", tmp_path)
    assert lines_of(r"error: .*unused-result", raised.value) == {*range(FIRST, FIRST + len(IGNORED))}
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


def test_a_scale_of_more_than_63_bits_converts(tmp_path: Path) -> None:
    """Each raw integer has the double nearest to its value, and is the one of its value; thousandths do not exist."""
    file, source = tmp_path / "spec.yaml", tmp_path / "wide.cpp"
    scale, offset = Fraction("25.132741228718345") / 65535, Fraction("-12.566370614359172")
    wide = "scale: 25.132741228718345/65535, offset: -12.566370614359172"
    file.write_text(MINIMAL.replace("scale: 0.1", wide).replace("0..1000", "0..65535"), "utf-8")
    flags = (*STRICT, *SANITIZED, f"-I{write([specification(file)], tmp_path) / 'include'}")
    source.write_text(WIDE, "utf-8")
    unit, program = source.with_suffix(".o"), tmp_path / "wide"
    ZIG.run("c++17", *flags, "-c", source, "-o", unit)
    ZIG.run("c++17", *SANITIZED, "-nostdlib++", unit, "-o", program)
    answers = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    assert [*map(float, answers)] == [float(raw * scale + offset) for raw in range(0, 65536, 4369)]
    source.write_text(WIDE.replace("get_float", "get_milli"), "utf-8")
    with pytest.raises(AssertionError, match="the field has no such value"):
        ZIG.run("c++17", *flags, "-c", source, "-o", unit)


@each_compiler
def test_without_doubles_of_64_bits_values_have_single_precision(compiler: Compiler, tmp_path: Path) -> None:
    unit = tmp_path / "unit.cpp"
    unit.write_text(SINGLE, "utf-8")
    compiler.check("c++17", *STRICT, *NO_64_BITS, f"-I{INCLUDE}", "-c", unit, "-o", tmp_path / "unit.o")


def test_a_compiler_without_the_library_of_cxx_is_named(tmp_path: Path) -> None:
    unit = tmp_path / "unit.cpp"
    unit.write_text("#include <mwd_motor/v2_35.hpp>\n", "utf-8")
    command: list[str | Path] = [
        *ZIG_COMMAND,
        "c++",
        "-target",
        "avr-freestanding",
        "-mmcu=atmega2560",
        "-std=c++17",
        f"-I{INCLUDE}",
        str(unit),
    ]
    done = subprocess.run([*command, "-fsyntax-only"], capture_output=True, text=True, check=False)
    assert "which avr-gcc lacks; include the headers for C" in done.stderr


@each_compiler
def test_an_older_standard_is_named(compiler: Compiler, tmp_path: Path) -> None:
    unit = tmp_path / "unit.cpp"
    unit.write_text("#include <mwd_motor/v2_35.hpp>\n", "utf-8")
    with pytest.raises(AssertionError, match=r"v2_35\.hpp needs C\+\+17; use v2_35\.h"):
        compiler.check("c++14", f"-I{INCLUDE}", "-c", unit, "-o", tmp_path / "unit.o")
