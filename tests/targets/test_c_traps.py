"""Mistakes of a user that do not compile: an ignored status, NULL, a conversion of another type; and the frame's layout."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from canwright.project.loader import spec_files, specification
from canwright.targets.c.names import EDITION_NAMES, SIGNIFICANT, TYPE_ENDINGS, Names, defined, layouts
from canwright.targets.c.package import RUNTIME
from canwright.targets.c.target import CTarget

from ..compilers import CORTEX_M0, STANDARDS, WARNINGS, ZIG, Compiler, each_compiler
from ..spec_texts import MINIMAL, ROOT, SPECS, called, edition
from ..tools import tool
from .test_c_compiles import write

INCLUDE = ROOT / "generated/c/include"
LINUX = ("-target", "x86_64-linux-gnu")

LAYOUT = """
#define CHECK(name, condition) typedef char name[(condition) ? 1 : -1]
#include "canwright.h"
#include "canwright_fd.h"
CHECK(fd_size, sizeof(canwright_fd_frame_t) == 72);
CHECK(fd_dlc, offsetof(canwright_fd_frame_t, dlc) == 4 && sizeof(((canwright_fd_frame_t *)0)->dlc) == 1);
CHECK(fd_flags, offsetof(canwright_fd_frame_t, flags) == 5 && sizeof(((canwright_fd_frame_t *)0)->flags) == 1);
CHECK(fd_data, offsetof(canwright_fd_frame_t, data) == 8 && sizeof(((canwright_fd_frame_t *)0)->data) == 64);
CHECK(size, sizeof(canwright_frame_t) == 16);
CHECK(id, offsetof(canwright_frame_t, id) == 0 && sizeof(((canwright_frame_t *)0)->id) == 4);
CHECK(dlc, offsetof(canwright_frame_t, dlc) == 4 && sizeof(((canwright_frame_t *)0)->dlc) == 1);
CHECK(data, offsetof(canwright_frame_t, data) == 8 && sizeof(((canwright_frame_t *)0)->data) == 8);
"""
SOCKETCAN = """
#include <linux/can.h>
struct probe_a { char c; canwright_frame_t frame; };
struct probe_b { char c; struct can_frame frame; };
CHECK(same_fd_size, sizeof(canwright_fd_frame_t) == sizeof(struct canfd_frame));
CHECK(same_fd_length, offsetof(canwright_fd_frame_t, dlc) == offsetof(struct canfd_frame, len));
CHECK(same_fd_flags, offsetof(canwright_fd_frame_t, flags) == offsetof(struct canfd_frame, flags));
CHECK(same_fd_data, offsetof(canwright_fd_frame_t, data) == offsetof(struct canfd_frame, data));
CHECK(same_fd_brs, CANWRIGHT_FD_BRS == CANFD_BRS);
CHECK(same_fd_most, CANWRIGHT_FD_MAX_DATA == CANFD_MAX_DLEN);
CHECK(same_size, sizeof(canwright_frame_t) == sizeof(struct can_frame));
CHECK(same_alignment, offsetof(struct probe_a, frame) == offsetof(struct probe_b, frame));
CHECK(same_id, offsetof(canwright_frame_t, id) == offsetof(struct can_frame, can_id));
CHECK(same_dlc, offsetof(canwright_frame_t, dlc) == offsetof(struct can_frame, can_dlc));
CHECK(same_data, offsetof(canwright_frame_t, data) == offsetof(struct can_frame, data));
CHECK(extended, CANWRIGHT_EXTENDED == CAN_EFF_FLAG);
CHECK(remote, CANWRIGHT_REMOTE == CAN_RTR_FLAG);
CHECK(most, CANWRIGHT_MAX_DATA == CAN_MAX_DLEN);
"""

USE = """
#include <mwd_motor/v2_35.h>
#include <mwd_motor/v2_35_float.h>
canwright_status_t use(canwright_frame_t *frame, const mwd_motor_v2_35_parameters_t *motor);
canwright_status_t use(canwright_frame_t *frame, const mwd_motor_v2_35_parameters_t *motor)
{
    mwd_motor_v2_35_set_torque_request_t request = {0};
    mwd_motor_v2_35_set_speed_request_t speed = {0};
    canwright_status_t status = CANWRIGHT_OK;
    double value = 0.0;
    (void)speed;
    (void)motor;
    %s
    (void)value;
    return status != CANWRIGHT_OK ? status : mwd_motor_v2_35_set_torque_request_encode(frame, 1u, &request, motor);
}
"""
RIGHT = """
    status = mwd_motor_v2_35_torque_current_from_double(&request.iq, 2.5, motor);
    value = mwd_motor_v2_35_speed_setpoint_to_double(speed.speed);
"""
IGNORED = (
    "mwd_motor_v2_35_set_torque_request_encode(frame, 1u, &request, motor);",
    "mwd_motor_v2_35_torque_current_from_milli(&request.iq, 2500, motor);",
    "mwd_motor_v2_35_torque_current_to_double(&value, request.iq, motor);",
)
NULLS = (
    "status = mwd_motor_v2_35_set_torque_request_encode(NULL, 1u, &request, motor);",
    "status = mwd_motor_v2_35_set_torque_request_encode(frame, 1u, NULL, motor);",
    "status = mwd_motor_v2_35_torque_current_from_double(&request.iq, 2.5, NULL);",
    "canwright_clear(NULL);",
)
FLOATS = ("request.iq = 2.5;", "request.iq = 2.5f;", "speed.speed = value;")
"""Values that are assigned to raw integers."""
FLOAT_FIELD = """
#include <blower/v1_float.h>
float use(float volts);
float use(float volts)
{
    blower_v1_read_voltage_reply_t reply = {{0u}};
    canwright_status_t status = CANWRIGHT_OK;
    %s
    return status == CANWRIGHT_OK ? blower_v1_voltage_to_float(reply.voltage) : volts;
}
"""
SETS = ("status = blower_v1_voltage_from_float(&reply.voltage, volts);", "reply.voltage.bits = 0x42460000u;")
NUMBERS = (
    "reply.voltage = volts;",
    "reply.voltage = 49.5f;",
    "reply.voltage = 49;",
    "volts = reply.voltage;",
    "volts = blower_v1_voltage_to_float(49.5f);",
    "status = blower_v1_voltage_from_float(&volts, 49.5f);",
)
"""A number in place of the bits of a field in floating point, or the other way round."""
PARTS_OF_MESSAGES = ("_match", "_stamp", "_pack", "_unpack")
"""Parts of the functions that encode and decode. GCC merges fewer loads and passes more arguments if they are marked."""
TAKES_NULL = ("canwright_factor",)
"""A product of up to three parameters; those that it lacks are NULL."""
NO_MACROS = ("-DCANWRIGHT_CHECKED=", "-DCANWRIGHT_NONNULL=", "-DCANWRIGHT_RESTRICT=")


def source(folder: Path, text: str) -> Path:
    unit = folder / "unit.c"
    unit.write_text(text, "utf-8")
    return unit


def compiled(compiler: Compiler, standard: str, unit: Path, *flags: str) -> None:
    language = ("-x", "c++") if standard.startswith("c++") else ()
    arguments = (*WARNINGS, *flags, f"-I{INCLUDE}", f"-I{RUNTIME}", *language, "-c", unit, "-o", unit.with_suffix(".o"))
    compiler.check(standard, *arguments)


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_the_frame_has_sixteen_bytes_and_its_data_at_offset_eight(
    compiler: Compiler, standard: str, tmp_path: Path
) -> None:
    unit = source(tmp_path, LAYOUT)
    compiled(compiler, standard, unit)
    if compiler is ZIG:
        compiled(compiler, standard, unit, *CORTEX_M0)


@pytest.mark.parametrize("standard", ["c99", "c++17"])
def test_the_frame_has_the_layout_of_socketcan(standard: str, tmp_path: Path) -> None:
    """With the headers of Linux that zig contains."""
    compiled(ZIG, standard, source(tmp_path, LAYOUT + SOCKETCAN), *LINUX)


@pytest.mark.machine
@pytest.mark.skipif(sys.platform != "linux", reason="needs the headers of Linux")
@each_compiler
def test_the_frame_has_the_layout_of_socketcan_here(compiler: Compiler, tmp_path: Path) -> None:
    compiled(compiler, "c99", source(tmp_path, LAYOUT + SOCKETCAN))


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_correct_code_compiles(compiler: Compiler, standard: str, tmp_path: Path) -> None:
    compiled(compiler, standard, source(tmp_path, USE % RIGHT))


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_an_ignored_status_does_not_compile(compiler: Compiler, standard: str, tmp_path: Path) -> None:
    unit = source(tmp_path, USE % "\n    ".join(IGNORED))
    assert rejected(compiler, standard, unit, "unused-(?:result|value)") == [*IGNORED]
    compiled(compiler, standard, unit, *NO_MACROS)


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_null_does_not_compile(compiler: Compiler, standard: str, tmp_path: Path) -> None:
    unit = source(tmp_path, USE % "\n    ".join(NULLS))
    assert rejected(compiler, standard, unit, "nonnull") == [*NULLS]


def rejected(compiler: Compiler, standard: str, unit: Path, warning: str) -> list[str]:
    """The lines that a warning is about, in the order of the source."""
    with pytest.raises(AssertionError) as raised:
        compiled(compiler, standard, unit)
    line_numbers = re.findall(rf"unit\.c:(\d+):\d+: error:.*{warning}", str(raised.value))
    lines = unit.read_text("utf-8").splitlines()
    return [lines[number - 1].strip() for number in sorted({int(number) for number in line_numbers})]


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_a_number_in_place_of_a_float_field_does_not_compile(compiler: Compiler, standard: str, tmp_path: Path) -> None:
    """Without the options that warn of conversions: 49.5 would be sent as 6.9e-44."""
    include = write([specification(ROOT / "tests/specs/blower/v1.yaml")], tmp_path) / "include"
    language = ("-x", "c++") if standard.startswith("c++") else ()
    flags = (f"-I{include}", "-Werror=incompatible-pointer-types", *language, "-c", "-o", tmp_path / "unit.o")
    compiler.check(standard, *WARNINGS, *flags, source(tmp_path, FLOAT_FIELD % "\n    ".join(SETS)))
    for statement in NUMBERS:
        with pytest.raises(AssertionError, match=r"unit\.c:8:.*error"):
            compiler.check(standard, *flags, source(tmp_path, FLOAT_FIELD % statement))


def test_every_function_is_marked() -> None:
    """Also in headers of other specs: the marks are in the templates, and the specs below use every branch."""
    texts = [(RUNTIME / name).read_text("utf-8") for name in ("canwright.h", "canwright_float.h")]
    texts += [o.text for spec in SPECS for o in CTarget().generate([specification(spec)], {}) if o.path.endswith(".h")]
    counts = {"checked": 0, "not null": 0}
    for text in texts:
        pattern = r"^(.*)\nstatic inline ([^()]*?)(\w+)\(([^)]*)\)"
        for before, result, name, arguments in re.findall(pattern, text, re.M):
            marks = before.split()
            assert ("CANWRIGHT_CHECKED" in marks) == ("status_t" in result or name == "canwright_share64"), name
            is_marked = "*" in arguments and not name.endswith(PARTS_OF_MESSAGES) and name not in TAKES_NULL
            assert ("CANWRIGHT_NONNULL" in marks) == is_marked, name
            assert ("CANWRIGHT_RESTRICT" in arguments) == name.endswith("_encode"), name
            counts["checked"] += "CANWRIGHT_CHECKED" in marks
            counts["not null"] += "CANWRIGHT_NONNULL" in marks
    assert min(counts.values()) > 100


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_no_function_of_a_type_has_the_name_of_a_field_of_another(spec: Path) -> None:
    edition_input = specification(spec)
    names = Names(edition_input.edition)
    text = "".join(o.text for o in CTarget().generate([edition_input], {}) if o.path.endswith(".h"))
    for layout in layouts(edition_input.edition):
        for field in (f for f in layout.fields if f.is_given and names.type_stem(f.type) != f.name):
            for ending in (e for e in TYPE_ENDINGS if field.name + e not in EDITION_NAMES):
                assert f" {names.lower(field.name)}{ending}(" not in text, (layout.name, field.name)


def test_a_field_with_the_name_of_another_type_renames_the_type(tmp_path: Path) -> None:
    fields = "level: {at: 2, raw: u8}, level_u16: {at: 3, raw: u8}, size: {at: 4, type: level}"
    text = MINIMAL.replace("level: {at: 2, type: level}", fields).replace(
        "  level: {raw", "  level_u16_2: {raw: u8}\n  level: {raw"
    )
    lamp = edition(tmp_path, text.replace("reply: echo", "reply: {size: {at: 3, type: level_u16_2}}"))
    stems = {type_.name: Names(lamp).type_stem(type_) for type_ in lamp.types}
    assert stems == {"level_u16_2": "level_u16_2", "level": "level_u16_3", "u8": "u8"}


def test_the_speed_of_a_request_is_not_converted_as_that_of_a_reply(tmp_path: Path) -> None:
    """10000 is 100 deg/s, because the request has 0.01 deg/s and the reply 1 deg/s."""
    unit = source(tmp_path, USE % "value = mwd_motor_v2_35_speed_to_double(speed.speed);")
    with pytest.raises(AssertionError, match="mwd_motor_v2_35_speed_to_double"):
        compiled(ZIG, "c99", unit)


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_all_names_differ_within_63_characters(spec: Path) -> None:
    starts: dict[str, str] = {}
    for name, _, _ in defined(specification(spec).edition):
        assert starts.setdefault(name[:SIGNIFICANT], name) == name


@pytest.mark.tools
@pytest.mark.parametrize("spec", spec_files(ROOT / "spec"), ids=called)
def test_sdcc_compiles_every_header(spec: Path, tmp_path: Path) -> None:
    """A compiler without structs by value, for 8-bit processors; without optimization, which takes minutes."""
    unit = source(tmp_path, f"#include <mwd_motor/{specification(spec).edition.identifier}.h>\n")
    quick = ("--max-allocs-per-node", "1", "--nogcse", "--noinvariant", "--noinduction", "--no-peep")
    command = [
        tool("sdcc"),
        "-mz80",
        "--std-c99",
        *quick,
        f"-I{INCLUDE}",
        "-S",
        str(unit),
        "-o",
        str(tmp_path / "unit.asm"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@each_compiler
@pytest.mark.parametrize("statement", FLOATS)
def test_a_value_assigned_to_a_raw_integer_is_a_warning_of_the_recommended_option(
    statement: str, compiler: Compiler, tmp_path: Path
) -> None:
    unit = source(tmp_path, USE % statement)
    flags = (f"-I{INCLUDE}", "-c", unit, "-o", tmp_path / "unit.o")
    with pytest.raises(AssertionError, match="conversion"):
        compiler.check("c99", "-Wfloat-conversion", "-Werror", *flags)
    text = (INCLUDE.parent / "CMakeLists.txt").read_text("utf-8")
    assert "-Wfloat-conversion;-Wno-error=float-conversion" in text
